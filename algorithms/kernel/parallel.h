// A parallel loop over independent blocks of work, based on oneTBB. Its result does not depend on the number of
// threads.
//
//     const Threads threads(query.threads);
//     std::vector<Box> boxes(blocks);
//     threads.for_each(blocks, [&](std::size_t block) { boxes[block] = box_of(part(n, block, blocks)); });
//     for (const Box& box : boxes) ...
//
// For this, the caller must follow three rules: the number of blocks depends only on the size of the input; each block
// writes only its own data; and the results of the blocks are combined in the order of the blocks, after the loop.
//
// With one thread, this is a plain loop: oneTBB is not called, and no thread is started.
#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>

#ifdef __SANITIZE_THREAD__
#include <atomic>
#endif

namespace hausbench {

class Interrupt;

// Thrown where an interrupt ends the building of a structure.
struct BuildingStopped {};

// While it lives, loops of the thread that made it, and the building of trees, ask an interrupt now and then. If it asks
// to stop, they throw BuildingStopped. Null: they ask nothing.
class Stoppable {
public:
    explicit Stoppable(const Interrupt* interrupt);
    ~Stoppable();
    Stoppable(const Stoppable&) = delete;

    // Returns the interrupt of the calling thread, or null.
    static const Interrupt* current();

    // Throws BuildingStopped if the interrupt asks to stop. Null: does nothing.
    static void look(const Interrupt* interrupt = current());

private:
    const Interrupt* before_;
};

// The range [begin, end) of the items of one block.
struct Part {
    std::size_t begin, end;
    std::size_t size() const { return end - begin; }
};
// Cuts `items` items into `blocks` blocks whose sizes differ by at most one, and returns the range of block number
// `block`.
inline Part part(std::size_t items, std::size_t block, std::size_t blocks) {
    const std::size_t size = items / blocks, longer = items % blocks;  // items * block / blocks could overflow
    const std::size_t begin = block * size + std::min(block, longer);
    return {begin, begin + size + (block < longer ? 1 : 0)};
}

// Returns the largest number of blocks with at least `least` items each, but at least 1.
inline std::size_t blocks_of(std::size_t items, std::size_t least) {
    return std::max<std::size_t>(items / std::max<std::size_t>(least, 1), 1);
}

// Runs parallel loops on a limited number of threads.
class Threads {
public:
    explicit Threads(int most = 1) : most_(std::max(most, 1)) {}

    int most() const { return most_; }

    // Calls body(block) or body(block, worker) once for each block from 0 to count - 1, and returns when all calls have
    // returned. No more than most() calls run at a time, one of them in the calling thread. The order of the blocks,
    // and the worker of each block, may differ from run to run.
    //
    // Workers are numbered from 0 to most() - 1, and calls that run at the same time have different workers. So each
    // worker may have its own scratch buffer, as long as data that one block leaves there does not change the result of
    // another block.
    //
    // The threads belong to their own oneTBB arena, so thread counts that other code sets for oneTBB do not matter.
    // There are never more threads than cores. Each thread works in the floating-point environment of the caller, so it
    // has the same rounding mode.
    //
    // If a body throws, or an interrupt asks to stop (Stoppable), no further block is started, and the exception is
    // rethrown once the running blocks are done.
    // After a loop, do not fork() unless the child calls exec(), because fork() does not copy the threads.
    template <class Body> void for_each(std::size_t count, const Body& body) const {
        const Interrupt* interrupt = Stoppable::current();
        if (interrupt) Stoppable::look(interrupt);  // the other threads may take all blocks and cannot ask
        if (most_ <= 1 || count <= 1) {
            for (std::size_t block = 0; block < count; ++block) {
                if (interrupt) Stoppable::look(interrupt);
                call(body, block, 0);
            }
            return;
        }
        Job<Body> job{body};
        job.start();
        run(count, most_, &job, [](void* given, std::size_t block, int worker) {
            Job<Body>& mine = *static_cast<Job<Body>*>(given);
            mine.enter();
            call(mine.body, block, worker);
            mine.leave();
        });
        job.end();
    }

private:
    template <class Body> static void call(const Body& body, std::size_t block, int worker) {
        if constexpr (std::is_invocable_v<const Body&, std::size_t, int>)
            body(block, worker);
        else
            body(block);
    }

    // The body of a loop and, under the thread sanitizer, two atomics that prevent false reports of races. oneTBB is
    // not compiled with the sanitizer, so the sanitizer does not see how work passes between threads. The atomics show
    // it that every block runs after the code before the loop and before the code after the loop. They do not order the
    // blocks among themselves, so a race between two blocks is still reported.
    template <class Body> struct Job {
        const Body& body;
#ifdef __SANITIZE_THREAD__
        std::atomic<int> begun{0}, ended{0};
        void start() { begun.store(1, std::memory_order_release); }
        void enter() { (void)begun.load(std::memory_order_acquire); }
        void leave() { ended.fetch_add(1, std::memory_order_release); }
        void end() { (void)ended.load(std::memory_order_acquire); }
#else
        void start() {}
        void enter() {}
        void leave() {}
        void end() {}
#endif
    };

    static void run(std::size_t count, int most, void* job, void (*body)(void* job, std::size_t block, int worker));

    int most_;
};

}  // namespace hausbench
