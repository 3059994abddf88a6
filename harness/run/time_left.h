// Estimates how long a run still takes, from the expected times of its cases and from the actual times of the cases
// that have ended.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hausbench {

// A part of a run: cases of one solver that are expected to take equally long.
struct OpenWork {
    // Label of the solver. If a solver took twice as long as expected in one part, the estimates of its other parts
    // double.
    std::string kind;
    double expected = 0;              // seconds per case
    std::size_t open = 0, ended = 0;  // numbers of cases
    double took = 0;                  // total actual seconds of the cases that have ended
};

// Returns the wall-clock seconds left after `gone_by` seconds. Sums over all parts
//   open * expected * (actual / expected seconds of the ended cases of this kind),
// and divides by the average number of cases that ran at the same time so far. While few cases of a kind have ended,
// the ratio is close to the ratio for all kinds; while few cases have ended at all, it is close to 1.
double seconds_left(const std::vector<OpenWork>& parts, double gone_by);

}  // namespace hausbench
