// Estimates the time and memory of a job before it is run: for `explain`, for the order of jobs that run side by side,
// and for shards.
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
    // Upper estimate of the worker's resident set: the shapes and the solver's memory.
    std::int64_t bytes = 0;
    std::size_t known = 0;  // number of cases that an earlier run on this machine has timed
};

// Estimates the time and memory of jobs from the results of earlier runs.
//
// The time of a case is taken from the same case if it was run on this machine. Otherwise it is taken from the case of
// the same solver with the most similar expected work, and multiplied by the ratio of the expected works. If this
// machine has run no case of the solver, the expected work alone decides. The expected work, as a number of distances
// between two points, is |A| * |B| for `naive` and k * (|A| + |B|) for the others, where |A| and |B| are numbers of
// elements and k is larger if the solver accepts meshes.
//
// The memory is a number of bytes per element of both shapes, taken from the case of the same solver with the nearest
// number of elements, on any machine.
class Estimates {
public:
    // `results`: folder of result files, read at the first call of of(). Files that cannot be read are ignored.
    explicit Estimates(const std::filesystem::path& results);
    ~Estimates();

    JobEstimate of(const Plan& plan, const Job& job) const;

private:
    struct Memory;
    std::filesystem::path results_;
    mutable std::unique_ptr<const Memory> memory_;
};

// Returns a lower estimate of the memory of the job's worker, in bytes: one copy of the two shapes of the largest pair,
// and nothing for the solver.
std::int64_t least_bytes(const Plan& plan, const Job& job);

// Every reason that does_not_fit() returns begins with this text. A later run recognises such rows by it.
inline constexpr std::string_view not_started = "not started: ";

// Returns the reason why the job cannot run, or an empty string if it can. It cannot run if least_bytes() exceeds the
// memory limit of its cases or `memory`, the memory of the machine in bytes.
std::string does_not_fit(const Plan& plan, const Job& job, std::int64_t memory);

}  // namespace hausbench
