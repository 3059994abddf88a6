// Measures the time of each stage of a solve, for Wanted::stages.
#pragma once

#include "algorithms/solver.h"

#include <chrono>
#include <string>

namespace hausbench {

// A stopwatch for the stages of a solve. If it is off, it never reads the clock and records nothing.
class Stages {
public:
    explicit Stages(bool on) : on_(on) {
        if (on_) begin_ = std::chrono::steady_clock::now();
    }

    // Ends a stage, which began when the previous one ended, and records its time under a name. Times with
    // the same name add up.
    void end(const char* name) {
        if (!on_) return;
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - begin_).count();
        const auto [known, first] = seconds_.emplace(std::string(stage_prefix) + name, seconds);
        if (!first) std::get<double>(known->second) += seconds;
        begin_ = now;
    }

    // Returns the seconds of each stage that has ended, under names for Result::reported, such as "seconds: subdivide".
    const Reported& seconds() const { return seconds_; }

private:
    bool on_;
    std::chrono::steady_clock::time_point begin_{};
    Reported seconds_;
};

}  // namespace hausbench
