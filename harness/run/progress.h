// Shows progress with an estimate of the time left: on a terminal one line that is redrawn, otherwise plain lines.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace hausbench {

class Progress {
public:
    // `pause`: if the output is not a terminal, seconds between lines while cases finish.
    explicit Progress(bool quiet = false, double pause = 10);
    ~Progress();

    void total(std::size_t cases);
    // Sets the function that estimates the seconds left after `gone_by` seconds. Without it, each remaining case is
    // assumed to take as long as the finished ones did on average.
    void left_by(std::function<double(double gone_by)> seconds);
    void doing(const std::string& what);  // shown at once on a terminal
    void done(std::size_t cases);         // adds to the number of finished cases
    void line(const std::string& text);   // a permanent line

private:
    void draw();
    void erase();
    std::string time() const;

    bool quiet_, person_;
    double pause_;
    std::size_t total_ = 0, done_ = 0;
    std::string what_;
    std::function<double(double)> seconds_left_;
    std::chrono::steady_clock::time_point begin_, drawn_;
};

}  // namespace hausbench
