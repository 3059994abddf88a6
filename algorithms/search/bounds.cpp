#include "algorithms/search/bounds.h"

#include "algorithms/kernel/watched.h"

#include <cmath>

namespace hausbench {

// Returns a proven lower bound on the distance from a point of A to B. The computed distance may be too large, so
// Target::certified_distance() proves a bound for the computed point. Rounding may have moved this point off A by up to
// 2 * level * uM, which is subtracted; u = 2^-53, and M is the largest |coordinate| (kernel/rounding.h).
double SearchBounds::lower_of(const Farthest& farthest, Counters& counters) const {
    if (!WATCHED("search: the witness is certified", rounding_.certify) || farthest.source < 0)
        return std::sqrt(std::max(farthest.point.squared, 0.0));
    const double distance = target_.certified_distance(farthest.point.point, counters);
    return surface_distance_at_least(
        distance, rounding_.magnitude,
        WATCHED_ELSE(
            "search: the witness of a piece is widened by its level",
            WATCHED_ELSE("search: the witness of a piece is widened by its level, in guthe",
                         WATCHED("fields: the lower bound of a triangle is widened by the level", farthest.level), 0),
            0));
}

double SearchBounds::certified_lower() {
    if (certified_ < 0) certified_ = lower_of(farthest_, counters_);
    return certified_;
}

void SearchBounds::show(double upper) {
    if (!trace_.due()) return;
    Counters uncounted;
    trace_.show(lower_of(farthest_, uncounted), upper);
}

std::optional<Status> SearchBounds::answered(double queued) {
    while (true) {
        const double high = std::max(WATCHED("search: what is settled counts for the end", settled_),
                                     WATCHED("search: what is queued counts for the end", queued));
        const double low = std::max(
            std::sqrt(farthest_squared()) - WATCHED("search: what certifying costs, while the search goes on", loss_),
            0.0);
        if (trace_.on()) trace_.record(certified_lower(), high);
        show(high);
        // Certification costs a query, so it comes last: when the uncertified bounds seem to answer the query, or when
        // splitting cannot lower the upper bound any more.
        const std::optional<Status> seems =
            query_.answer(low, WATCHED_ELSE("search: a hidden length", high, high - 1e-7));
        const bool done = WATCHED("search: the end when splitting changes nothing", queued <= settled_);
        if (seems || done) {
            if (const auto answer = query_.answer(
                    WATCHED_ELSE("search: an answer rests on the certified lower bound", certified_lower(), low),
                    WATCHED_ELSE("search: a hidden length", high, high - 1e-7)))
                return answer;
        }
        if (seems != Status::converged && !done) return std::nullopt;
        if (!seems) return Status::precision_floor;
        // Certification lowered the lower bound by this loss. The search must narrow the gap by as much before it tries
        // again. If the loss reaches the tolerance, doubles are not precise enough.
        loss_ = std::max(2 * loss_, std::sqrt(farthest_squared()) - certified_lower());
        if (!(loss_ < query_.tolerance.gap(certified_lower()))) return Status::precision_floor;
    }
}

std::optional<Status> SearchBounds::end(double queued, std::uint64_t spent) {
    if (const auto answer = answered(queued)) return answer;
    if (spent >= query_.budget) return Status::budget;
    if (spent % 64 == 0 && deadline_.passed()) return Status::time_limit;
    return std::nullopt;
}

Result SearchBounds::result(Status status, double queued) {
    Result result;
    const double lower = certified_lower();
    result.bounds = {lower, std::max({WATCHED("search: the result has the bound of what is settled", settled_),
                                      WATCHED("search: the result has the bound of what is queued", queued),
                                      WATCHED("search: upper is never below lower", lower)})};
    if (farthest_.source >= 0) {
        const MeasuredPoint& far = farthest_.point;
        const ClosestPoint nearest = target_.closest(far.point, far.triangle, counters_);
        result.witness = {far.point, nearest.point, farthest_.source, nearest.triangle};
        status = query_.answer(lower, result.bounds.upper).value_or(status);
        trace_.record(lower, result.bounds.upper);
    }
    result.status = status;
    result.counters = counters_;
    return result;
}

Result SearchBounds::result_without_bounds(const Triangles& triangles, const Points& vertices) {
    // The distance to one point of B is an upper bound on the distance to B. It is a convex function, so over a
    // triangle of A it is largest at a vertex.
    const Vec3 point = target_.triangle(0).a;
    const auto squared = [&](Index v) { return squared_length(Vec3(vertices.row(v)) - point); };
    double most = 0;
    for (Index v = 0; v < vertices.rows(); ++v) most = std::max(most, squared(v));
    settled_ =
        WATCHED_ELSE("search: the bound when there is no time is widened", rounding_.at_most(most, 0), std::sqrt(most));
    for (Index i = 0; WATCHED("fields: each triangle has a bound without time", elements_) && i < triangles.rows();
         ++i) {
        const auto v = triangles.row(i);
        elements_->settle(
            WATCHED_ELSE(
                "fields: the bounds without time are widened",
                rounding_.at_most(std::max({squared(v[0]), squared(v[1]),
                                            WATCHED("fields: each corner counts without time", squared(v[2]))}),
                                  0),
                std::sqrt(std::max({squared(v[0]), squared(v[1]), squared(v[2])}))),
            i);
    }
    return result(Status::time_limit, 0);
}

Fields SearchBounds::fields() const {
    std::vector<double> lower;
    lower.reserve(elements_->farthest.size());
    Counters uncounted;
    for (const Farthest& farthest : elements_->farthest) {
        lower.push_back(WATCHED_ELSE("fields: the lower bound of a triangle is certified",
                                     lower_of(farthest, uncounted), std::sqrt(std::max(farthest.point.squared, 0.0))));
    }
    return {{"lower", Field::Of::elements, Field::Meaning::lower, std::move(lower)},
            {"upper", Field::Of::elements, Field::Meaning::upper, elements_->upper},
            {"level", Field::Of::elements, Field::Meaning::number, elements_->deepest}};
}

}  // namespace hausbench
