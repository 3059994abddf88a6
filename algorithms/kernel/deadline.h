// A limit on wall time.
#pragma once

#include <chrono>
#include <cmath>

namespace hausbench {

// A deadline that passes a given number of seconds after construction. With infinity, it never passes, and the clock is
// not read.
class Deadline {
public:
    explicit Deadline(double seconds) : seconds_(seconds), limited_(std::isfinite(seconds)) {
        if (limited_) begin_ = std::chrono::steady_clock::now();
    }

    bool passed() const {
        if (!limited_) return false;
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() >= seconds_;
    }

private:
    double seconds_;
    bool limited_;
    std::chrono::steady_clock::time_point begin_{};
};

}  // namespace hausbench
