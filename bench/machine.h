// Costs of the machine that every solver pays: new pages of memory, and waking a thread.
#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>

namespace hausbench {

// Adds the counter `each`: the time per item, if one iteration processes this many items.
inline void count(benchmark::State& state, std::size_t items) {
    state.counters["each"] = benchmark::Counter(
        static_cast<double>(items), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// Registers the benchmarks `page/...` and `loop_on_two_threads/N`.
void register_machine();

}  // namespace hausbench
