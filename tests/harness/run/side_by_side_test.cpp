// Running jobs in parallel: limits on cores and memory, distribution of work, and child processes
// of several threads.
#include "harness/run/side_by_side.h"
#include "algorithms/error.h"
#include "harness/plan/split.h"
#include "process/child.h"

#include <gtest/gtest.h>

#include <sched.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <numeric>
#include <set>
#include <thread>

namespace hausbench {
namespace {

namespace fs = std::filesystem;

TEST(Capacity, CoresAndMemoryAreTakenAndGivenBack) {
    Capacity capacity({4, 7, 9}, 100);
    const Demand large{.cores = 2, .bytes = 70}, small{.cores = 1, .bytes = 40};
    ASSERT_TRUE(capacity.fits(large));
    const auto cores = capacity.take(large);
    EXPECT_EQ(cores, (std::vector<int>{4, 7}));
    EXPECT_FALSE(capacity.fits(small)) << "a core is free, but its memory is not";
    EXPECT_TRUE(capacity.fits({.cores = 1, .bytes = 30}));
    EXPECT_FALSE(capacity.fits({.cores = 2, .bytes = 1}));
    capacity.give_back(large, cores);
    EXPECT_TRUE(capacity.fits({.cores = 3, .bytes = 100}));
}

TEST(Capacity, WhatIsTooLargeForTheMachineRunsAlone) {
    Capacity capacity({0, 1}, 100);
    const Demand giant{.cores = 64, .bytes = 500};
    ASSERT_TRUE(capacity.fits(giant));
    const auto cores = capacity.take(giant);
    EXPECT_EQ(cores.size(), 2u);
    EXPECT_FALSE(capacity.fits({.cores = 1, .bytes = 0}));
    capacity.give_back(giant, cores);
    EXPECT_TRUE(capacity.fits(giant));
}

// A job that records the most cores and bytes in use at once, and fails if two jobs share a core. Until `cores` have
// been in use at once, a job waits for the others to begin, for at most 20 seconds.
class Watch {
public:
    Watch(const std::vector<Demand>& demands, std::size_t cores) : demands_(demands), cores_(cores) {}

