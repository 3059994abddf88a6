#include "algorithms/structures/bvh.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/structures/point_bvh.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include "algorithms/kernel/point_triangle-inl.h"
#include "algorithms/structures/wide_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {

HWY_INLINE void offer_block(const V3& p, const PointBlock& block, NearestPoint& best, Counters& counters) {
    const Doubles d;
    counters.point_distances += static_cast<std::uint64_t>(block.count);
    alignas(64) double squared[block_width];
    unsigned mask = 0;
    for (std::size_t lane = 0; lane < block_width; lane += hn::Lanes(d)) {
        const V3 r = p - load(block.coordinate, lane);
        const V squares = dot(r, r);
        hn::Store(squares, d, squared + lane);
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::Le(squares, hn::Set(d, best.squared_distance)), bits);
        mask |= static_cast<unsigned>(bits[0]) << lane;
    }
    for (; mask != 0; mask &= mask - 1) {
        const int i = std::countr_zero(mask);
        if (squared[i] > best.squared_distance) continue;
        if (squared[i] == best.squared_distance && best.point >= 0 && best.point <= block.point[i]) continue;
        best = {squared[i], block.point[i]};
    }
}

void tree_nearest(const WideTree& tree, const PointBlock* blocks, const Vec3& point, double early_out_squared,
                  NearestPoint& best, Counters& counters) {
    const V3 p = set(point);
    Walk walk(tree, blocks, point, counters.node_visits);
    const std::size_t first = walk.greedy_descent();
    offer_block(p, blocks[first], best, counters);
    if (best.point >= 0 && best.squared_distance <= early_out_squared) return;
    walk.visit_leaves(best.squared_distance, [&](std::size_t leaf, double& squared) HWY_ATTR {
        if (leaf == first) return true;
        offer_block(p, blocks[leaf], best, counters);
        squared = best.squared_distance;
        return best.point < 0 || best.squared_distance > early_out_squared;
    });
}

}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench {

HWY_EXPORT(tree_nearest);

PointBvh::PointBvh(const Points& points) : tree_(build_bvh({points})) { refit(points); }

void PointBvh::refit(const Points& points) {
    blocks_ = std::make_unique_for_overwrite<PointBlock[]>(tree_.leaves());  // every byte of use is written below
    std::vector<Box> boxes(tree_.leaves());
    for (std::size_t i = 0; i < tree_.leaves(); ++i) {
        blocks_[i].set(points, tree_.leaf(i));
        for (const Index point : tree_.leaf(i)) boxes[i].add(Vec3(points.row(point)));
    }
    tree_.fit(boxes);
}

NearestPoint PointBvh::nearest(const Vec3& p, double squared_radius, double early_out_squared,
                               Counters& counters) const {
    ++counters.closest_point_queries;
    NearestPoint best;
    best.squared_distance = squared_radius;
    HWY_DYNAMIC_DISPATCH(tree_nearest)(tree_, blocks_.get(), p, early_out_squared, best, counters);
    return best;
}

std::size_t PointBvh::bytes() const { return tree_.bytes() + tree_.leaves() * sizeof(PointBlock); }

}  // namespace hausbench
#endif
