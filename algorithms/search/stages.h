// The time that each stage of a solve takes, for Wanted::stages.
#pragma once

#include "algorithms/solver.h"

#include <chrono>
#include <string>

namespace hausbench {

// Reads the clock at its making and at the end of each stage; never where it is off.
class Stages {
public:
    explicit Stages(bool on) : on_(on) {
        if (on_) begin_ = std::chrono::steady_clock::now();
    }

    // The stage is what was done since the stage before. One that comes more than once has the sum.
    void end(const char* name) {
        if (!on_) return;
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - begin_).count();
        const auto [known, first] = seconds_.emplace(std::string(stage_prefix) + name, seconds);
        if (!first) std::get<double>(known->second) += seconds;
        begin_ = now;
    }

    // Those that were ended, as Result::reported names them.
    const Reported& seconds() const { return seconds_; }

private:
    bool on_;
    std::chrono::steady_clock::time_point begin_{};
    Reported seconds_;
};

}  // namespace hausbench
