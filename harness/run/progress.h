// Shows progress with an estimate of the time left: on a terminal one line that is redrawn, otherwise plain lines.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace hausbench {

class Progress {
public:
    // `pause`: if the output is not a terminal, the least number of seconds between two lines about finished cases.
    explicit Progress(bool quiet = false, double pause = 10);
    ~Progress();

    void total(std::size_t cases);  // sets the number of cases, and starts the clock
    // Sets the function that estimates the seconds left after `gone_by` seconds. Without it, each remaining case is
    // assumed to take as long as the finished ones did on average.
    void left_by(std::function<double(double gone_by)> seconds);
    void doing(const std::string& what);  // sets the name of the current work; shown at once on a terminal
    void done(std::size_t cases);         // adds to the number of finished cases
    void line(const std::string& text);   // prints a line that stays

private:
    void draw();
    void erase();
    std::string time() const;

    bool quiet_, person_;  // person: the output is a terminal, and not in continuous integration
    double pause_;
    std::size_t total_ = 0, done_ = 0;
    std::string what_;
    std::function<double(double)> seconds_left_;
    std::chrono::steady_clock::time_point begin_, drawn_;  // drawn: time of the last output
};

}  // namespace hausbench
