// A loop of independent blocks, worked off by several threads (oneTBB), whose outcome does not depend on how many there are.
//
//     const Threads threads(query.threads);
//     std::vector<Box> boxes(blocks);
//     threads.for_each(blocks, [&](std::size_t block) { boxes[block] = box_of(part(n, block, blocks)); });
//     for (const Box& box : boxes) ...
//
// Two rules make the outcome independent of the number: the blocks are chosen by the size of the input alone, and each block writes
// only what belongs to its own number. The results are then put together in the order of the numbers.
//
// One thread makes no call of oneTBB at all: no thread is started, and the loop is a plain loop.
#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>

#ifdef __SANITIZE_THREAD__
#include <atomic>
#endif

namespace hausbench {

// The half-open range of items that belongs to a block, of `items` that are cut into `blocks` of nearly equal size.
struct Part {
    std::size_t begin, end;
    std::size_t size() const { return end - begin; }
};
inline Part part(std::size_t items, std::size_t block, std::size_t blocks) {
    const std::size_t size = items / blocks, longer = items % blocks;  // a product could overflow
    const std::size_t begin = block * size + std::min(block, longer);
    return {begin, begin + size + (block < longer ? 1 : 0)};
}

// How many blocks of at least `least` items each; at least one.
inline std::size_t blocks_of(std::size_t items, std::size_t least) {
    return std::max<std::size_t>(items / std::max<std::size_t>(least, 1), 1);
}

class Threads {
public:
    explicit Threads(int most = 1) : most_(std::max(most, 1)) {}

    int most() const { return most_; }

    // Calls body(block), or body(block, worker), once for each block below `count`; returns when all calls have
    // returned. At most most() calls run at a time, one of them in the calling thread. It is not determined which
    // blocks run at the same time, in which order, and by which worker. 0 <= worker < most(), and two calls at the
    // same time have different workers, so each may have its own memory to work in; the contents that a block leaves
    // there must not change the result of another block.
    //
    // The threads are those of oneTBB, in an arena of their own: numbers of threads that others asked for elsewhere
    // do not matter, and there are no more threads than the machine has cores. Starting them takes some ten
    // microseconds. Each works in the floating-point environment of the caller. An exception of a body ends the loop
    // once the blocks that have begun are done, and is rethrown; other blocks may then not have run. Do not fork() a
    // process after this that goes on without exec(): the threads are not copied.
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

    // The thread sanitizer does not see how the library, which is not compiled with it, hands work from thread to
    // thread. So, if it is on, this tells it the same order once more: each block sees everything before the loop,
    // and the code after the loop sees everything that the blocks did. It tells nothing about two blocks, so a race
    // between them is reported.
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
