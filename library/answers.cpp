// The questions of the C interface.
#include "algorithms/kernel/parallel.h"
#include "algorithms/kernel/rounding.h"
#include "harness/ask/fields.h"
#include "library/errors.h"
#include "library/question.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hausbench::library {
namespace {

// Returns the intervals of the distances from all given vertices of A to B, and the nearest rows of B.
std::pair<std::vector<hausbench_interval>, std::vector<Index>> field(const Question& question) {
    const Pair& pair = question.pair();
    const Query& query = question.query;
    const Deadline deadline = query.deadline();
    const PreparedShape from(SharedShape(PointSet{pair.source().given_points()}));
    const PreparedShape to(SharedShape(Shape(pair.target().shape())));
    Drawing drawing;
    drawing.deadline = &deadline;
    DrawnField drawn;
    try {
        const Stoppable stoppable(query.interrupt);
        drawn = draw_distance(from, query.source_pose, to, query.target_pose, drawing);
    } catch (const BuildingStopped&) {
        const auto count = static_cast<std::size_t>(points_of(from.shape()).rows());
        return {std::vector<hausbench_interval>(count, {0, infinity}), std::vector<Index>(count, -1)};
    }
    const double of_target = magnitude(posed(points_of(to.shape()), query.target_pose));
    const double largest = std::max(magnitude(drawn.vertices), of_target);
    std::vector<hausbench_interval> intervals(drawn.distances.size(), {0, infinity});
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        if (drawn.nearest[i] < 0) continue;  // no time was left for it
        const double distance = drawn.distances[i];
        const double error = field_error(drawn.vertices.row(static_cast<Index>(i)), of_target, largest);
        intervals[i] = {std::max(0.0, next_down(distance - error)), next_up(distance + error)};
    }
    return {std::move(intervals), std::move(drawn.nearest)};
}

std::vector<Statistic> statistics_of(const char* const* statistics, std::size_t count) {
    given(statistics, "statistics", 2);
    if (count == 0) throw ArgumentError(3, "count: is 0: name at least one statistic, such as \"mean\"");
    std::vector<Statistic> all;
    for (std::size_t i = 0; i < count; ++i) {
        const char* text = given(statistics[i], "statistics: one", 2);
        try {
            all.push_back(statistic_of(text));
        } catch (const InputError& error) {
            throw ArgumentError(2, fmt::format("statistics: {}", error.what()), static_cast<std::int64_t>(i));
        }
    }
    return all;
}

// Throws ArgumentError if a statistic weighs the parts of a shape that has neither area nor length.
void expect_sizes(const Question& question) {
    if (question.query.weigh == WeighBy::number) return;
    const Pair& pair = question.pair();
    const auto refuse = [](const char* name) {
        throw ArgumentError(2,
                            fmt::format("statistics: {} has neither area nor length, by which they weigh: count each "
                                        "vertex once",
                                        name));
    };
    const std::vector<Statistic>& wanted = question.query.statistics;
    if (std::any_of(wanted.begin(), wanted.end(), needs_source) &&
        counted_by(pair.source().shape()) == CountedBy::nothing)
        refuse("the source");
    if (std::any_of(wanted.begin(), wanted.end(), needs_target) &&
        counted_by(pair.target().shape()) == CountedBy::nothing)
        refuse("the target");
}

}  // namespace
}  // namespace hausbench::library

using namespace hausbench::library;

extern "C" {

int hausbench_directed(hausbench_pair* pair, const hausbench_query* query, hausbench_answer* answer,
                       hausbench_error* error) {
    return guarded(error, [&] {
        expect_size(*given(answer, "answer", 3), "answer", 3);
        Question question(pair, query, 2);
        question.answer(question.solve(hausbench::Quantity::directed), *answer);
    });
}

int hausbench_symmetric(hausbench_pair* pair, const hausbench_query* query, hausbench_answer* answer,
                        hausbench_error* error) {
    return guarded(error, [&] {
        expect_size(*given(answer, "answer", 3), "answer", 3);
        Question question(pair, query, 2);
        question.answer(question.solve(hausbench::Quantity::symmetric), *answer);
    });
}

int hausbench_within(hausbench_pair* pair, int32_t symmetric, double length, const hausbench_query* query,
                     hausbench_answer* answer, hausbench_error* error) {
    return guarded(error, [&] {
        expect_size(*given(answer, "answer", 5), "answer", 5);
        expect_flag(symmetric, "symmetric", 2);
        if (!(length >= 0 && std::isfinite(length)))
            throw ArgumentError(3, fmt::format("length: is {}: give a finite length of at least 0", length));
        Question question(pair, query, 4);
        question.query.floor = question.query.cutoff = length;
        if (std::isinf(question.query.time_limit)) question.query.time_limit = hausbench::question_seconds;
        question.answer(question.solve(symmetric ? hausbench::Quantity::symmetric : hausbench::Quantity::directed),
                        *answer);
    });
}

int hausbench_distribution(hausbench_pair* pair, const char* const* statistics, size_t count,
                           const hausbench_query* query, hausbench_interval* values, hausbench_answer* answer,
                           hausbench_error* error) {
    return guarded(error, [&] {
        given(values, "values", 5);
        expect_size(*given(answer, "answer", 6), "answer", 6);
        Question question(pair, query, 4);
        question.query.statistics = statistics_of(statistics, count);
        expect_sizes(question);
        const hausbench::Answer solved = question.solve(hausbench::Quantity::distribution);
        const hausbench::Result& result = solved.result;
        for (std::size_t i = 0; i < count; ++i) {
            const bool bounded = i < result.statistics.size() && may_bound_a_distance(result.statistics[i]);
            const bool share = is_share(question.query.statistics[i]);
            values[i] = {0, share ? 1 : hausbench::infinity};
            if (bounded) values[i] = {result.statistics[i].lower, result.statistics[i].upper};
        }
        question.answer(solved, *answer);
        answer->bounds = values[0];
    });
}

int hausbench_field(hausbench_pair* pair, const hausbench_query* query, hausbench_interval* values, int64_t* nearest,
                    hausbench_error* error) {
    return guarded(error, [&] {
        given(values, "values", 3);
        const Question question(pair, query, 2);
        const auto [intervals, rows] = field(question);
        std::copy(intervals.begin(), intervals.end(), values);
        if (nearest) std::copy(rows.begin(), rows.end(), nearest);
    });
}

}  // extern "C"
