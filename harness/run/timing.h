// Measures the wall and CPU time of a solve. time_once() times one repeat with Google Benchmark; it runs one
// repetition, because the library reports only after all repetitions.
//
// *The* time of a case (column `clock`) is CPU time if one thread works at a time, because other work on the machine
// disturbs it least, and wall time if several do, because CPU time is then their sum. CPU time covers the process and
// its children that ended: an outside program works in a child while this thread waits. It includes the harness's own
// work, such as reading the output of a child; that is some microseconds per millisecond of waiting. An outside
// program that uses less than a fifth of its wall time as CPU time leaves its work to a daemon or a GPU, or sleeps:
// wall time is its time, too.
#pragma once

#include "algorithms/session/session.h"

#include <chrono>
#include <cstdint>

#include <sys/resource.h>

namespace hausbench {

struct Spent {
    double wall_seconds, cpu_seconds;  // CPU: all threads of the process, and children that ended
    // Wall time is the time of the case: several threads worked, or an outside program waited.
    bool by_wall;
};

// Returns whether several threads worked at once: whether CPU time exceeds wall time by more than a tenth, since
// waiting for a child takes some CPU time of our own. Nothing else is known about children: an outside program whose
// threads hardly ever work at once counts as one thread.
inline bool several_at_once(double wall_seconds, double cpu_seconds) { return cpu_seconds > 1.1 * wall_seconds; }

// Returns whether an outside program leaves its work to others. A busy machine can also keep it waiting; wall time is
// then the time that its user waits.
inline bool works_elsewhere(double wall_seconds, double cpu_seconds) { return cpu_seconds < 0.2 * wall_seconds; }

// Starts when constructed.
class Stopwatch {
public:
    Stopwatch();
    Spent spent() const;

private:
    explicit Stopwatch(const rusage& children);

    double children_;
    long faults_;  // page faults of children that ended; each child has some
    std::chrono::steady_clock::time_point wall_;
    double thread_, process_;
};

struct Timing {
    double wall_seconds, cpu_seconds;  // per solve
};

// Times one repeat of `iterations` solves. `slowdown`: see Plan::planted_slowdown.
Timing time_once(const Session& session, const Query& query, std::int64_t iterations, double slowdown = 0);

double cpu_seconds_of_thread();

// Spends this much CPU time in this thread.
void burn(double cpu_seconds);

}  // namespace hausbench
