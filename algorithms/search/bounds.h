// The bounds of h(A, B) in a branch-and-bound search over pieces of A: the farthest point so far, the lower and the
// upper bound, and when to stop.
//
// A *piece* is a triangle of A or a part cut from one. To *settle* (or purge) a piece is to take it out of the search
// without cutting it further, because its upper bound is small enough; this bound is kept.
//
// Lower bound: the largest distance to B among the points of A that were measured so far. The computed distance may be
// too large by rounding, so support planes certify a lower bound on it (kernel/point_triangle.h). This costs a query,
// so it is done only when the search seems to be over. Until then, pieces are settled by comparing them with the
// uncertified distance. This is safe, because the upper bounds of settled pieces are kept.
// Upper bound: the largest of the kept bounds of settled pieces and of the bounds in the queue. The queue belongs to
// the caller, which passes its largest bound as `queued`.
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

// The bounds of one search. The search offers points of A to it and asks it which pieces are settled and when to stop.
class SearchBounds {
public:
    // Keeps references to all arguments but `rounding`, whose `magnitude` must be the largest |coordinate| of A, moved
    // by its pose, and of B. If `elements` is not null, it also receives the bounds of each triangle of A.
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

    // Takes a point of triangle `source` of A whose distance to B was computed, and keeps it if it is the farthest so
    // far. `level` says how far rounding may have moved it off A (kernel/rounding.h): 0 for a vertex of A, k for a
    // vertex of a piece after k subdivisions.
    void offer(const MeasuredPoint& point, Index source, int level) {
        if (elements_) elements_->offer(point, source, level);
        if (!(point.squared > farthest_.point.squared)) return;
        farthest_ = {point, source, level};
        certified_ = -1;
    }

    // Computes the distance from a point of A to B and offers the point. `warm` is a triangle of B
    // to test first, or -1.
    MeasuredPoint measure(const Vec3& point, Index warm, Index source, int level) {
        const ClosestPoint nearest = target_.closest(point, warm, counters_);
        const MeasuredPoint measured{point, nearest.squared_distance, nearest.triangle};
        offer(measured, source, level);
        return measured;
    }

    const Farthest& farthest() const { return farthest_; }
    ElementBounds* elements() const { return elements_; }

    // Returns the upper bound of a piece after `level` subdivisions, given a computed bound on the squared distances of
    // its points to B: takes the square root and adds what rounding may have lost.
    double at_most(double squared, int level) const { return rounding_.at_most(squared, level); }

    // Returns an upper bound that is small enough: the search ends once every piece has it, provided that the
    // lower bound can be certified. Uses only half of the tolerance, because certification may lower the
    // lower bound a little.
    double sought() const {
        const double low = std::sqrt(farthest_squared());
        return low + 0.5 * query_.tolerance.gap(low);
    }

    // Returns the largest upper bound with which a piece of this level may be settled. This is the largest
    // distance so far, widened like the bound of the piece, or the floor of the query if that is larger: distances
    // below it do not matter.
    double purged_at_most(int level) const {
        return std::max(rounding_.at_most(farthest_squared(), level), query_.floor);
    }

    // Settles a piece of triangle `source` with this upper bound and returns true, or returns false if the piece must
    // be cut further. A piece is settled if its bound is at most purged_at_most(level), or if it was cut `most_levels`
    // times and is too small to be cut again (subdivision.h).
    bool settle(double upper, Index source, int level, int most_levels) {
        if (upper > purged_at_most(level) && level < most_levels) return false;
        settled_ = std::max(settled_, upper);
        if (elements_) elements_->settle(upper, source);
        return true;
    }

    // Takes the largest upper bound of pieces that the caller settled itself, and whose bounds `elements`
    // (if any) already has.
    void keep(double upper) { settled_ = upper > settled_ ? upper : settled_; }

    // Returns a status if the search is over because the bounds answer the query, or because no cut of a piece in the
    // queue can lower the upper bound any more. `queued` as in end().
    std::optional<Status> answered(double queued);

    // Returns a status if the search is over: for a reason of answered(), or because the budget or the time is spent.
    // Call it before taking a piece from the queue; if it returns nothing, the queue is not empty. `queued` is the
    // largest upper bound in the queue, 0 if it is empty; `spent` is compared with the budget.
    std::optional<Status> end(double queued, std::uint64_t spent);

    // Returns the largest upper bound of settled pieces.
    double settled() const { return settled_; }

    // Returns the certified lower bound, a proven lower bound on the distance from the farthest point to B. Costs a
    // query whenever the farthest point is new.
    double certified_lower();

    // Returns the result of a search that ended with this status; `queued` as in end(). The witness is the farthest
    // point with its closest point on B. If the bounds answer the query, their status replaces `status`.
    Result result(Status status, double queued);

    // Returns the result of a search that ran out of time before every triangle of A had an upper bound. Bounds them
    // all by their distance to a single point of B. `vertices` are the vertices of A, moved by its pose. O(n).
    Result result_without_bounds(const Triangles& triangles, const Points& vertices);

    // Returns the fields "lower", "upper" and "level", with one value for each triangle of A, from `elements`. The
    // caller must first have given `elements` the bounds of the pieces that are left in its queue. The lower bound of a
    // triangle is 0 if none of its points was measured. Costs one certified distance per triangle, whatever the time
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
    double certified_ = -1;  // certified distance of farthest_; negative: not computed yet
    double settled_ = 0;     // the largest upper bound of settled pieces
    double loss_ = 0;        // how much certification may lower the lower bound, judging by earlier attempts
};

}  // namespace hausbench
