// Estimates the time and memory of a job before it runs: for `explain`, to start the longest jobs of a parallel run
// first, and to balance shards.
#pragma once

#include "harness/plan/plan.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace hausbench {

struct JobEstimate {
    double seconds = 0;  // for all rounds and repeats together
    // Upper estimate of the resident memory of the worker process: the shapes and the solver's own memory.
    std::int64_t bytes = 0;
    std::size_t timed_cases = 0;  // number of cases that an earlier run on this machine has timed
};

// Estimates the time and memory of jobs from the results of earlier runs.
//
// The time of a case is taken from the same case if it was run on this machine. Otherwise it is taken from the case of
// the same solver with the most similar expected work, and multiplied by the ratio of the two works. If this machine
// has run no case of the solver, the time is proportional to the expected work. The expected work is a number of
// distances between two points: |A| * |B| for `naive` and k * (|A| + |B|) for other solvers, where |A| and |B| are
// numbers of elements and k is larger for solvers that accept meshes.
//
// The memory of a solver is taken to be proportional to the number of elements of both shapes. The bytes per element
// come from the case of the same solver with the nearest number of elements, on any machine.
class Estimates {
public:
    // `results`: the folder of result files. They are read when of() is first called; unreadable files are ignored.
    explicit Estimates(const std::filesystem::path& results);
    ~Estimates();

    JobEstimate of(const Plan& plan, const Job& job) const;

private:
    struct Memory;
    std::filesystem::path results_;
    mutable std::unique_ptr<const Memory> memory_;
};

// Returns the least memory, in bytes, that a job needs: one copy of both shapes of its largest pair. The solver's own
// memory is not counted.
std::int64_t least_bytes(const Plan& plan, const Job& job);

// Prefix of every reason from does_not_fit(). A later run recognises by it that a case was refused for lack of memory.
inline constexpr std::string_view not_started = "not started: ";

// Returns the reason why a job does not fit into memory: least_bytes() exceeds the memory limit of its cases or
// `memory`, the bytes of memory of this machine. Returns an empty string if the job fits.
std::string does_not_fit(const Plan& plan, const Job& job, std::int64_t memory);

}  // namespace hausbench
