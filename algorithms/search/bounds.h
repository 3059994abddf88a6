// What a branch-and-bound search over pieces of A knows of h(A, B): the farthest point so far, the interval, and when to end.
//
// Lower bound: the largest distance of a point of A met so far. It is certified by support planes (kernel/point_triangle.h),
// which costs a query, so only when the search seems to be over. Until then pieces are purged by the uncertified one, which
// does no harm: the upper bounds of what is purged are kept.
// Upper bound: the largest of those kept ("settled") and of those in the queue, which belongs to the caller.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/search/elements.h"
#include "algorithms/search/target.h"
#include "algorithms/solver.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hausbench {

class SearchBounds {
public:
    // References are kept. `rounding.magnitude`: of A posed and B. `elements`: to keep the bounds of each triangle of A too, or null.
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

    // A point of A was measured: a vertex of a piece of `level` subdivisions of triangle `source`, or of A (level 0).
    void offer(const MeasuredPoint& point, Index source, int level) {
        if (elements_) elements_->offer(point, source, level);
        if (!(point.squared > farthest_.point.squared)) return;
        farthest_ = {point, source, level};
        certified_ = -1;
    }

    // Finds its distance, and offers it. `warm`: a triangle of B to look at first, or -1.
    MeasuredPoint measure(const Vec3& point, Index warm, Index source, int level) {
        const ClosestPoint nearest = target_.closest(point, warm, counters_);
        const MeasuredPoint measured{point, nearest.squared_distance, nearest.triangle};
        offer(measured, source, level);
        return measured;
    }

    const Farthest& farthest() const { return farthest_; }
    ElementBounds* elements() const { return elements_; }

    // The upper bound of a piece whose points are at most sqrt(squared) from B, as computed, after `level` subdivisions.
    double at_most(double squared, int level) const { return rounding_.at_most(squared, level); }

    // An upper bound that ends the search, if all have it and the lower bound is what it seems to be.
    double sought() const {
        const double low = std::sqrt(farthest_squared());
        return low + 0.5 * query_.tolerance.gap(low);
    }

    // The largest upper bound that a piece of this level may have and be purged.
    double purged_at_most(int level) const {
        return std::max(rounding_.at_most(farthest_squared(), level), query_.floor);
    }

    // Whether a piece of triangle `source` with this upper bound needs no further work; its bound is then kept. A bound that
    // comes from points no farther than the farthest one is purged here, exactly; so is one below the floor, which is of no
    // interest, and what is at `most_levels` (subdivision.h).
    bool settle(double upper, Index source, int level, int most_levels) {
        if (upper > purged_at_most(level) && level < most_levels) return false;
        settled_ = std::max(settled_, upper);
        if (elements_) elements_->settle(upper, source);
        return true;
    }

    // What somebody else settled has no larger upper bound; its elements are told already.
    void keep(double upper) { settled_ = upper > settled_ ? upper : settled_; }

    // Whether the bounds, or the lack of anything left to split, end the search; `queued` as below.
    std::optional<Status> answered(double queued);

    // Whether the search is over, and how; asked before a piece is taken from the queue, which is not empty if the answer is
    // no. `queued` is the largest upper bound in the queue, 0 where it is empty; `spent` is what the budget is compared with.
    std::optional<Status> end(double queued, std::uint64_t spent);

    // The largest upper bound of what was settled so far.
    double settled() const { return settled_; }

    // Of the farthest point; costs a query each time that there is a new one.
    double certified_lower();

    Result result(Status status, double queued);

    // Where time is out before every triangle of A has an upper bound. `vertices` are those of A, posed. O(n).
    Result result_without_bounds(const Triangles& triangles, const Points& vertices);

    // Of `elements`, to which the caller has given what is left in its queue: "lower", "upper" and "level" of each triangle of A.
    // The lower bound is 0 where no point of the triangle was measured. Costs a certified distance a triangle, whatever the time
    // limit, which no counter tells.
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
    double settled_ = 0;     // the largest upper bound of what was purged
    double loss_ = 0;        // what certifying the farthest point has cost so far
};

}  // namespace hausbench
