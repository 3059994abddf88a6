// One timed repeat, driven by Google Benchmark, one repetition a call (it reports only after all of them).
#pragma once

#include "session.h"

#include <cstdint>

namespace hausbench {

struct Timing {
    double wall_seconds, cpu_seconds;  // per solve; the CPU time of this thread
};

Timing time_once(const Session& session, const Query& query, std::int64_t iterations);

}  // namespace hausbench
