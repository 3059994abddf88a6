// Times several contenders in turn, so that a disturbance of the machine affects all of them.
#pragma once

#include "harness/record/estimates.h"

#include <ctime>
#include <functional>
#include <vector>

namespace hausbench {

// Returns the CPU time of all threads of this process, so that moving work to another thread gains nothing.
inline double cpu_seconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// One of several pieces of code to compare. Each round calls its three functions in this order, and times only `timed`.
struct Contender {
    std::function<void()> before, timed, after;
};

// Returns seconds[c][r], the time of contender c in round r. Every other round runs the contenders in reverse order
// (ABBA), so that a steady change in the machine's speed favours none of them. A round for warming up comes first and
// is not counted.
inline std::vector<std::vector<double>> interleave(const std::vector<Contender>& contenders, int rounds) {
    std::vector<std::vector<double>> seconds(contenders.size());
    for (int round = -1; round < rounds; ++round) {
        for (std::size_t i = 0; i < contenders.size(); ++i) {
            const std::size_t c = round % 2 == 0 ? i : contenders.size() - 1 - i;
            contenders[c].before();
            const double begin = cpu_seconds();
            contenders[c].timed();
            const double end = cpu_seconds();
            contenders[c].after();
            if (round >= 0) seconds[c].push_back(end - begin);
        }
    }
    return seconds;
}

}  // namespace hausbench
