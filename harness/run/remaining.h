// How long a run still takes, from what its parts were expected to take and from what those took that have ended.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hausbench {

// Cases of one solver that are expected to take as long each.
struct OpenWork {
    // The solver; if a case takes twice as long as expected, its others will, too.
    std::string kind;
    double expected = 0;  // seconds of a case
    std::size_t open = 0, ended = 0;
    double took = 0;  // seconds of those that ended, together
};

// Seconds by the clock, when so many have gone by. Work that is open takes longer than expected by as much as that of its kind did that
// ended; where little of it ended, as that of all did; where little ended at all, as expected. As much runs side by side as did so far.
// 0 where nothing is open. O(parts).
double seconds_left(const std::vector<OpenWork>& parts, double gone_by);

}  // namespace hausbench
