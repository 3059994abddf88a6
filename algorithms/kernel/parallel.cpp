#include "algorithms/kernel/parallel.h"

#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/watched.h"

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <atomic>
#include <cfenv>

namespace hausbench {
namespace {

namespace tbb = oneapi::tbb;

// Sets the floating-point environment, such as the rounding mode, for its lifetime, and then restores the previous one.
class Environment {
public:
    explicit Environment(const std::fenv_t& wanted) {
        std::fegetenv(&before_);
        std::fesetenv(&wanted);
    }
    ~Environment() { std::fesetenv(&before_); }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;

private:
    std::fenv_t before_;
};

thread_local const Interrupt* current_interrupt = nullptr;

}  // namespace

Stoppable::Stoppable(const Interrupt* interrupt) : before_(current_interrupt) { current_interrupt = interrupt; }

Stoppable::~Stoppable() { current_interrupt = before_; }

const Interrupt* Stoppable::current() { return current_interrupt; }

void Stoppable::look(const Interrupt* interrupt) {
    if (!interrupt) return;
    // Structures that the hook builds do not ask it again.
    const Stoppable nothing(
        WATCHED_ELSE("threads: structures that a hook builds ask it again", nullptr, current_interrupt));
    if (interrupt->stop_requested()) throw BuildingStopped();
}

void Threads::run(std::size_t count, int most, void* job, void (*body)(void* job, std::size_t block, int worker)) {
    std::atomic<std::size_t> next{0};
    std::atomic<int> workers{0};
    std::fenv_t environment;
    std::fegetenv(&environment);
    const Interrupt* const interrupt = current_interrupt;
    const auto work = [&] {
        if (next.load(std::memory_order_relaxed) >= count) return;
        const Environment same(environment);
        const int worker = workers.fetch_add(1, std::memory_order_relaxed);
        try {
            for (std::size_t block; (block = next.fetch_add(1, std::memory_order_relaxed)) < count;) {
                if (WATCHED("threads: other blocks go on after a stop", true)) Stoppable::look(interrupt);
                body(job, block, worker);
            }
        } catch (...) {
            next.store(count, std::memory_order_relaxed);  // no worker begins another block
            throw;                                         // task_group rethrows it in the caller
        }
    };
    // Use at most one thread per core: oneTBB would not start more, but it would print a warning.
    most = std::min(most, std::max(tbb::info::default_concurrency(), 1));
    const int wanted = static_cast<int>(std::min(static_cast<std::size_t>(most), count));
    tbb::task_arena arena(wanted);
    arena.execute([&] {
        tbb::task_group group;
        for (int i = 1; i < wanted; ++i) group.run(work);
        group.run_and_wait(work);
    });
}

}  // namespace hausbench
