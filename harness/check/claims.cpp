#include "check/claims.h"

#include "solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hausbench {

namespace {

std::string gap_above_tolerance(const Row& row) {
    const Bounds& bounds = row.outcome.bounds;
    Query query;
    query.tolerance = row.asked.resolved_tolerance();
    query.floor = row.asked.floor;
    query.cutoff = std::min(row.asked.cutoff, row.outcome.cutoff_used);  // older files have no cutoff_used
    // A session solves in other units, and rounds bounds outward where they are subnormal in ours.
    constexpr double least = std::numeric_limits<double>::denorm_min();
    if (query.answer(bounds.lower, bounds.upper) || query.answer(bounds.lower + least, bounds.upper - least)) return "";
    return fmt::format(
        "its status is ok, but [{:.17g}, {:.17g}] is not within the tolerance, {:.17g}, nor an answer to its "
        "floor or cutoff",
        bounds.lower, bounds.upper, query.tolerance.gap(bounds.lower));
}

}  // namespace

std::string contradiction_in(const Row& row) {
    const Bounds& bounds = row.outcome.bounds;
    const bool bounded = !std::isnan(bounds.lower) && !std::isnan(bounds.upper);
    if (!bounded && is_timed(row.outcome.status))
        return fmt::format("its status is {}, but a bound is not a number", to_string(row.outcome.status));
    for (const auto& [name, hash] :
         {std::pair(row.asked.source, row.asked.source_hash), std::pair(row.asked.target, row.asked.target_hash)}) {
        if (bounded && hash.empty())
            return fmt::format("it has bounds, but the result does not list its model '{}'", name);
    }
    if (identify(row.asked) != row.asked.identity)
        return "its identity is not that of its shapes, poses, options and limits";
    return row.outcome.status == RowStatus::ok ? gap_above_tolerance(row) : "";
}

std::string wrong_witness(const Row& row, const Shape& source, const Shape& target) {
    const Witness& witness = row.outcome.witness;
    const auto wrong = [](const char* side, Index element, const Shape& shape) -> std::string {
        if (element >= -1 && element < element_count(shape)) return "";
        return fmt::format("its witness names element {} of the {}, which has {}", element, side, element_count(shape));
    };
    const std::string first = wrong("source", witness.source_element, source);
    return first.empty() ? wrong("target", witness.target_element, target) : first;
}

std::vector<std::string> contradictions(const std::vector<Row>& rows,
                                        const std::function<const Shape*(const std::string&)>& load) {
    constexpr std::size_t most = 20;
    std::vector<std::string> lines;
    std::size_t count = 0;
    for (const Row& row : rows) {
        std::string what = contradiction_in(row);
        const Shape *source = load(row.asked.source), *target = load(row.asked.target);
        if (what.empty() && source && target) what = wrong_witness(row, *source, *target);
        if (what.empty()) continue;
        if (++count <= most) lines.push_back(fmt::format("{}: {}", name_of(row.asked), what));
    }
    if (count > most) lines.push_back(fmt::format("{} more rows contradict themselves", count - most));
    return lines;
}

}  // namespace hausbench
