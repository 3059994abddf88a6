// The limits for a piece are lowered in rounds until the sums of all gaps are small enough. The sum of the gaps turns out
// to be about proportional to the limit, so the next limit is the last one times (allowed gap) / (gap).
#include "algorithms/meshes/distribution/distribution.h"

#include "algorithms/kernel/rounding.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hausbench {
namespace {

using Kind = Statistic::Kind;

// One statistic and the limit for its pieces.
struct Goal {
    Statistic statistic;
    Bounds bounds = {};
    double limit = CutWhere::never;
};

double allowed(const Goal& goal, const DistributionQuery& query) {
    return goal.statistic.kind == Kind::share_within ? query.share_tolerance : query.tolerance.gap(goal.bounds.lower);
}

// The sum of weight times gap that a goal allows, if its bounds are in proportion to it.
double allowed_sum(const Goal& goal, const Statistics& now, const DistributionQuery& query) {
    const double gap = allowed(goal, query);
    switch (goal.statistic.kind) {
        case Kind::rms:
        case Kind::deviation:
            return now.weight() * gap * (2 * goal.bounds.lower + gap);  // of squares
        case Kind::quantile:
            return now.open(goal.statistic, goal.bounds) * std::min(1.0, gap / goal.bounds.gap());
        default:
            return now.weight() * gap;
    }
}

// Adds the limit of a goal to the places to cut.
void add(const Goal& goal, const Statistics& now, const DistributionQuery& query, CutWhere& where) {
    switch (goal.statistic.kind) {
        case Kind::mean:
            where.mean = std::min(where.mean, goal.limit);
            break;
        case Kind::rms:
            where.square = std::min(where.square, goal.limit);
            break;
        case Kind::deviation:
            where.spread = goal.limit;
            where.about = now.about();
            break;
        case Kind::maximum:
            where.maximum = goal.bounds.lower + allowed(goal, query);
            where.maximum_gap = 0.125 * goal.bounds.gap();
            break;
        case Kind::quantile:
            where.bands.push_back({goal.bounds.lower, goal.bounds.upper, goal.limit});
            break;
        case Kind::share_within:
            where.bands.push_back({goal.statistic.argument, goal.statistic.argument, goal.limit});
            break;
    }
}

}  // namespace

DistributionResult distribution_of(const Triangles& triangles, const Points& points, const TriangleBlocks& target,
                                   double magnitude, WeighBy weigh, const DistributionQuery& query) {
    const Deadline deadline(query.time_limit);
    Dissection pieces(triangles, points, target, magnitude, weigh, query.threads);
    std::vector<Goal> goals;
    for (const Statistic& statistic : query.statistics) goals.push_back({statistic});
    CutWhere where;
    DistributionResult result;
    for (bool more = true; more;) {
        more = pieces.refine(where, deadline, query.most_pieces);
        const Statistics now({pieces.leaves()}, pieces.extra_weight());
        where = {};
        bool done = true;
        for (Goal& goal : goals) {
            goal.bounds = now.of(goal.statistic);
            if (goal.bounds.gap() <= allowed(goal, query)) continue;
            done = false;
            const double open = now.open(goal.statistic, goal.bounds), most = allowed_sum(goal, now, query);
            const double leaves = static_cast<double>(pieces.leaves().size());
            if (goal.limit == CutWhere::never)
                goal.limit = 4 * std::max(most, open / 256) / leaves;
            else
                goal.limit *=
                    std::clamp(0.7 * most / open, goal.statistic.kind == Kind::quantile ? 0x1p-4 : 0x1p-10, 0.5);
            add(goal, now, query, where);
        }
        std::optional<Status> status;
        if (done)
            status = Status::converged;
        else if (deadline.passed())
            status = Status::time_limit;
        else if (pieces.leaves().size() > query.most_pieces)
            status = Status::budget;
        if (status || !more) {
            result.status = status.value_or(Status::precision_floor);
            break;
        }
    }
    for (const Goal& goal : goals) result.bounds.push_back(goal.bounds);
    result.pieces = pieces.leaves().size();
    result.counters = pieces.counters();
    return result;
}

}  // namespace hausbench
