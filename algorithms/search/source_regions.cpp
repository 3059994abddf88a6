#include "algorithms/search/source_regions.h"

#include "algorithms/kernel/watched.h"
#include "algorithms/search/queue.h"

#include <cmath>

namespace hausbench {

double SourceRegions::upper_of(const Box& box, const Vec3& q) {
    ++counters_.bound_tests;
    return WATCHED_ELSE("regions: a bound without rounding",
                        bounds_.at_most(WATCHED_ELSE("regions: the nearest corner of the box instead of the farthest",
                                                     squared_distance_at_most(q, box), squared_distance_to_box(q, box)),
                                        0),
                        std::sqrt(squared_distance_at_most(q, box)));
}

// Lowers the upper bound of the region to the distance from its point q of B to the farthest corner of its box, if that
// is smaller.
void SourceRegions::lower(Region& region) {
    const double upper = upper_of(region.box, region.q);
    if (!(upper < region.upper)) return;
    region.upper = upper;
    region.shown = WATCHED("proofs: the triangle that the bound of a region is a distance to", region.near);
}

// Finds the point q of B closest to the centre of the region's box, and lowers the region's upper bound with it.
// Returns false without searching if this was done before, or if half the diagonal of the box is too large to skip the
// region: no q gives a smaller bound.
bool SourceRegions::improve(Region& region) {
    if (region.centred || 0.5 * std::sqrt(squared_length(region.box.high - region.box.low)) > bounds_.purged_at_most(0))
        return false;
    const ClosestPoint nearest = target_.closest(0.5 * (region.box.low + region.box.high), region.near, counters_);
    region.centred = true;
    region.q = WATCHED_ELSE("regions: a part takes the point of the whole for its own bound", nearest.point,
                            Vec3(0.5 * (region.box.low + region.box.high)));
    region.near = nearest.triangle;
    lower(region);
    return true;
}

void SourceRegions::for_each_triangle(std::int32_t child, const std::function<void(Index)>& call) const {
    if (child < 0) {
        for (const Index i : tree_.leaf(static_cast<std::size_t>(~child))) call(i);
        return;
    }
    const WideNode& node = tree_.nodes[static_cast<std::size_t>(child)];
    for (int k = 0; k < node.count; ++k) for_each_triangle(node.child[k], call);
}

bool SourceRegions::walk(const std::function<void(Index, Index)>& look,
                         const std::function<void(Index, double, Index)>& settle) {
    PieceQueue<Region> queue;
    queue.push({std::numeric_limits<double>::infinity(), all_, Vec3::Zero(), -1, -1, 0, false});
    for (std::size_t steps = 0; !queue.empty(); ++steps) {
        if (steps % 32 == 0 && bounds_.out_of_time()) return false;
        Region region = queue.pop();
        if (region.upper <= WATCHED_ELSE("regions: settled whatever the bound is", bounds_.purged_at_most(0),
                                         2 * bounds_.purged_at_most(0))) {
            for_each_triangle(region.child, [&](Index i) { settle(i, region.upper, region.shown); });
        } else if (improve(region)) {
            queue.push(region);
        } else if (region.child < 0) {
            for_each_triangle(region.child, [&](Index i) { look(i, region.near); });
        } else {
            const WideNode& node = tree_.nodes[static_cast<std::size_t>(region.child)];
            for (int k = 0; k < node.count; ++k) {
                Region part = region;
                part.child = node.child[k];
                part.centred = false;
                part.box = WATCHED_ELSE("regions: boxes of A where it was before it moved",
                                        posed_box(node.boxes.box(k), pose_, all_), node.boxes.box(k));
                if (region.near >= 0) lower(part);
                queue.push(part);
            }
        }
    }
    return true;
}

}  // namespace hausbench
