#include "harness/check/contradictions.h"

#include "algorithms/kernel/watched.h"
#include "algorithms/solver.h"

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
    query.tolerance = row.spec.resolved_tolerance();
    query.floor = row.spec.floor;
    query.cutoff = std::min(row.spec.cutoff, row.outcome.cutoff_used);  // missing in older files
    // Solvers work in scaled units. Scaling back rounds subnormal bounds outward, by at most `least`, so it is enough
    // if the bounds without this rounding answer the query.
    constexpr double least = std::numeric_limits<double>::denorm_min();
    if (query.answer(bounds.lower, bounds.upper) || query.answer(bounds.lower + least, bounds.upper - least)) return "";
    return fmt::format(
        "its status is ok, but [{:.17g}, {:.17g}] is not within the tolerance, {:.17g}, nor an answer to its "
        "floor or cutoff",
        bounds.lower, bounds.upper, query.tolerance.gap(bounds.lower));
}

// Returns a contradiction between the row's status and the status that its solver returned, or an empty string. They
// must agree unless the harness changed the row's status afterwards, such as to `signal` for a crash.
std::string other_status(const Row& row) {
    const Outcome& o = row.outcome;
    const bool by_itself = o.status == RowStatus::ok || o.status == RowStatus::floor || o.status == RowStatus::budget;
    if (!by_itself || o.from_trace || o.solver_status.empty()) return "";
    for (const Status status : {Status::converged, Status::below_floor, Status::above_cutoff, Status::time_limit,
                                Status::budget, Status::precision_floor, Status::stalled}) {
        if (o.solver_status == to_string(status) && row_status(status) == o.status) return "";
    }
    return fmt::format("its status is {}, but its solver ended with {}", to_string(o.status), o.solver_status);
}

}  // namespace

std::string contradiction_in(const Row& row) {
    const Bounds& bounds = row.outcome.bounds;
    const bool bounded = !std::isnan(bounds.lower) && !std::isnan(bounds.upper);
    if (!bounded && is_timed(row.outcome.status))
        return fmt::format("its status is {}, but a bound is not a number", to_string(row.outcome.status));
    for (const auto& [name, hash] :
         {std::pair(row.spec.source, row.spec.source_hash), std::pair(row.spec.target, row.spec.target_hash)}) {
        if (bounded && hash.empty())
            return fmt::format("it has bounds, but the result does not list its model '{}'", name);
    }
    if (identify(row.spec) != row.spec.identity)
        return "its identity does not follow from its shapes, poses, options and limits";
    if (row.outcome.cutoff_used < row.spec.cutoff && (row.spec.chain.empty() || row.spec.warm))
        return "its cutoff_used is below its cutoff, but it is in no search";
    if (std::string what = other_status(row); !what.empty()) return what;
    return row.outcome.status == RowStatus::ok ? gap_above_tolerance(row) : "";
}

std::string wrong_size(const Case& spec, const Shape& source) {
    constexpr double rounding = 1e-12;  // another compiler may sum in another order
    const auto differ = [](double told, double is) { return !(std::abs(told - is) <= rounding * is); };
    const double across = diagonal(points_of(source)), longest = longest_side(points_of(source));
    if (differ(spec.source_diagonal, across) || (spec.source_longest != 0 && differ(spec.source_longest, longest)))
        return fmt::format(
            "it gives A a diagonal of {:.17g} and a longest side of {:.17g}, but they are {:.17g} and {:.17g}",
            spec.source_diagonal, spec.source_longest, across, longest);
    return "";
}

std::string wrong_witness(const Witness& witness, Index source_elements, Index target_elements) {
    const auto wrong = [](const char* side, Index element, Index count) -> std::string {
        if (element >= -1 && element < count) return "";
        return fmt::format("its witness names element {} of the {}, which has {}", element, side, count);
    };
    const std::string first = wrong("source", witness.source_element, source_elements);
    return first.empty() ? wrong("target", witness.target_element, target_elements) : first;
}

std::vector<std::string> contradictions(const std::vector<Row>& rows,
                                        const std::function<const Shape*(const std::string&)>& load) {
    constexpr std::size_t most = 20;
    std::vector<std::string> lines;
    std::size_t count = 0;
    for (const Row& row : rows) {
        std::string what = contradiction_in(row);
        const Shape *source = load(row.spec.source), *target = load(row.spec.target);
        if (what.empty() && source && target)
            what = wrong_witness(row.outcome.witness, element_count(*source), element_count(*target));
        if (WATCHED("verify: the size of A is that of its model", what.empty() && source))
            what = wrong_size(row.spec, *source);
        if (what.empty()) continue;
        if (++count <= most) lines.push_back(fmt::format("{}: {}", name_of(row.spec), what));
    }
    if (count > most) lines.push_back(fmt::format("{} more rows contradict themselves", count - most));
    return lines;
}

}  // namespace hausbench
