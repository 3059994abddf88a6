// Measures the wall and CPU time of a solve. time_once() times one repeat with Google Benchmark. It runs the benchmark
// with one repetition, because the library reports only after all repetitions.
//
// Column `clock` says which of the two is the time of a case:
// - CPU time if one thread works at a time, because other work on the machine disturbs CPU time least;
// - wall time if several threads work at once, because CPU time is then their sum;
// - wall time if an outside program uses less CPU time than a fifth of its wall time, because it leaves its work to a
//   daemon or a GPU, or sleeps.
// CPU time covers this process and its children that ended: an outside program works in a child while this thread
// waits. It includes the harness's own work, such as reading the output of a child, which is some microseconds for each
// millisecond of waiting.
#pragma once

#include "algorithms/session/session.h"

#include <chrono>
#include <cstdint>

#include <sys/resource.h>

namespace hausbench {

struct Spent {
    double wall_seconds, cpu_seconds;  // CPU: all threads of the process, and children that ended
    bool by_wall;                      // the wall time, not the CPU time, is the time of the case, see above
};

// Returns whether several threads worked at once: whether CPU time exceeds wall time by more than a tenth. The tenth is
// for the CPU time that this process takes while it waits for a child. Nothing more is known about threads in children,
// so an outside program whose threads hardly ever work at once counts as one thread.
inline bool several_at_once(double wall_seconds, double cpu_seconds) { return cpu_seconds > 1.1 * wall_seconds; }

// Returns whether an outside program leaves its work to a daemon or a GPU, or sleeps. It may also just wait for a core
// of a busy machine; wall time is right then, too, because it is the time that a user waits.
inline bool works_elsewhere(double wall_seconds, double cpu_seconds) { return cpu_seconds < 0.2 * wall_seconds; }

// Measures the time since its construction.
class Stopwatch {
public:
    Stopwatch();
    Spent spent() const;

private:
    explicit Stopwatch(const rusage& children);

    double children_;
    long faults_;  // page faults of children that ended: as each child has some, a rise means that a child has ended
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
