#include "algorithms/surfaces/enclosure/proven_feet.h"

#include "algorithms/kernel/watched.h"
#include "algorithms/surfaces/enclosure/beside.h"

#include <algorithm>
#include <queue>

namespace hausbench::surface_enclosure {
namespace {

constexpr int most_boxes = 20000;             // limit on the boxes of B that are split for one point
constexpr int most_boxes_without_foot = 200;  // the same, while the search has no foot
constexpr int boxes_without_descent = 3;      // number of boxes that are split before local searches begin
constexpr int boxes_between_looks = 64;       // between two checks of the clock

struct OpenBox {
    double least;  // lower bound on the distance to the piece of B in the box
    std::int32_t node;
    bool operator<(const OpenBox& other) const {
        return least > other.least || (least == other.least && node > other.node);
    }
};

}  // namespace

double ProvenFeet::at_most(const SurfaceTree::Node& piece, std::int32_t foot) {
    ++counters_.box_distances;
    const SurfacePoint& b = (*this)[foot];
    return distance_at_most(piece, b.at) + WATCHED("surface_enclosure: how far a foot may be off", b.error);
}

NearestFoot ProvenFeet::nearest(const Vec3& p, std::span<const std::int32_t> near_feet, const FootSearch& search) {
    Best best;
    for (const std::int32_t foot : near_feet) {
        const double d = apart_at_most(p, (*this)[foot].at) + (*this)[foot].error;
        if (d < best.at_most) best = {d, foot};
    }
    if (best.foot >= 0) descend_from((*this)[best.foot].at, p, best);
    // The distance from p to B can hardly raise the solver's lower bound, so it is not worth the time to prove that no
    // point of B is nearer.
    if (best.at_most <= search.lower + 2 * search.precision) return {best.foot, 0};
    const double least = at_least(p, search, best);
    return {best.foot, least};
}

// Searches from `seed` for the point of B nearest to p, and proves that B has a point there. If this point is nearer
// than `best`, adds it to the feet and makes it the best.
void ProvenFeet::descend_from(const Vec3& seed, const Vec3& p, Best& best) {
    const auto point = tree_.nearby(p, seed, counters_);
    if (!point) return;
    const double d = apart_at_most(p, point->at) + point->error;
    if (d < best.at_most) best = {d, add(*point)};
}

// Returns a lower bound on the distance from p to B, and updates `best` if the search finds nearer points. Splits the
// nearest box of B again and again, until no box can contain a point that is nearer than `best` by more than the
// precision.
double ProvenFeet::at_least(const Vec3& p, const FootSearch& search, Best& best) {
    std::priority_queue<OpenBox> queue;
    queue.push({0, 0});
    // The largest value to return. It is below the distance to the best foot by half of the precision, so that a
    // program that checks the bound needs no more boxes than this search.
    const auto given_away = [&] { return best.at_most - 0.5 * search.precision; };
    for (int opened = 1; !queue.empty(); ++opened) {
        const OpenBox top = queue.top();
        if (top.least >= best.at_most - search.precision) return std::max(std::min(top.least, given_away()), 0.0);
        // Stops if no point of A in the cell of p can be farther from B than the solver's lower bound (see FootSearch),
        // or if the box is too small to be split.
        if (best.at_most + search.cell_size <= search.lower || !tree_.may_split(top.node)) return top.least;
        if (opened > (best.at_most == infinity ? most_boxes_without_foot : most_boxes)) return top.least;
        if (opened % boxes_between_looks == 0 && deadline_.passed()) return top.least;
        queue.pop();
        if (opened > boxes_without_descent) {
            const Vec3 seed = seed_on(tree_[top.node], p);
            if (best.at_most == infinity || (seed - p).norm() < best.at_most - search.precision)
                descend_from(seed, p, best);
        }
        tree_.split(top.node, counters_);
        const std::int32_t first = tree_[top.node].first, count = tree_[top.node].count;
        for (std::int32_t i = first; i < first + count; ++i) {
            ++counters_.box_distances;
            const double least = std::max(top.least, distance_at_least(tree_[i], p));
            if (least < best.at_most) {
                queue.push({least, i});
                ++counters_.node_visits;
            }
        }
    }
    return best.at_most == infinity ? 0 : std::max(given_away(), 0.0);
}

}  // namespace hausbench::surface_enclosure
