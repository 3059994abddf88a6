// Progress with an estimate of the time left: on a terminal one line that is redrawn, otherwise plain lines.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace hausbench {

class Progress {
public:
    // `pause`: where nobody watches, a line at least this often while cases are finished, in seconds.
    explicit Progress(bool quiet = false, double pause = 10);
    ~Progress();

    void total(std::size_t cases);
    void doing(const std::string& what);  // shown at once on a terminal
    void done(std::size_t cases);         // adds to the number of finished cases
    void line(const std::string& text);   // a permanent line

private:
    void draw();
    void erase();
    std::string left() const;

    bool quiet_, person_;
    double pause_;
    std::size_t total_ = 0, done_ = 0;
    std::string what_;
    std::chrono::steady_clock::time_point begin_, drawn_;
};

}  // namespace hausbench
