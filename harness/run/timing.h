// Measures the wall and CPU time of a solve. time_once() times one repeat with Google Benchmark. It runs the benchmark
// with one repetition, because the library reports only after all repetitions.
//
// The column `clock` of a result says which of the two is the time of a case:
// - CPU time if one thread works at a time, because other work on the machine disturbs CPU time least;
// - wall time if several threads work at once, because CPU time is then their sum;
// - wall time if an outside program uses less CPU time than a fifth of its wall time, because it leaves its work to a
//   daemon or a GPU, or sleeps.
// CPU time includes children that have ended, because an outside program works in a child while this thread waits. It
// also includes the harness's own work, such as reading the output of a child: some microseconds for each millisecond
// of waiting.
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

// Returns whether several threads worked at once: CPU time exceeds wall time by more than a tenth. The tenth allows for
// the CPU time that this process takes while it waits for a child. An outside program whose threads hardly ever work at
// once counts as one thread.
inline bool several_at_once(double wall_seconds, double cpu_seconds) { return cpu_seconds > 1.1 * wall_seconds; }

// Returns whether an outside program leaves its work to a daemon or a GPU, or sleeps. A program that waits for a core
// of a busy machine looks the same; wall time is right for it, too, because a user waits that long.
inline bool works_elsewhere(double wall_seconds, double cpu_seconds) { return cpu_seconds < 0.2 * wall_seconds; }

// Measures the time since its construction.
class Stopwatch {
public:
    Stopwatch();
    Spent spent() const;

private:
    explicit Stopwatch(const rusage& children);

    double children_;
    long faults_;  // page faults of ended children; every child has some, so a rise means that a child has ended
    std::chrono::steady_clock::time_point wall_;
    double thread_, process_;
};

struct Timing {
    double wall_seconds, cpu_seconds;  // per solve
};

// Times one repeat, which is `iterations` solves in a row.
Timing time_once(const Session& session, const Query& query, std::int64_t iterations);

}  // namespace hausbench
