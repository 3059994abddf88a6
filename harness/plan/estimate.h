// What running a job will take, before it is run: for `explain`, for the order of work side by side, and for shards.
#pragma once

#include "harness/plan/plan.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace hausbench {

struct JobEstimate {
    double seconds = 0;  // all rounds and repeats
    // Upper estimate of its worker's resident set: the shapes and the solver's memory.
    std::int64_t bytes = 0;
    std::size_t known = 0;  // cases that an earlier run answered
};

// Times and memory come from result files in `results`: of the same case; else of the same solver on other shapes, scaled by the work
// to be expected; else from that work alone. Times are those of this machine alone, memory that of any. The work to be expected
// is |A| |B| distances for naive and k (|A| + |B|) for the others; memory is so many bytes an element of both.
class Estimates {
public:
    // Reads the folder when it is asked first. A folder or a file that cannot be read costs only what it says.
    explicit Estimates(const std::filesystem::path& results);
    ~Estimates();

    JobEstimate of(const Plan& plan, const Job& job) const;

private:
    struct Memory;
    std::filesystem::path results_;
    mutable std::unique_ptr<const Memory> memory_;
};

// What a worker of the job takes at least: the shapes of its largest pair, once, whatever the solver.
std::int64_t least_bytes(const Plan& plan, const Job& job);

// How every reason of does_not_fit() begins.
inline constexpr std::string_view not_started = "not started: ";

// Why the job cannot run: it takes more at least than the limit of its cases or `memory`, that of the machine, allow. Empty where it may.
std::string does_not_fit(const Plan& plan, const Job& job, std::int64_t memory);

}  // namespace hausbench
