// kernel/parallel.h must run each block exactly once, with no more workers than asked for. Structures are built by such
// workers.
#include "algorithms/kernel/parallel.h"

#include "algorithms/kernel/deadline.h"
#include "algorithms/session/session.h"
#include "tests/support/process_threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace hausbench {
namespace {

TEST(Parts, CoverAllItemsOnce) {
    for (const std::size_t items : {0u, 1u, 7u, 64u, 1000u}) {
        for (const std::size_t blocks : {1u, 2u, 3u, 7u, 64u, 65u}) {
            std::size_t end = 0, least = items, most = 0;
            for (std::size_t block = 0; block < blocks; ++block) {
                const Part range = part(items, block, blocks);
                EXPECT_EQ(range.begin, end);
                end = range.end;
                least = std::min(least, range.size());
                most = std::max(most, range.size());
            }
            EXPECT_EQ(end, items);
            EXPECT_LE(most - least, 1u);
        }
    }
    EXPECT_EQ(blocks_of(0, 10), 1u);
    EXPECT_EQ(blocks_of(29, 10), 2u);
}

TEST(Threads, RunEachBlockOnce) {
    for (const int most : {0, 1, 2, 3, 16}) {
        for (const std::size_t count : {0u, 1u, 2u, 5u, 1000u}) {
            std::vector<int> runs(count);
            Threads(most).for_each(count, [&](std::size_t block) { ++runs[block]; });
            EXPECT_EQ(runs, std::vector<int>(count, 1)) << most;
        }
    }
}

TEST(Threads, StopIfAnInterruptAsksTo) {
    const Interrupt interrupt([](void*) { return 1; }, nullptr);
    std::atomic<int> runs = 0;
    const auto count = [&](std::size_t) { ++runs; };
    for (const int most : {1, 3}) {
        runs = 0;
        const Stoppable stoppable(&interrupt);
        EXPECT_THROW(Threads(most).for_each(100'000, count), BuildingStopped);
        EXPECT_EQ(runs, 0);
        const Stoppable inner(nullptr);
        Threads(most).for_each(7, count);
        EXPECT_EQ(runs, 7);
    }
    Threads(3).for_each(7, count);
    EXPECT_EQ(runs, 14);
}

TEST(Threads, StopInTheMiddle) {
    for (const int most : {1, 3}) {
        int calls = 0;
        const Interrupt interrupt([](void* data) { return ++*static_cast<int*>(data) > 1 ? 1 : 0; }, &calls);
        std::atomic<int> runs = 0;
        const Stoppable stoppable(&interrupt);
        const auto slow = [&](std::size_t) {
            ++runs;
            std::this_thread::sleep_for(std::chrono::milliseconds(3));
        };
        EXPECT_THROW(Threads(most).for_each(300, slow), BuildingStopped) << most;
        EXPECT_GT(runs, 0);
        EXPECT_LT(runs, 300);
    }
}

TEST(Threads, AreNoMoreThanAskedFor) {
    for (const int most : {1, 2, 3}) {
        std::vector<std::atomic<int>> inside(static_cast<std::size_t>(most));
        std::atomic<bool> shared = false, beyond = false;
        Threads(most).for_each(2000, [&](std::size_t, int worker) {
            if (worker < 0 || worker >= most) {
                beyond = true;
                return;
            }
            auto& mine = inside[static_cast<std::size_t>(worker)];
            if (mine.fetch_add(1) != 0) shared = true;
            for (volatile int i = 0; i < 100;) i = i + 1;
            mine.fetch_sub(1);
        });
        EXPECT_FALSE(beyond) << most;
        EXPECT_FALSE(shared) << most << ": two blocks at the same time had one worker";
    }
}

TEST(Threads, OneRunsInOrderInTheCaller) {
    const std::ptrdiff_t before = threads_of_process();
    const std::thread::id caller = std::this_thread::get_id();
    std::vector<std::size_t> order;
    bool elsewhere = false;
    Threads(1).for_each(100, [&](std::size_t block, int worker) {
        order.push_back(block);
        elsewhere = elsewhere || worker != 0 || std::this_thread::get_id() != caller;
    });
    EXPECT_FALSE(elsewhere);
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
    EXPECT_EQ(order.size(), 100u);
    EXPECT_EQ(threads_of_process(), before);
}

TEST(Threads, ThrowOnWhatABlockThrows) {
    for (const int most : {1, 2}) {
        std::atomic<std::size_t> runs = 0;
        const auto body = [&](std::size_t block) {
            ++runs;
            if (block == 3) throw std::runtime_error("block 3");
        };
        EXPECT_THROW(Threads(most).for_each(1000000, body), std::runtime_error);
        EXPECT_LT(runs, 1000000u) << "the loop went on";
        runs = 0;
        Threads(most).for_each(3, body);  // the next loop still works
        EXPECT_EQ(runs, 3u);
    }
}

TEST(Threads, RoundAsTheCallerDoes) {
    std::fesetround(FE_UPWARD);
    std::atomic<int> other = 0;
    Threads(2).for_each(1000, [&](std::size_t) { other += std::fegetround() != FE_UPWARD; });
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(other, 0);
    Threads(2).for_each(1000, [&](std::size_t) { other += std::fegetround() != FE_TONEAREST; });
    EXPECT_EQ(other, 0);
}

// --- structures -------------------------------------------------------------------------------------------------------

struct Counting {
    static constexpr std::string_view structure_name = "counting";
    static constexpr int structure_layout = 1;
    Counting(const Points&, const Threads& threads) : builders(threads.most()) {}
    std::size_t bytes() const { return sizeof(*this); }
    int builders;
};

struct CountingWithParameters {
    static constexpr std::string_view structure_name = "counting, with parameters";
    static constexpr int structure_layout = 1;
    struct Parameters {
        int size = 1;
        std::string text() const { return std::to_string(size); }
    };
    CountingWithParameters(const Points&, const Parameters&, const Threads& threads) : builders(threads.most()) {}
    std::size_t bytes() const { return sizeof(*this); }
    int builders;
};

// A solver that returns, as its bounds, how many threads built its structures.
class Asking final : public Solver {
public:
    Needs needs(const Scene&, const QuerySet&) const override {
        return {need<Counting>(Side::target), need<CountingWithParameters>(Side::source)};
    }
    void prepare(const Scene&, const Prepared& prepared) override { prepared_ = &prepared; }
    Result solve(const Query&, State*, Trace&) const override {
        Result result;
        result.bounds.lower = prepared_->get<Counting>(Side::target).builders;
        result.bounds.upper = prepared_->get<CountingWithParameters>(Side::source).builders;
        EXPECT_EQ(prepared_->threads().most(), result.bounds.lower);
        return result;
    }

private:
    const Prepared* prepared_ = nullptr;
};

SolverEntry asking(bool threads) {
    SolverEntry entry;
    entry.info.name = "asking";
    entry.info.source.points = entry.info.target.points = true;
    entry.info.original_coordinates = true;
    if (threads) entry.info.abilities.insert(Ability::threads);
    entry.info.may_need = {need<Counting>(Side::target), need<CountingWithParameters>(Side::source)};
    entry.make = [](const Options&) -> std::unique_ptr<Solver> { return std::make_unique<Asking>(); };
    return entry;
}

TEST(Threads, BuildStructuresOfASolverThatOffersThem) {
    const PointSet point{Points::Zero(1, 3)};
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));  // the most workers
    const int three = std::min(3, cores), two = std::min(2, cores);
    for (const bool offered : {false, true}) {
        QuerySet queries;
        queries.threads = 3;
        const Session session(asking(offered), Options("asking", {}, {}), {point, point}, queries);
        Query query;
        query.tolerance.value = 10;
        Trace trace;
        const Result kept = session.solve(query, trace);
        EXPECT_EQ(kept.bounds.lower, offered ? three : 1);
        EXPECT_EQ(kept.bounds.upper, offered ? three : 1);
        // A structure over a posed copy of the target is built as part of the answer, with the threads of that query.
        query.target_pose.translation = {1, 0, 0};
        query.threads = 2;
        const Result copied = session.solve(query, trace);
        EXPECT_EQ(copied.bounds.lower, offered ? two : 1);
    }
}

}  // namespace
}  // namespace hausbench
