#include "bench/machine.h"

#include "algorithms/kernel/pages.h"
#include "algorithms/kernel/parallel.h"

#include <sys/mman.h>

#include <chrono>

namespace hausbench {
namespace {

// Writes one byte to each page of 32 MiB of new memory, after `before` was called for it. Structures are built in such
// memory, so this cost is part of every first answer of a process.
template <class Before> void touch(benchmark::State& state, const Before& before) {
    constexpr std::size_t bytes = std::size_t{1} << 25, page = 4096;
    for (auto _ : state) {
        void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        before(memory, bytes);
        for (std::size_t i = 0; i < bytes; i += page) static_cast<volatile char*>(memory)[i] = 1;
        state.PauseTiming();
        ::munmap(memory, bytes);
        state.ResumeTiming();
    }
    count(state, bytes / page);
}

// Times a loop over ten blocks on two threads that takes `range` microseconds on one. Before each loop one thread works
// alone, as between the loops that build a structure, so the other has gone to sleep.
void loop_on_two_threads(benchmark::State& state) {
    const auto work = [](double microseconds) {
        const auto begin = std::chrono::steady_clock::now();
        while (std::chrono::steady_clock::now() - begin < std::chrono::duration<double, std::micro>(microseconds)) {
        }
    };
    for (auto _ : state) {
        state.PauseTiming();
        work(300);
        state.ResumeTiming();
        Threads(2).for_each(10, [&](std::size_t) { work(static_cast<double>(state.range(0)) / 10); });
    }
}

}  // namespace

void register_machine() {
    using benchmark::RegisterBenchmark;
    RegisterBenchmark("page/one_by_one", [](auto& state) { touch(state, [](void*, std::size_t) {}); });
    RegisterBenchmark("page/touch_pages", [](auto& state) { touch(state, touch_pages); });
    RegisterBenchmark("page/huge", [](auto& state) {
        touch(state, [](void* memory, std::size_t bytes) { ::madvise(memory, bytes, MADV_HUGEPAGE); });
    });
    RegisterBenchmark("loop_on_two_threads", loop_on_two_threads)
        ->Arg(100)
        ->Arg(500)
        ->Arg(2000)
        ->UseRealTime()
        ->Unit(benchmark::kMicrosecond);
}

}  // namespace hausbench
