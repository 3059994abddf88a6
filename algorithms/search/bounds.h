// Keeps the lower and the upper bound of h(A, B) during a branch-and-bound search over pieces of A, and tells the
// search when to stop.
//
// A *piece* is a triangle of A or a part cut from one. To *settle* (or purge) a piece is to drop it without cutting it
// further, because its upper bound is small enough. The largest upper bound of all settled pieces is kept.
//
// Lower bound: the largest distance to B among the points of A measured so far. Rounding may make the computed distance
// too large, so support planes prove a lower bound on it (kernel/point_triangle.h). The proof costs a query, so it
// waits until the search seems to be over. Until then, pieces are settled by comparison with the unproven distance,
// which is safe because their upper bounds are kept.
// Upper bound: the larger of the kept bound and the largest bound in the queue of unfinished pieces. The queue belongs
// to the caller, which passes its largest bound as `queued`.
#pragma once

#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/search/element_bounds.h"
#include "algorithms/search/target.h"
#include "algorithms/solver.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hausbench {

// The lower and the upper bound of one search. Receives the computed distances and the bounds of pieces, and tells
// which pieces need no further cuts and when to stop.
class SearchBounds {
public:
    // Keeps references to all arguments except `rounding`, whose `magnitude` must be the largest |coordinate| of B and
    // of A, moved by its pose. If `elements` is not null, it also receives the bounds of each triangle of A.
    SearchBounds(const Query& query, const Target& target, const SurfaceRounding& rounding, Counters& counters,
                 Trace& trace, ElementBounds* elements = nullptr)
        : query_(query),
          target_(target),
          rounding_(rounding),
          counters_(counters),
          trace_(trace),
          elements_(elements),
          deadline_(query.deadline()) {}

    bool out_of_time() const { return deadline_.passed(); }

    // Keeps a point of triangle `source` of A, with its computed distance to B, if it is the farthest so far. `level`
    // tells how far rounding may have moved the point off A: 0 for a vertex of A, k for a corner of a piece after k
    // subdivisions (kernel/rounding.h).
    void offer(const MeasuredPoint& point, Index source, int level) {
        if (elements_ && WATCHED_ELSE("fields: a point that is not the farthest of all counts for its triangle", true,
                                      point.squared > farthest_.point.squared))
            elements_->offer(point, source, level);
        if (!(point.squared > farthest_.point.squared)) return;
        farthest_ = {point, source, level};
        if (WATCHED("search: a farther point is certified anew", true)) certified_ = -1;
    }

    // Computes the distance from a point of A to B, passes it to offer(), and returns it. `warm` is a triangle of B to
    // test first, or -1 for none.
    MeasuredPoint measure(const Vec3& point, Index warm, Index source, int level) {
        const ClosestPoint nearest = target_.closest(point, warm, counters_);
        const MeasuredPoint measured{point, nearest.squared_distance, nearest.triangle};
        offer(measured, source, level);
        return measured;
    }

    const Farthest& farthest() const { return farthest_; }
    ElementBounds* elements() const { return elements_; }

    // Returns an upper bound on the exact distances from a piece to B, given an upper bound on the computed squared
    // distances. It is the square root plus the largest possible rounding error after `level` subdivisions.
    double at_most(double squared, int level) const { return rounding_.at_most(squared, level); }

    // Returns an upper bound that is low enough to end the search once no piece exceeds it. Uses only half of the
    // tolerance, because the proven lower bound may turn out a little lower than the computed one.
    double sought() const {
        const double low = std::sqrt(farthest_squared());
        return low + 0.5 * query_.tolerance.gap(low);
    }

    // Returns the largest upper bound with which a piece of this level can be dropped: the largest distance found so
    // far plus the rounding error of this level. If the floor of the query is larger, returns the floor, because
    // distances below it do not matter.
    double purged_at_most(int level) const {
        return std::max(rounding_.at_most(farthest_squared(),
                                          WATCHED("search: what settles a piece is widened by its level", level)),
                        WATCHED("search: what is below the floor is settled", query_.floor));
    }

    // Returns true and keeps the upper bound if a piece of triangle `source` needs no further cuts: the bound is at
    // most purged_at_most(level), or `level` has reached `most_levels`, at which pieces are too small to cut. Otherwise
    // returns false.
    bool settle(double upper, Index source, int level, int most_levels) {
        if (upper > purged_at_most(level) && level < most_levels) return false;
        settled_ =
            std::max(settled_, WATCHED_ELSE("search: what is settled keeps its bound",
                                            WATCHED("search: what is settled keeps its bound, in guthe", upper), 0.0));
        if (WATCHED("fields: what is settled counts for its triangle", elements_)) elements_->settle(upper, source);
        return true;
    }

    // Keeps the largest upper bound of pieces that the caller dropped without calling settle(). The bounds must already
    // be in `elements`, if that is set.
    void keep(double upper) { settled_ = upper > settled_ ? upper : settled_; }

    // Returns a status if the search is over: the bounds answer the query, or cutting the pieces in the queue cannot
    // lower the upper bound. Otherwise returns nothing. `queued` is the largest upper bound in the queue, or 0 if the
    // queue is empty.
    std::optional<Status> answered(double queued);

    // Like answered(), but also ends the search when the budget or the time is spent. `spent` is the work done so far,
    // in the unit of the budget. Call this before taking a piece from the queue: if it returns nothing, the queue is
    // not empty.
    std::optional<Status> end(double queued, std::uint64_t spent);

    // Shows the bounds to the watcher of the trace, if that is due; changes no counter. `upper` is an upper bound on the
    // distance. answered() and end() do so, too.
    void show(double upper);

    // Returns the largest upper bound of the pieces dropped so far.
    double settled() const { return settled_; }

    // Returns a proven lower bound on the distance from the farthest point found so far to B. Costs a query whenever
    // that point is new.
    double certified_lower();

    // Returns the result of a search that ended with this status: its bounds and, as the witness, the farthest point
    // with its closest point on B. The status changes if the bounds answer the query. `queued` is the largest upper
    // bound left in the queue.
    Result result(Status status, double queued);

    // Returns the result of a search that ran out of time before every triangle of A had an upper bound. Uses the
    // largest distance from A to a single point of B. `vertices` are the vertices of A, moved by its pose. O(n).
    Result result_without_bounds(const Triangles& triangles, const Points& vertices);

    // Returns the fields "lower", "upper" and "level", with one value per triangle of A. Before, pass the bounds of the
    // pieces left in the queue to elements()->settle(). The lower bound of a triangle without measured points is 0.
    // Takes one query per triangle, whatever the time limit; no counter includes it.
    Fields fields() const;

private:
    double farthest_squared() const {
        return WATCHED_ELSE("search: nothing is settled before a point was measured",
                            std::max(farthest_.point.squared, 0.0), farthest_.point.squared);
    }
    double lower_of(const Farthest& farthest, Counters& counters) const;

    const Query& query_;
    const Target& target_;
    SurfaceRounding rounding_;
    Counters& counters_;
    Trace& trace_;
    ElementBounds* elements_;
    Deadline deadline_;
    Farthest farthest_;
    double certified_ = -1;  // certified distance of farthest_; negative: not computed yet
    double settled_ = 0;
    double loss_ = 0;  // by how much certification is expected to lower the lower bound
};

}  // namespace hausbench
