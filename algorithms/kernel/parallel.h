// A parallel loop over independent blocks (on oneTBB) whose outcome does not depend on the number of threads.
//
//     const Threads threads(query.threads);
//     std::vector<Box> boxes(blocks);
//     threads.for_each(blocks, [&](std::size_t block) { boxes[block] = box_of(part(n, block, blocks)); });
//     for (const Box& box : boxes) ...
//
// Two rules make the outcome independent of the number: the number of blocks depends only on the size of the input,
// and each block writes only the data of its own block. The caller then combines the results in the order of the
// blocks.
//
// With one thread, oneTBB is never called: no thread is started, and the loop is a plain loop.
#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>

#ifdef __SANITIZE_THREAD__
#include <atomic>
#endif

namespace hausbench {

// The half-open range of the items in one block, when `items` items are cut into `blocks` blocks of nearly equal
// size.
struct Part {
    std::size_t begin, end;
    std::size_t size() const { return end - begin; }
};
inline Part part(std::size_t items, std::size_t block, std::size_t blocks) {
    const std::size_t size = items / blocks, longer = items % blocks;  // a product could overflow
    const std::size_t begin = block * size + std::min(block, longer);
    return {begin, begin + size + (block < longer ? 1 : 0)};
}

// Returns the number of blocks, at least one, so that each has at least `least` items.
inline std::size_t blocks_of(std::size_t items, std::size_t least) {
    return std::max<std::size_t>(items / std::max<std::size_t>(least, 1), 1);
}

class Threads {
public:
    explicit Threads(int most = 1) : most_(std::max(most, 1)) {}

    int most() const { return most_; }

    // Calls body(block) or body(block, worker) once for each block below `count`; returns when all calls have
    // returned. At most most() calls run at a time, one of them in the calling thread. It is not determined which
    // blocks run at the same time, in which order, or on which worker. 0 <= worker < most(), and two simultaneous
    // calls have different workers, so each worker may have its own scratch buffer; data that a block leaves there
    // must not change the result of another block.
    //
    // The threads belong to a oneTBB arena of their own, so thread counts requested elsewhere do not matter, and
    // there are never more threads than the machine has cores. Starting them takes some ten microseconds. Each
    // thread works in the floating-point environment of the caller. If a body throws, the loop ends once the
    // running blocks are done, other blocks may not run at all, and the exception is rethrown. Do not fork()
    // afterwards unless the child calls exec(), because fork() does not copy the threads.
    template <class Body> void for_each(std::size_t count, const Body& body) const {
        if (most_ <= 1 || count <= 1) {
            for (std::size_t block = 0; block < count; ++block) call(body, block, 0);
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

    // The thread sanitizer does not see how oneTBB, which is not compiled with it, hands work from thread to
    // thread. If the sanitizer is on, these atomics declare the same order again: each block sees everything done
    // before the loop, and the code after the loop sees everything done by the blocks. They declare no order
    // between two blocks, so a race between blocks is reported.
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

    static void run(std::size_t count, int most, void* job, void (*one)(void* job, std::size_t block, int worker));

    int most_;
};

}  // namespace hausbench
