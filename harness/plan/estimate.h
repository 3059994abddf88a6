// Estimates the time and memory of a job before it is run: for `explain`, for the order of work side by side, and for
// shards.
#pragma once

#include "harness/plan/plan.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace hausbench {

struct JobEstimate {
    double seconds = 0;  // of all rounds and repeats
    // Upper estimate of the worker's resident set: the shapes and the solver's memory.
    std::int64_t bytes = 0;
    std::size_t known = 0;  // cases that an earlier run answered
};

// Estimates from the result files in `results`: from the same case, otherwise from the same solver on other shapes,
// scaled by the expected work, otherwise from the expected work alone. Times are taken from this machine only, memory
// from any machine. The expected work is |A| |B| distances for naive and k (|A| + |B|) for the others; memory is a
// number of bytes per element of both shapes.
class Estimates {
public:
    // Reads the folder at the first call of of(). Files that cannot be read are ignored.
    explicit Estimates(const std::filesystem::path& results);
    ~Estimates();

    JobEstimate of(const Plan& plan, const Job& job) const;

private:
    struct Memory;
    std::filesystem::path results_;
    mutable std::unique_ptr<const Memory> memory_;
};

// Returns the least memory that a worker of the job takes, in bytes: the shapes of its largest pair, once, whatever
// the solver.
std::int64_t least_bytes(const Plan& plan, const Job& job);

// The beginning of every reason that does_not_fit() gives.
inline constexpr std::string_view not_started = "not started: ";

// Returns why the job cannot run: its least memory exceeds the limit of its cases or `memory`, the memory of the
// machine, in bytes. Empty if it can.
std::string does_not_fit(const Plan& plan, const Job& job, std::int64_t memory);

}  // namespace hausbench
