// Combines the outcomes of a case's rounds into one row, and derives rows of coarser tolerances from its trace.
#include "harness/run/rounds.h"

#include <gtest/gtest.h>

namespace hausbench {
namespace {

Outcome answered(double lower, double upper, double prepare_seconds, int round) {
    Outcome o;
    o.status = RowStatus::ok;
    o.solver_status = "converged";
    o.bounds = {lower, upper};
    o.prepare_seconds = prepare_seconds;
    o.preparation = {{round, "octree of the source", 0.75 * prepare_seconds, 100},
                     {round, "solver", 0.25 * prepare_seconds, 10}};
    o.answers = {{round, 0.6 + round, 0.5, 0.1}};
    o.repeats = {{round, 0.5, 0.4, 1}};
    o.clock = "cpu";
    return o;
}

Outcome killed(RowStatus status, const std::string& reason) {
    Outcome o;
    o.status = status;
    o.reason = reason;
    return o;
}

Outcome gathered(const std::vector<Outcome>& rounds) {
    std::map<int, const Outcome*> all;
    for (std::size_t i = 0; i < rounds.size(); ++i) all[int(i)] = &rounds[i];
    return gather_rounds(all);
}

TEST(Rounds, EveryRoundsPreparationIsKept) {
    const Outcome o = gathered({answered(1, 2, 4, 0), answered(1, 2, 1, 1), answered(1, 2, 2, 2)});
    EXPECT_EQ(o.status, RowStatus::ok);
    EXPECT_EQ(o.prepare_seconds, 2);
    ASSERT_EQ(o.preparation.size(), 6u);
    for (int i = 0; i < 6; ++i) EXPECT_EQ(o.preparation[std::size_t(i)].round, i / 2);
    EXPECT_EQ(o.preparation[2].seconds, 0.75);
    EXPECT_EQ(o.repeats.size(), 3u);
    ASSERT_EQ(o.answers.size(), 3u);
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(o.answers[std::size_t(i)].round, i);
        EXPECT_EQ(o.answers[std::size_t(i)].wall_seconds, 0.6 + i);
    }
    EXPECT_EQ(gathered({answered(1, 2, 4, 0), answered(1, 2, 1, 1)}).prepare_seconds, 2.5);
}

TEST(Rounds, OtherBoundsAreAFailure) {
    for (const Outcome& other : {answered(1, 2.5, 1, 1), answered(0.5, 2, 1, 1)}) {
        const Outcome o = gathered({answered(1, 2, 1, 0), other, answered(1, 2, 1, 2)});
        EXPECT_EQ(o.status, RowStatus::failed);
        EXPECT_NE(o.reason.find("round 1"), std::string::npos) << o.reason;
        EXPECT_NE(o.reason.find("not deterministic"), std::string::npos) << o.reason;
    }
    Outcome floor = answered(1, 2, 1, 1);
    floor.status = RowStatus::floor, floor.solver_status = "precision_floor";
    EXPECT_EQ(gathered({answered(1, 2, 1, 0), floor}).status, RowStatus::failed);
}

TEST(Rounds, ALimitInALaterRoundIsThatLimit) {
    Outcome stopped = answered(0.5, 3, 1, 2);  // stopped by its own deadline, with wider but valid bounds
    stopped.status = RowStatus::timeout, stopped.solver_status = "time_limit", stopped.reason = "not within 1 s";
    Outcome untimed = answered(1, 2, 1, 1);  // killed during its timed repeats
    untimed.status = RowStatus::timeout, untimed.repeats.clear(), untimed.reason = "not while it was timed";
    for (const Outcome& late : {killed(RowStatus::timeout, "killed: no answer within 1 s"), stopped, untimed,
                                killed(RowStatus::out_of_memory, "too much"), killed(RowStatus::signal, "signal 11")}) {
        const Outcome o = gathered({answered(1, 2, 1, 0), answered(1, 2, 1, 1), late});
        EXPECT_EQ(o.status, late.status);
        EXPECT_EQ(o.reason, "in round 2: " + late.reason);
        EXPECT_EQ(o.bounds.lower, 1);
        EXPECT_EQ(o.bounds.upper, 2);
        // Two different answers are a failure, even if another round hits a limit.
        EXPECT_EQ(gathered({answered(1, 2, 1, 0), late, answered(1, 3, 1, 2)}).status, RowStatus::failed);
        EXPECT_EQ(gathered({answered(1, 2, 1, 0), answered(1, 3, 1, 1), late}).status, RowStatus::failed);
    }
}

TEST(Rounds, OneRoundOfSeveralThreadsMakesItWallTime) {
    EXPECT_EQ(gathered({answered(1, 2, 1, 0), answered(1, 2, 1, 1)}).clock, "cpu");
    Outcome threaded = answered(1, 2, 1, 1);
    threaded.clock = "wall";
    EXPECT_EQ(gathered({answered(1, 2, 1, 0), threaded}).clock, "wall");
    Outcome children = answered(1, 2, 1, 1);  // several threads in the timed repeat alone
    children.repeats = {{1, 0.5, 0.9, 1}};
    EXPECT_EQ(gathered({answered(1, 2, 1, 0), children}).clock, "wall");
}

Outcome traced() {
    Outcome o = answered(1, 1.01, 1, 0);
    o.trace = {{0.1, 0, 3}, {0.2, 0.9, 1.1}, {0.3, 1, 1.01}};
    return o;
}

TEST(Rounds, ACoarserToleranceIsReadOffTheTrace) {
    const Outcome o = read_off_trace(traced(), 0.25);
    EXPECT_EQ(o.status, RowStatus::ok);
    EXPECT_EQ(o.bounds.lower, 0.9);
    EXPECT_EQ(o.solve_seconds, 0.2);
    EXPECT_TRUE(o.answers.empty());  // no time was measured for it
    EXPECT_TRUE(o.from_trace && o.repeats.empty() && o.trace.empty());
    // The same holds if the finer case ran out of time or stalled after that.
    Outcome late = traced();
    late.status = RowStatus::timeout, late.solver_status = "time_limit";
    EXPECT_EQ(read_off_trace(late, 0.25).status, RowStatus::ok);
    EXPECT_EQ(read_off_trace(late, 0.001).status, RowStatus::timeout);
    Outcome stalled = traced();
    stalled.status = RowStatus::failed, stalled.solver_status = "stalled";
    EXPECT_EQ(read_off_trace(stalled, 0.25).status, RowStatus::ok);
}

// The trace comes from a second solve, which may reach a larger lower bound before its time is up. The answer's witness
// does not prove that bound, so a row with both would be called unsound.
TEST(Rounds, ATraceThatWentFurtherThanTheAnswerIsNotRead) {
    Outcome cut = traced();
    cut.status = RowStatus::timeout, cut.solver_status = "time_limit", cut.reason = "not within 2 s";
    cut.bounds = {0.8, 3};
    const Outcome coarse = read_off_trace(cut, 0.25);
    EXPECT_EQ(coarse.status, RowStatus::timeout);
    EXPECT_EQ(coarse.bounds.lower, 0.8);
    EXPECT_EQ(coarse.bounds.upper, 3);
    cut.bounds = {0.9, 3};  // the answer now proves the trace's lower bound of 0.9
    EXPECT_EQ(read_off_trace(cut, 0.25).status, RowStatus::ok);
}

// A sampler ignores the tolerance. Its bounds have a fixed gap, which may be small enough for a coarser tolerance.
TEST(Rounds, AnAnswerThatIgnoresTheToleranceMayDoForACoarserOne) {
    Outcome fine = traced();
    fine.bounds = {1, 1.125};
    for (const auto& [status, solver_status] :
         {std::pair(RowStatus::budget, "budget"), std::pair(RowStatus::floor, "precision_floor")}) {
        fine.status = status, fine.solver_status = solver_status, fine.reason = "spent";
        const Outcome coarse = read_off_answer(fine, 0.125), finer = read_off_answer(fine, 0.0625);
        EXPECT_TRUE(coarse.status == RowStatus::ok && coarse.reason.empty() && coarse.solver_status == "converged");
        EXPECT_TRUE(finer.status == status && finer.reason == "spent");
    }
    fine.status = RowStatus::timeout;
    EXPECT_EQ(read_off_answer(fine, 0.125).status, RowStatus::timeout);
}

TEST(Rounds, WhatIsNotDeterministicHoldsNoAnswerAtAnyTolerance) {
    Outcome other = traced();
    other.bounds.upper = 1.02;
    const Outcome fine = gathered({traced(), other});
    ASSERT_EQ(fine.status, RowStatus::failed);
    const Outcome coarse = read_off_trace(fine, 0.25);
    EXPECT_EQ(coarse.status, RowStatus::failed);
    EXPECT_EQ(coarse.reason, fine.reason);
    Outcome differs = traced();  // the reason comes from the traced run
    differs.status = RowStatus::failed, differs.reason = "the traced run ended with other bounds";
    EXPECT_EQ(read_off_trace(differs, 0.25).status, RowStatus::failed);
    EXPECT_EQ(read_off_answer(fine, 0.25).status, RowStatus::failed);
}

}  // namespace
}  // namespace hausbench
