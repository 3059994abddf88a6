// What running a job will take, before it is run: for `explain`, for the order of work side by side, and for shards.
#pragma once

#include "plan/plan.h"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace hausbench {

struct JobEstimate {
    double seconds = 0;      // all rounds and repeats
    std::int64_t bytes = 0;  // resident, of its worker: the shapes, and what the solver takes besides, or more
    std::int64_t known_bytes = 0;  // likewise, where earlier runs of the solver tell what it takes; else the shapes alone
    std::size_t known = 0;         // cases that an earlier run answered
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

// Resident bytes of a worker that has loaded both shapes of a pair, or all shapes of a matrix, and of nothing else.
std::int64_t loaded_bytes(const Plan& plan, const Job& job);

// Decides the cases of jobs that would need more memory than their limit or `most` allow: they get rows that say so, and do not
// begin. The shapes count, and what the solver took for each element of large shapes in earlier runs, if that is known.
void refuse_what_does_not_fit(Plan& plan, const Estimates& estimates, std::int64_t most);

}  // namespace hausbench
