// Shows progress and an estimate of the time left. Redraws one line on a terminal, and prints plain lines otherwise.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace hausbench {

class Progress {
public:
    // `pause`: the least number of seconds between two progress lines, if the output is not a terminal.
    explicit Progress(bool quiet = false, double pause = 10);
    ~Progress();

    void total(std::size_t cases);  // sets the number of cases, and starts the clock
    // Sets a function that estimates the seconds left when `gone_by` seconds have passed. Without it, each remaining
    // case is expected to take as long as the average finished case.
    void left_by(std::function<double(double gone_by)> seconds);
    void doing(const std::string& what);  // sets the name of the current work; shown at once on a terminal
    void done(std::size_t cases);         // adds to the number of finished cases
    void line(const std::string& text);   // prints a line that stays

private:
    void draw();
    void erase();
    std::string time() const;

    bool quiet_, person_;  // person_: the output is a terminal, not the log of a continuous-integration run
    double pause_;
    std::size_t total_ = 0, done_ = 0;
    std::string what_;
    std::function<double(double)> seconds_left_;
    std::chrono::steady_clock::time_point begin_, drawn_;  // drawn_: time of the last output
};

}  // namespace hausbench
