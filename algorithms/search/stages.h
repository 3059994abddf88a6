// Times the stages of a solve (Wanted::stages).
#pragma once

#include "algorithms/solver.h"

#include <chrono>
#include <string>

namespace hausbench {

// Measures how many seconds each stage of a solve takes. If `on` is false, this never reads the clock and records
// nothing.
class Stages {
public:
    explicit Stages(bool on) : on_(on) {
        if (on_) begin_ = std::chrono::steady_clock::now();
    }

    // Ends the current stage, which began when the previous one ended, and adds its seconds to the total of this name.
    void end(const char* name) {
        if (!on_) return;
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - begin_).count();
        const auto [entry, first] = seconds_.emplace(std::string(stage_prefix) + name, seconds);
        if (!first) std::get<double>(entry->second) += seconds;
        begin_ = now;
    }

    // Returns the seconds of the finished stages by name, such as "seconds: subdivide", ready for Result::reported.
    const Reported& seconds() const { return seconds_; }

private:
    bool on_;
    std::chrono::steady_clock::time_point begin_{};
    Reported seconds_;
};

}  // namespace hausbench
