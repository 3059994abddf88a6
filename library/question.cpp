#include "library/question.h"

#include "library/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

namespace hausbench::library {
namespace {

void check(const hausbench_query& query, int argument) {
    const auto fail = [&](const std::string& what) { throw ArgumentError(argument, "query: " + what); };
    if (!(query.tolerance > 0) || std::isinf(query.tolerance))
        fail(fmt::format("tolerance is {}: give a number above 0", query.tolerance));
    if (query.relative_to < HAUSBENCH_OF_DIAGONAL || query.relative_to > HAUSBENCH_OF_LOWER)
        fail(fmt::format("relative_to is {}: give OF_DIAGONAL, OF_LENGTH or OF_LOWER", query.relative_to));
    if (query.threads < 1) fail(fmt::format("threads is {}: give at least 1", query.threads));
    if (!(query.time_limit >= 0))
        fail(fmt::format("time_limit is {}: give seconds, or INFINITY for none", query.time_limit));
    if (!(query.share_tolerance > 0) || std::isinf(query.share_tolerance))
        fail(fmt::format("share_tolerance is {}: give a number above 0", query.share_tolerance));
    if (query.weigh_by_number != 0 && query.weigh_by_number != 1)
        fail(fmt::format("weigh_by_number is {}: give 0 or 1", query.weigh_by_number));
    if (query.reserved != 0) fail("reserved must be 0");
}

const char* unit_named(std::int32_t relative_to) {
    return relative_to == HAUSBENCH_OF_DIAGONAL ? "diagonal"
           : relative_to == HAUSBENCH_OF_LENGTH ? "absolute"
                                                : "lower";
}

}  // namespace

Pose pose_of(const double* matrix, const char* name, int argument, const char* of) {
    Pose pose;
    if (!matrix) return pose;
    for (int k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j) pose.rotation(k, j) = matrix[4 * k + j];
        pose.translation[k] = matrix[4 * k + 3];
    }
    if (!(matrix[12] == 0 && matrix[13] == 0 && matrix[14] == 0 && matrix[15] == 1))
        throw ArgumentError(argument, fmt::format("{}the last row of {} is {} {} {} {}, not 0 0 0 1: give the rows of "
                                                  "the matrix one after the other",
                                                  of, name, matrix[12], matrix[13], matrix[14], matrix[15]));
    if (!pose.rotation.allFinite() || !pose.translation.allFinite())
        throw ArgumentError(argument, fmt::format("{}{} has an entry that is not finite: give numbers", of, name));
    return pose;
}

Question::Question(hausbench_pair* pair, const hausbench_query* theirs, int argument)
    : pair_(given(pair, "pair", 1)->pair),
      caller_query_(taken<hausbench_query>(theirs, HAUSBENCH_QUERY_INIT, "query", argument)),
      interrupt_(&Question::asks_to_stop, this) {
    check(caller_query_, argument);
    tolerance = resolve_tolerance(caller_query_.tolerance, unit_named(caller_query_.relative_to),
                                  points_of(pair_->source().shape()), pair_->extent());
    query.tolerance = tolerance.tolerance;
    query.threads = caller_query_.threads;
    query.time_limit = caller_query_.time_limit;
    query.source_pose = pose_of(caller_query_.source_pose, "source_pose", argument, "query: ");
    query.target_pose = pose_of(caller_query_.target_pose, "target_pose", argument, "query: ");
    query.weigh = caller_query_.weigh_by_number ? WeighBy::number : WeighBy::area;
    query.share_tolerance = caller_query_.share_tolerance;
    if (caller_query_.cancel || caller_query_.progress) query.interrupt = &interrupt_;
    if (!caller_query_.chain) return;
    chain_ = &caller_query_.chain->chain;
    if (chain_->pair != pair_)
        throw ArgumentError(argument, "query: the chain belongs to another pair: begin one for this pair");
    chain_->moves.moves |= !query.source_pose.is_identity();
    chain_->moves.target_moves |= !query.target_pose.is_identity();
}

Opened Question::open(const Query& directed, bool backward) {
    Pair::Kind moves = pair_->planned();
    if (chain_) {
        moves.moves |= chain_->moves.moves;
        moves.target_moves |= chain_->moves.target_moves;
    }
    const Pair::Kind kind = pair_->kind_for(directed, backward, moves);
    Opened opened{pair_->session(kind, directed.threads)};
    if (chain_) {
        auto [at, fresh] = chain_->states.try_emplace(kind);
        if (fresh) at->second = opened.session->begin();
        opened.state = at->second.get();
    }
    return opened;
}

int Question::asks_to_stop(void* question) {
    const auto& self = *static_cast<const Question*>(question);
    return self.stop_ || (self.caller_query_.cancel && self.caller_query_.cancel(self.caller_query_.cancel_data) != 0);
}

void Question::show(const Result& so_far) {
    std::vector<hausbench_interval> bounds;
    for (const Bounds& statistic : so_far.statistics) bounds.push_back({statistic.lower, statistic.upper});
    if (query.quantity != Quantity::distribution) bounds = {{so_far.bounds.lower, so_far.bounds.upper}};
    if (caller_query_.progress(caller_query_.progress_data, bounds.data(), bounds.size()) != 0) stop_ = true;
}

// Asks as `hausbench measure` does, so that the answers have the same bits.
Answer Question::solve(Quantity quantity) {
    query.quantity = quantity;
    std::function<void(const Answer&)> closer;
    if (caller_query_.progress) closer = [this](const Answer& so_far) { show(so_far.result); };
    return ask(
        query, [this](const Query& directed, bool backward) { return open(directed, backward); }, Directions::unknown,
        closer);
}

int Question::status_of(const Result& result) const {
    switch (result.status) {
        case Status::converged:
            return HAUSBENCH_CONVERGED;
        case Status::below_floor:
            return HAUSBENCH_WITHIN;
        case Status::above_cutoff:
            return HAUSBENCH_ABOVE;
        default:
            break;
    }
    if (interrupt_.stopped()) return HAUSBENCH_CANCELLED;
    if (result.status == Status::time_limit) return HAUSBENCH_TIME_LIMIT;
    return result.status == Status::precision_floor ? HAUSBENCH_PRECISION : HAUSBENCH_STALLED;
}

void Question::answer(const Answer& solved, hausbench_answer& answer) const {
    const Result& result = solved.result;
    hausbench_answer ours = HAUSBENCH_ANSWER_INIT;
    ours.prepare_seconds = solved.prepare_seconds;
    ours.solve_seconds = solved.solve_seconds;
    ours.status = status_of(result);
    if (!may_bound_a_distance(result.bounds)) {
        ours.status = HAUSBENCH_STALLED;
        give(answer, ours);
        return;
    }
    ours.bounds = {result.bounds.lower, result.bounds.upper};
    const Witness& witness = result.witness;
    ours.to_source = witness.direction == Witness::Direction::target_to_source ? 1 : 0;
    std::copy_n(witness.source_point.data(), 3, ours.source_point);
    std::copy_n(witness.target_point.data(), 3, ours.target_point);
    ours.source_row = witness.source_element;
    ours.target_row = witness.target_element;
    give(answer, ours);
}

}  // namespace hausbench::library
