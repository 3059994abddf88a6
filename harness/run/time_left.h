// Estimates how long a run still takes, from the expected times of its parts and the actual times of those that have
// ended.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hausbench {

// Cases of one solver that are expected to take equally long.
struct OpenWork {
    // The solver. If one of its cases takes twice as long as expected, its other cases are expected to do so, too.
    std::string kind;
    double expected = 0;  // seconds per case
    std::size_t open = 0, ended = 0;
    double took = 0;  // total seconds of the cases that have ended
};

// Returns the wall-clock seconds left after `gone_by` seconds. The expected time of open work is multiplied by actual
// time / expected time of the ended work of its kind; if little of that has ended, by the ratio for all ended work;
// if little has ended at all, by 1. As much work is assumed to run side by side as did so far. Returns 0 if nothing
// is open. O(parts).
double seconds_left(const std::vector<OpenWork>& parts, double gone_by);

}  // namespace hausbench