    void operator()(std::size_t number, const std::vector<int>& cores) {
        {
            std::unique_lock held(lock_);
            begun_.push_back(number);
            bytes_ += demands_[number].bytes;
            most_bytes_ = std::max(most_bytes_, bytes_);
            for (const int core : cores) EXPECT_TRUE(busy_.insert(core).second) << "two share core " << core;
            most_cores_ = std::max(most_cores_, busy_.size());
            changed_.notify_all();
            changed_.wait_for(held, std::chrono::seconds(20), [&] { return most_cores_ >= cores_; });
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const std::lock_guard held(lock_);
        bytes_ -= demands_[number].bytes;
        for (const int core : cores) busy_.erase(core);
    }

    std::vector<std::size_t> begun_;
    std::int64_t most_bytes_ = 0;
    std::size_t most_cores_ = 0;

private:
    const std::vector<Demand>& demands_;
    const std::size_t cores_;
    std::mutex lock_;
    std::condition_variable changed_;
    std::int64_t bytes_ = 0;
    std::set<int> busy_;
};

TEST(SideBySide, EachRunsOnceOnCoresOfItsOwnAndTwoGiantsNeverTogether) {
    std::vector<Demand> demands;
    for (int i = 0; i < 20; ++i) demands.push_back({double(i), 1 + i % 2, i % 5 == 0 ? 60 : 10});
    Watch watch(demands, 3);
    run_side_by_side(demands, Capacity({0, 1, 2}, 100), std::ref(watch), [] { return false; });
    std::vector<std::size_t> all(demands.size());
    std::iota(all.begin(), all.end(), 0);
    std::sort(watch.begun_.begin(), watch.begun_.end());
    EXPECT_EQ(watch.begun_, all);
    EXPECT_LE(watch.most_bytes_, 100);
    EXPECT_EQ(watch.most_cores_, 3u);
}

// On one core, where jobs begin one after the other: of two threads that are given jobs at once, either may be the
// first to run.
TEST(SideBySide, TheLongestBeginsFirst) {
    std::vector<Demand> demands;
    for (const double seconds : {3.0, 1.0, 4.0, 1.5, 9.0, 2.0, 6.0}) demands.push_back({seconds, 1, 10});
    Watch watch(demands, 1);
    run_side_by_side(demands, Capacity({0}, 100), std::ref(watch), [] { return false; });
    EXPECT_EQ(watch.begun_, (std::vector<std::size_t>{4, 6, 2, 0, 5, 3, 1}));
}

TEST(SideBySide, NothingBeginsOnceItIsStopped) {
    const std::vector<Demand> demands(50);
    std::atomic<int> begun = 0;
    run_side_by_side(
        demands, Capacity({0, 1}, 1), [&](std::size_t, const std::vector<int>&) { ++begun; },
        [&] { return begun >= 5; });
    EXPECT_GE(begun, 5);
    EXPECT_LE(begun, 6) << "one may have begun on the other core";
}

TEST(SideBySide, WhatIsThrownComesOutOnceTheOthersHaveEnded) {
    const std::vector<Demand> demands(10);
    std::atomic<int> running = 0;
    const auto work = [&](std::size_t number, const std::vector<int>&) {
        ++running;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        --running;
        if (number == 0) throw InputError("the disk is full");
    };
    EXPECT_THROW(run_side_by_side(demands, Capacity({0, 1}, 1), work, [] { return false; }), InputError);
    EXPECT_EQ(running, 0);
}

TEST(SideBySide, NothingToDo) {
    run_side_by_side(
        {}, Capacity({0}, 1), [](std::size_t, const std::vector<int>&) { FAIL(); }, [] { return false; });
}

TEST(CoresHere, AreThoseThatThisProcessMayRunOn) {
    cpu_set_t set;
    ASSERT_EQ(::sched_getaffinity(0, sizeof set, &set), 0);
    EXPECT_TRUE(CPU_ISSET(cores_here(1).front(), &set));
    EXPECT_THROW(cores_here(1 << 20), InputError);
}

// Makes one job per element count; the expected work is proportional to the count.
Plan plan_of(const std::vector<std::int64_t>& elements) {
    Plan plan;
    plan.experiment.repeats = 1;
    for (const std::int64_t count : elements) {
        Case spec;
        spec.solver = "scan";
        spec.source_elements = count;
        spec.identity = "case of " + std::to_string(count);
        Job job;
        job.label = spec.identity;
        job.cases = {plan.cases.size()};
        job.pairs = {{}};
        plan.cases.push_back(spec);
        plan.jobs.push_back(job);
    }
    return plan;
}

TEST(SplitOfAPlan, TheLongestJobsGoFirstEachToTheShardWithTheLeastWork) {
    const Plan plan = plan_of({100'000, 500'000, 400'000, 310'000, 290'000});
    EXPECT_EQ(split(plan, Estimates(""), 2).of_jobs(plan), (std::vector<int>{2, 1, 2, 2, 1}));
}

TEST(SplitOfAPlan, AJobStaysWhereItIsWhileOthersComeAndGo) {
    const Estimates estimates("/no/such/folder");
    const Shards first = split(plan_of({100, 200, 300, 400}), estimates, 2);
    const Plan changed = plan_of({400, 50, 300, 1000000});
    const Shards second = split(changed, estimates, 2, first);
    EXPECT_EQ(second.of_jobs(changed)[0], first.of_jobs(plan_of({400})).front());
    EXPECT_EQ(second.of_jobs(changed)[2], first.of_jobs(plan_of({300})).front());
    EXPECT_EQ(second.shards.size(), 6u) << "what was dealt out before stays: tasks may wait for it";
    EXPECT_THROW(first.of_jobs(changed), InputError) << "it does not know the new ones";
    EXPECT_EQ(split(changed, estimates, 3, first).of_jobs(changed), split(changed, estimates, 3).of_jobs(changed));
}

TEST(SplitOfAPlan, JobsOfTheSameCasesStayTogether) {
    const Plan plan = plan_of({100, 7, 100, 100, 5000});
    const auto shards = split(plan, Estimates(""), 3).of_jobs(plan);
    EXPECT_EQ(shards[0], shards[2]);
    EXPECT_EQ(shards[0], shards[3]);
    EXPECT_EQ((std::set<int>{shards[0], shards[1], shards[4]}.size()), 3u);
}

TEST(SplitOfAPlan, IsReadAsItWasWritten) {
    const fs::path file = fs::path(testing::TempDir()) / "split.json";
    const Shards written = split(plan_of({10, 20, 30}), Estimates(""), 2);
    write_split(file, written);
    const Shards again = read_split(file);
    EXPECT_EQ(again.of, 2);
    EXPECT_EQ(again.shards, written.shards);
    for (const char* text : {"", "{}", "[1]", R"({"hausbench_split": 2, "of": 1, "shards": {}})",
                             R"({"hausbench_split": 1, "of": 0, "shards": {}})",
                             R"({"hausbench_split": 1, "of": 2, "shards": {"a": 3}})"}) {
        std::ofstream(file) << text;
        EXPECT_THROW(read_split(file), InputError) << text;
    }
}

TEST(DoesNotFit, CountsTheShapesOfTheLargestPairOnceAndNothingElse) {
    Plan plan = plan_of({1000, 2'000'000});
    ModelInfo info;
    std::vector<ResolvedModel> models(3);
    for (int i = 0; i < 3; ++i) {
        models[std::size_t(i)].shape_file = std::string(1, char('a' + i));
        models[std::size_t(i)].kind = ShapeKind::points;
        models[std::size_t(i)].vertices = 1'000'000 * (i + 1);
        plan.models.push_back({&info, models[std::size_t(i)]});
    }
    Job& job = plan.jobs[1];
    job.pairs = {{"a", "b", {}, 1}, {"b", "c", {}, 1}, {"c", "c", {}, 1}};
    const std::int64_t least = least_bytes(plan, job);
    EXPECT_EQ(least, 5'000'000 * 24) << "of a matrix one pair at a time";
    EXPECT_EQ(does_not_fit(plan, job, least), "");
    EXPECT_NE(does_not_fit(plan, job, least - 1).find("this machine has 114 MB: take a larger one"), std::string::npos);
    plan.cases[1].limits.memory_bytes = 100 << 20;
    EXPECT_NE(does_not_fit(plan, job, least).find("100 MB are allowed: raise memory_mb"), std::string::npos);
    EXPECT_GT(Estimates("").of(plan, job).bytes, 2 * 6'000'000 * 24) << "to run beside others, all of them count";
}

Launch shell(const std::string& words) {
    Launch launch;
    launch.command = {"/bin/sh", "-c", words};
    return launch;
}

// The orphan of each child must be killed when the child ends; children of other threads must not.
TEST(ChildrenOfThreads, EndOnlyWhatIsTheirOwn) {
    std::atomic<int> wrong = 0, ended = 0;
    const fs::path folder = fs::path(testing::TempDir()) / "orphans";
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
            for (int k = 0; k < 15; ++k) {
                const std::string file = (folder / (std::to_string(t) + "-" + std::to_string(k))).string();
                Child child(
                    shell("setsid sh -c 'sleep 3; touch " + file + "' & sleep 0.0" + std::to_string(1 + (t + k) % 9)));
                if (child.wait({.seconds = 60}) != Child::End::by_itself || !child.how_it_ended().empty()) ++wrong;
                ++ended;
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(ended, 60);
    EXPECT_EQ(wrong, 0) << "a child was ended by another thread";
    std::this_thread::sleep_for(std::chrono::milliseconds(3500));
    EXPECT_TRUE(fs::is_empty(folder)) << "an orphan lived on";
}

TEST(ChildrenOfThreads, ACopyThatWorksHasChildrenOfItsOwn) {
    Launch launch;
    launch.work = [](int) {
        Child child(shell("exit 7"));
        child.wait({.seconds = 30});
        return child.exit_code();
    };
    Child copy(std::move(launch));
    EXPECT_EQ(copy.wait({.seconds = 60}), Child::End::by_itself);
    EXPECT_EQ(copy.exit_code(), 7);
}

TEST(ChildrenOfThreads, RunOnTheCoresThatAreTheirs) {
    const int core = cores_here(1).front();
    Launch launch = shell("grep Cpus_allowed_list /proc/self/status");
    launch.cores = {core};
    Child child(std::move(launch));
    EXPECT_EQ(child.wait({.seconds = 60}), Child::End::by_itself);
    EXPECT_EQ(child.output(), "Cpus_allowed_list:\t" + std::to_string(core) + "\n");
}

TEST(ChildrenOfThreads, InputThatIsReadSlowlyArrivesWhole) {
    Launch launch = shell("sleep 0.2; wc -c");
    launch.input = std::string(1 << 20, 'x');
    Child child(std::move(launch));
    EXPECT_EQ(child.wait({.seconds = 60}), Child::End::by_itself);
    EXPECT_EQ(child.output(), "1048576\n");
}

TEST(ChildrenOfThreads, AChildThatNeverReadsItsInputEndsAtItsLimit) {
    Launch launch = shell("exec sleep 600");
    launch.input = std::string(1 << 20, 'x');
    Child child(std::move(launch));
    EXPECT_EQ(child.wait({.seconds = 0.2}), Child::End::time);
}

TEST(ChildrenOfThreads, ACrashIsHeardThoughAnotherProcessHoldsThePipe) {
    Launch launch = shell("sleep 600 & kill -SEGV $$");
    launch.events = true;
    Child child(std::move(launch));
    std::string line;
    int turns = 0;
    while (child.listen(std::chrono::milliseconds(20), line) != Child::Heard::closed) ASSERT_LT(++turns, 3000);
    EXPECT_EQ(child.signal(), SIGSEGV);
}

TEST(ChildrenOfThreads, TwoRunsHaveCoresOfTheirOwn) {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (::sched_getaffinity(0, sizeof set, &set) != 0 || CPU_COUNT(&set) < 2)
        GTEST_SKIP() << "this machine has one core";
    std::ifstream sockets("/proc/net/unix");
    const std::string in_use{std::istreambuf_iterator<char>(sockets), {}};
    Launch launch;
    launch.events = true;
    launch.work = [](int events) {
        const std::string told = std::to_string(cores_here(1).front()) + "\n";
        if (::write(events, told.data(), told.size()) < 0) return 1;
        ::sleep(600);
        return 0;
    };
    Child other(std::move(launch));
    std::string line;
    ASSERT_EQ(other.listen(std::chrono::seconds(60), line), Child::Heard::line);
    const int mine = cores_here(1).front();
    if (in_use.find("@hausbench-core-") != std::string::npos) GTEST_SKIP() << "another run has cores of this machine";
    EXPECT_NE(line, std::to_string(mine));
}

TEST(ChildrenOfThreads, AClosedPipeDoesNotEndTheProgram) {
    Launch launch = shell("exec 0<&-; sleep 0.2");
    launch.input = std::string(1 << 20, 'x');
    Child child(std::move(launch));
    EXPECT_EQ(child.wait({.seconds = 60}), Child::End::by_itself);
}

}  // namespace
}  // namespace hausbench
