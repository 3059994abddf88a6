#include "triangle_tree.h"

#include "rounding.h"
#include "textbook.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernel/triangle_tree.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include "point_triangle-inl.h"
#include "wide_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {

// Offers the triangles of a block that are near enough to matter. Which are looked at is decided by what was known before
// the block, so that counters are the same whatever the width of a vector.
HWY_INLINE void offer_block(const Vec3& point, const TriangleBlock& block, ClosestPoint& best, Counters& counters) {
    const Doubles d;
    const V3 p = set(point);
    const V bound = hn::Set(d, best.squared_distance);
    alignas(64) double squared[block_width], feet[3][block_width];
    for (std::size_t lane = 0; lane < block_width; lane += hn::Lanes(d)) {
        const V3 a = load(block.corner[0], lane), b = load(block.corner[1], lane), c = load(block.corner[2], lane);
        const VBox box = box_of(a, b, c);
        const auto in_use = hn::FirstN(
            d, lane < static_cast<std::size_t>(block.count) ? static_cast<std::size_t>(block.count) - lane : 0);
        const auto near = hn::And(in_use, hn::Le(squared_distance_to_box(p, box), bound));
        if (hn::AllFalse(d, near)) continue;
        counters.point_triangle_distances += hn::CountTrue(d, near);
        const VFoot foot = closest_point(p, a, b, c, box);
        const auto nearer = hn::And(near, hn::Le(foot.squared, bound));
        if (hn::AllFalse(d, nearer)) continue;
        hn::Store(foot.squared, d, squared + lane);
        store(foot.point, feet, lane);
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, nearer, bits);
        for (unsigned mask = bits[0]; mask != 0; mask &= mask - 1) {
            const std::size_t i = lane + static_cast<std::size_t>(std::countr_zero(mask));
            offer(best, {squared[i], {feet[0][i], feet[1][i], feet[2][i]}}, block.triangle[i]);
        }
    }
}

// `first_leaf`: that of the hint, or negative. A hint that turns out farther than the size of a triangle is as good as
// none: searching with such a radius takes longer than finding a better leaf. Where one corner is farther than twice that,
// the leaf is not even looked at.
void tree_closest(const WideTree& tree, const TriangleBlock* blocks, const Vec3& point, double squared_enough,
                  std::int32_t first_leaf, ClosestPoint& best, Counters& counters) {
    const LocalPoint p(tree.frame, point);
    const auto enough = [&] { return best.triangle >= 0 && best.squared_distance <= squared_enough; };
    bool searched = false;
    if (first_leaf >= 0) {
        const TriangleBlock& block = blocks[first_leaf];
        const Triangle triangle = block.at(0);
        const double squared_size = squared_length(triangle.b - triangle.a);
        if (squared_length(point - triangle.a) <= 4 * squared_size) {
            offer_block(point, block, best, counters);
            if (enough()) return;
            searched = best.squared_distance <= squared_size;
        }
    }
    const std::size_t first = searched ? static_cast<std::size_t>(first_leaf) : dive(tree, p, counters.node_visits);
    if (!searched) offer_block(point, blocks[first], best, counters);
    if (enough()) return;
    walk(tree, p, best.squared_distance, counters.node_visits, [&](std::size_t leaf, double& squared) HWY_ATTR {
        if (leaf == first) return true;
        offer_block(point, blocks[leaf], best, counters);
        squared = best.squared_distance;
        return !enough();
    });
}

void tree_textbook(const WideTree& tree, const TriangleBlock* blocks, const Vec3& point, double squared_enough,
                   ClosestPoint& best, Counters& counters) {
    const LocalPoint p(tree.frame, point);
    walk(tree, p, best.squared_distance, counters.node_visits, [&](std::size_t leaf, double& squared) {
        const TriangleBlock& block = blocks[leaf];
        for (int i = 0; i < block.count; ++i) {
            ++counters.point_triangle_distances;
            const TrianglePoint found = textbook_closest_point(point, block.at(i));
            if (found.squared_distance <= best.squared_distance) offer(best, found, block.triangle[i]);
        }
        squared = best.squared_distance;
        return best.triangle < 0 || best.squared_distance > squared_enough;
    });
}

void tree_certify(const WideTree& tree, const TriangleBlock* blocks, const Vec3& point, double nearest, double& least,
                  Counters& counters) {
    const LocalPoint p(tree.frame, point);
    walk(tree, p, nearest, counters.node_visits, [&](std::size_t leaf, double&) {
        const TriangleBlock& block = blocks[leaf];
        for (int i = 0; i < block.count; ++i) certify(point, block.at(i), nearest, least, counters);
        return true;
    });
}

}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench {

HWY_EXPORT(tree_closest);
HWY_EXPORT(tree_textbook);
HWY_EXPORT(tree_certify);

TriangleTree::TriangleTree(const TriangleMesh& mesh, WideTree&& tree) : mesh_(&mesh), tree_(std::move(tree)) {
    fill_blocks();
}

void TriangleTree::fill_blocks() {
    blocks_ = std::make_unique_for_overwrite<TriangleBlock[]>(tree_.leaves());  // every byte of use is written below
    leaf_of_.resize(tree_.order.size());
    for (std::size_t i = 0; i < tree_.leaves(); ++i) {
        blocks_[i].set(*mesh_, tree_.leaf(i));
        for (const Index triangle : tree_.leaf(i))
            leaf_of_[static_cast<std::size_t>(triangle)] = static_cast<std::int32_t>(i);
    }
}

void TriangleTree::refit(const TriangleMesh& mesh) {
    mesh_ = &mesh;
    hausbench::refit(tree_, local_boxes(mesh));
    fill_blocks();
}

ClosestPoint TriangleTree::closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const {
    ++counters.closest_point_queries;
    ClosestPoint best;
    best.squared_distance = hints.squared_radius;
    const std::int32_t first = hints.warm_triangle >= 0 ? leaf_of_[static_cast<std::size_t>(hints.warm_triangle)] : -1;
    HWY_DYNAMIC_DISPATCH(tree_closest)(tree_, blocks_.get(), point, hints.squared_enough, first, best, counters);
    return best;
}

ClosestPoint TriangleTree::textbook_closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const {
    ++counters.closest_point_queries;
    ClosestPoint best;
    best.squared_distance = hints.squared_radius;
    HWY_DYNAMIC_DISPATCH(tree_textbook)(tree_, blocks_.get(), point, hints.squared_enough, best, counters);
    return best;
}

double TriangleTree::certified_distance(const Vec3& point, Counters& counters) const {
    const double nearest = closest(point, {}, counters).squared_distance;
    double least = distance_at_least(nearest, true);
    HWY_DYNAMIC_DISPATCH(tree_certify)(tree_, blocks_.get(), point, nearest, least, counters);
    return least;
}

std::size_t TriangleTree::bytes() const {
    return tree_.bytes() + tree_.leaves() * sizeof(TriangleBlock) + leaf_of_.capacity() * sizeof(std::int32_t);
}

}  // namespace hausbench
#endif
