// The bounds of h(A, B) in a branch-and-bound search over pieces of A: the farthest point so far, the interval, and when to stop.
//
// Lower bound: the largest distance of a point of A met so far. Support planes certify it (kernel/point_triangle.h), which
// costs a query, so it is done only when the search seems to be over. Until then the uncertified bound purges pieces, which
// is safe, because the upper bounds of purged pieces are kept.
// Upper bound: the largest of the kept ("settled") bounds and of those in the queue, which belongs to the caller.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/search/element_bounds.h"
#include "algorithms/search/target.h"
#include "algorithms/solver.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hausbench {

class SearchBounds {
public:
    // Keeps references. `rounding.magnitude` covers A posed and B. `elements`, if not null, also receives the bounds of each triangle of A.
    SearchBounds(const Query& query, const Target& target, const SurfaceRounding& rounding, Counters& counters,
                 Trace& trace, ElementBounds* elements = nullptr)
        : query_(query),
          target_(target),
          rounding_(rounding),
          counters_(counters),
          trace_(trace),
          elements_(elements),
          deadline_(query.time_limit) {}

    bool out_of_time() const { return deadline_.passed(); }

    // Takes a measured point of A: a vertex of a piece after `level` subdivisions of triangle `source`, or of A (level 0).
    void offer(const MeasuredPoint& point, Index source, int level) {
        if (elements_) elements_->offer(point, source, level);
        if (!(point.squared > farthest_.point.squared)) return;
        farthest_ = {point, source, level};
        certified_ = -1;
    }

    // Measures a point and offers it. `warm`: a triangle of B to try first, or -1.
    MeasuredPoint measure(const Vec3& point, Index warm, Index source, int level) {
        const ClosestPoint nearest = target_.closest(point, warm, counters_);
        const MeasuredPoint measured{point, nearest.squared_distance, nearest.triangle};
        offer(measured, source, level);
        return measured;
    }

    const Farthest& farthest() const { return farthest_; }
    ElementBounds* elements() const { return elements_; }

    // Returns the upper bound of a piece after `level` subdivisions whose points are at most sqrt(squared) from B as computed.
    double at_most(double squared, int level) const { return rounding_.at_most(squared, level); }

    // Returns an upper bound that ends the search once every piece has it, provided that the lower bound can be certified.
    double sought() const {
        const double low = std::sqrt(farthest_squared());
        return low + 0.5 * query_.tolerance.gap(low);
    }

    // Returns the largest upper bound with which a piece of this level may be purged.
    double purged_at_most(int level) const {
        return std::max(rounding_.at_most(farthest_squared(), level), query_.floor);
    }

    // Returns whether a piece of triangle `source` with this upper bound needs no further work; its bound is then kept. Purges
    // pieces bounded by points no farther than the farthest one, pieces below the floor, and pieces at `most_levels`
    // (subdivision.h).
    bool settle(double upper, Index source, int level, int most_levels) {
        if (upper > purged_at_most(level) && level < most_levels) return false;
        settled_ = std::max(settled_, upper);
        if (elements_) elements_->settle(upper, source);
        return true;
    }

    // Takes the largest upper bound of pieces settled elsewhere, whose elements are recorded already.
    void keep(double upper) { settled_ = upper > settled_ ? upper : settled_; }

    // Returns a status if the bounds, or an empty queue, end the search; `queued` as below.
    std::optional<Status> answered(double queued);

    // Returns a status if the search is over. Call it before taking a piece from the queue; if it returns nothing, the queue is
    // not empty. `queued` is the largest upper bound in the queue, 0 if it is empty; `spent` is compared with the budget.
    std::optional<Status> end(double queued, std::uint64_t spent);

    // Returns the largest upper bound of settled pieces.
    double settled() const { return settled_; }

    // Returns the certified distance of the farthest point; costs a query for each new farthest point.
    double certified_lower();

    Result result(Status status, double queued);

    // Returns the result if time ran out before every triangle of A has an upper bound. `vertices` are the vertices of A, posed. O(n).
    Result result_without_bounds(const Triangles& triangles, const Points& vertices);

    // Returns "lower", "upper" and "level" of each triangle of A from `elements`, to which the caller has given the rest of its queue.
    // The lower bound is 0 if no point of the triangle was measured. Costs one certified distance per triangle, whatever the time
    // limit; no counter includes it.
    Fields fields() const;

private:
    double farthest_squared() const { return std::max(farthest_.point.squared, 0.0); }
    double lower_of(const Farthest& farthest, Counters& counters) const;

    const Query& query_;
    const Target& target_;
    SurfaceRounding rounding_;
    Counters& counters_;
    Trace& trace_;
    ElementBounds* elements_;
    Deadline deadline_;
    Farthest farthest_;
    double certified_ = -1;  // lower bound of the distance of farthest_; negative: to be computed
    double settled_ = 0;     // the largest upper bound of purged pieces
    double loss_ = 0;        // loss in certifying the farthest point so far
};

}  // namespace hausbench
