// Progress with an estimate: one line that redraws itself when a person watches, plain lines when not.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace hausbench {

class Progress {
public:
    explicit Progress(bool quiet = false);
    ~Progress();

    void total(std::size_t cases);
    void doing(const std::string& what);  // shown to a person at once
    void done(std::size_t cases);         // that many more are finished
    void line(const std::string& text);   // a line that stays

private:
    void draw();
    void erase();
    std::string left() const;

    bool quiet_, person_;
    std::size_t total_ = 0, done_ = 0;
    std::string what_;
    std::chrono::steady_clock::time_point begin_, drawn_;
};

}  // namespace hausbench
