// Wall and CPU time of a solve, and one timed repeat, driven by Google Benchmark: time_once() runs one repetition, because the library
// reports only after all repetitions.
//
// Which of the two is *the* time of a case (column `clock`): CPU time where one thread works at a time, because other work on
// the machine disturbs it least; wall time where several do, because CPU time then is their sum. CPU time is that of the
// process and of its children that ended: an outside program works in a child while this thread waits. It holds what the
// harness spends itself, such as reading what a child prints; that is some microseconds each millisecond of waiting. An outside program
// that uses less than a fifth of its wall time leaves its work to a daemon or a GPU, or sleeps: wall time is its time, too.
#pragma once

#include "algorithms/session/session.h"

#include <chrono>
#include <cstdint>

#include <sys/resource.h>

namespace hausbench {

struct Spent {
    double wall_seconds, cpu_seconds;  // CPU: all threads of the process, and children that ended
    // Wall time counts: several threads worked, or an outside program waited.
    bool by_wall;
};

// More CPU time than wall time: by a tenth, since waiting for a child takes some CPU time of our own meanwhile. Of children
// nothing else is known: several threads of an outside program that hardly ever work at once count as one.
inline bool several_at_once(double wall_seconds, double cpu_seconds) { return cpu_seconds > 1.1 * wall_seconds; }

// Of an outside program. A busy machine can also keep a program waiting; then wall time is what its user waited.
inline bool works_elsewhere(double wall_seconds, double cpu_seconds) { return cpu_seconds < 0.2 * wall_seconds; }

// Runs from its making.
class Stopwatch {
public:
    Stopwatch();
    Spent spent() const;

private:
    explicit Stopwatch(const rusage& children);

    double children_;
    long faults_;  // of children that ended, each of which has some
    std::chrono::steady_clock::time_point wall_;
    double thread_, process_;
};

struct Timing {
    double wall_seconds, cpu_seconds;  // per solve
};

// `slowdown`: see Plan::planted_slowdown.
Timing time_once(const Session& session, const Query& query, std::int64_t iterations, double slowdown = 0);

double cpu_seconds_of_thread();

// Spends that much CPU time of this thread.
void burn(double cpu_seconds);

}  // namespace hausbench
