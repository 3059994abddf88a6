// A line on a terminal that tells what a long command is doing.
#pragma once

#include <chrono>
#include <string>

namespace hausbench {

// The line appears on standard error once two seconds have passed since the object was made, and is erased at its end.
// If standard error is not a terminal, or in continuous integration (the variable CI), it never appears.
class ProgressLine {
public:
    ProgressLine();
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    // Shows the seconds since the beginning and what is being done, at most twice a second. Takes 50 ns otherwise, so call
    // it often.
    void draw(const std::string& doing);

private:
    bool person_, drawn_ = false;
    std::chrono::steady_clock::time_point begin_, next_;
};

}  // namespace hausbench
