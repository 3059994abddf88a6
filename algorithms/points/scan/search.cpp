#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/points/scan/search.cpp"
#include <hwy/foreach_target.h>

#include "algorithms/points/scan/search.h"

#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace hausbench::scan::HWY_NAMESPACE {

namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 8>;  // 8 divides 16, the number of points in a leaf

// Returns x^2 + y^2 + z^2, with the operations of squared_distance() in the same order.
HWY_INLINE hn::Vec<Doubles> squares(hn::Vec<Doubles> x, hn::Vec<Doubles> y, hn::Vec<Doubles> z) {
    return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
}

struct Nearest {
    double squared = infinity;
    std::size_t leaf = 0;
    Index row = -1;
};

// Compares the point p of A with the points of a leaf of B, and updates `nearest`.
HWY_INLINE void scan_leaf(const PointBlocks& b, std::size_t leaf, const double (&p)[3], Nearest& nearest) {
    const Doubles d;
    const PointLeaf& points = b.leaves[leaf];
    HWY_ALIGN double distances[block_points];
    auto least = hn::Set(d, infinity);
    for (std::size_t i = 0; i < block_points; i += hn::Lanes(d)) {
        const auto s = squares(hn::Sub(hn::Set(d, p[0]), hn::Load(d, points.x + i)),
                               hn::Sub(hn::Set(d, p[1]), hn::Load(d, points.y + i)),
                               hn::Sub(hn::Set(d, p[2]), hn::Load(d, points.z + i)));
        hn::Store(s, d, distances + i);
        least = hn::Min(least, s);
    }
    const double squared = hn::GetLane(hn::MinOfLanes(d, least));
    if (!(squared < nearest.squared)) return;
    std::size_t i = 0;
    while (distances[i] != squared) ++i;
    nearest = {squared, leaf, points.row[i]};
}

// A node or a leaf of the tree that is still to be searched.
struct OpenBlock {
    double squared;            // squared distance from the point of A to its box
    std::size_t level, index;  // level 0: leaves
};

// Pushes those children of a node onto the stack whose boxes are nearer than `squared`, the nearest one last, so that
// it is popped first. Returns the new size of the stack.
HWY_INLINE std::size_t push_children(const PointBlocks& b, const OpenBlock& at, const double (&p)[3], double squared,
                                     OpenBlock* stack, std::size_t size) {
    const Doubles d;
    const BlockNode& node = b.nodes[b.level_begin[at.level - 1] + at.index];
    HWY_ALIGN double distances[block_children];
    unsigned mask = 0;
    for (std::size_t i = 0; i < block_children; i += hn::Lanes(d)) {
        const auto out = [&](std::size_t k) HWY_ATTR {
            const auto q = hn::Set(d, p[k]);
            return hn::Max(hn::Max(hn::Sub(hn::Load(d, node.low[k] + i), q), hn::Sub(q, hn::Load(d, node.high[k] + i))),
                           hn::Zero(d));
        };
        const auto s = squares(out(0), out(1), out(2));
        hn::Store(s, d, distances + i);
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::Lt(s, hn::Set(d, squared)), bits);
        mask |= static_cast<unsigned>(bits[0]) << i;
    }
    const std::size_t base = size;
    for (; mask != 0; mask &= mask - 1) {
        const auto c = static_cast<std::size_t>(std::countr_zero(mask));
        std::size_t place = size++;
        for (; place > base && stack[place - 1].squared <= distances[c]; --place) stack[place] = stack[place - 1];
        stack[place] = {distances[c], at.level - 1, at.index * block_children + c};
    }
    return size;
}

// Finds the nearest point of B to the point p of A. Stops early at a point within the *early-out radius*, the largest
// distance so far, because p then cannot raise it. `nearest` is the nearest point known before. Skips leaf `scanned`,
// which was searched before. Distances to boxes are rounded like distances to points (kernel/box.h), so a box that is
// at least as far as the nearest point contains no nearer point.
HWY_INLINE void search_tree(const PointBlocks& b, const double (&p)[3], double squared_early_out, std::size_t scanned,
                            Nearest& nearest, Counters& counters) {
    // Each level pops one node and pushes up to 8. There are at most 12 levels, because the number of points is an
    // Index, which is less than 8^12.
    OpenBlock stack[(block_children - 1) * 12 + 1];
    std::size_t size = 0;
    OpenBlock at{0, b.levels(), 0};
    while (true) {
        if (at.level > 0) {
            ++counters.node_visits;
            size = push_children(b, at, p, nearest.squared, stack, size);
        } else if (at.index != scanned) {
            scan_leaf(b, at.index, p, nearest);
            counters.point_distances += block_points;
            if (nearest.squared <= squared_early_out) return;
        }
        do {
            if (size == 0) return;
            at = stack[--size];
        } while (!(at.squared < nearest.squared));
    }
}

// Searches for the nearest point of B to point i of a leaf of A, and updates the state. Looks first in the leaf of B in
// which the last point was found, then in leaf `home` (see home_of()), then in the tree. Stops at a point within the
// largest distance so far.
void search_point(const PointBlocks& b, const PointLeaf& leaf, std::size_t i, std::size_t home, ScanState& state) {
    const double p[3] = {leaf.x[i], leaf.y[i], leaf.z[i]};
    const double squared_early_out = state.farthest.squared;
    Nearest nearest;
    scan_leaf(b, state.last_leaf, p, nearest);
    state.counters.point_distances += block_points;
    if (nearest.squared <= squared_early_out) return;
    if (home != state.last_leaf) {
        scan_leaf(b, home, p, nearest);
        state.counters.point_distances += block_points;
    }
    if (!(nearest.squared <= squared_early_out)) {
        ++state.counters.closest_point_queries;
        search_tree(b, p, squared_early_out, home, nearest, state.counters);
    }
    state.last_leaf = nearest.leaf;
    if (nearest.squared > squared_early_out) state.farthest = {nearest.squared, leaf.row[i], nearest.row};
}

// Returns the *home* of a leaf of A: the leaf of B at the same position in Morton order, which is probably near it.
std::size_t home_of(const PointBlocks& b, const PointLeaf& leaf) {
    const double first[3] = {leaf.x[0], leaf.y[0], leaf.z[0]};
    return b.leaf_at(first);
}

void search_samples(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state) {
    for (std::size_t l = 0; l < a.size(); l += 4) search_point(b, a[l], 0, home_of(b, a[l]), state);
}

// The bounding box of a leaf. Each coordinate is repeated in all lanes of a vector.
struct LeafBox {
    hn::Vec<Doubles> low[3], high[3];
};

HWY_INLINE LeafBox box_of(const PointLeaf& leaf) {
    const Doubles d;
    LeafBox box;
    const double* const axes[] = {leaf.x, leaf.y, leaf.z};
    for (std::size_t k = 0; k < 3; ++k) {
        auto low = hn::Load(d, axes[k]), high = low;
        for (std::size_t i = hn::Lanes(d); i < block_points; i += hn::Lanes(d)) {
            low = hn::Min(low, hn::Load(d, axes[k] + i));
            high = hn::Max(high, hn::Load(d, axes[k] + i));
        }
        box.low[k] = hn::MinOfLanes(d, low);
        box.high[k] = hn::MaxOfLanes(d, high);
    }
    return box;
}

// Returns whether one point of a leaf of B is within the early-out radius (see search_tree()) of every point in `box`,
// the box of a leaf of A. If so, no point of that leaf can raise the largest distance. Testing the corner of `box` that
// is farthest from the point of B is enough, because every operation of squared_distance() is monotone in |a - b|.
HWY_INLINE bool covers(const PointLeaf& points, const LeafBox& box, double squared_early_out) {
    const Doubles d;
    auto least = hn::Set(d, infinity);
    for (std::size_t i = 0; i < block_points; i += hn::Lanes(d)) {
        const auto far = [&](std::size_t k, const double* axis) HWY_ATTR {
            const auto q = hn::Load(d, axis + i);
            return hn::Max(hn::Abs(hn::Sub(box.low[k], q)), hn::Abs(hn::Sub(box.high[k], q)));
        };
        least = hn::Min(least, squares(far(0, points.x), far(1, points.y), far(2, points.z)));
    }
    return hn::GetLane(hn::MinOfLanes(d, least)) <= squared_early_out;
}

void search_leaves(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state) {
    for (const PointLeaf& leaf : a) {
        const std::size_t home = home_of(b, leaf);
        const LeafBox box = box_of(leaf);
        ++state.counters.bound_tests;
        if (covers(b.leaves[home], box, state.farthest.squared)) continue;
        if (home != state.last_leaf) {
            ++state.counters.bound_tests;
            if (covers(b.leaves[state.last_leaf], box, state.farthest.squared)) continue;
        }
        for (std::size_t i = 0; i < block_points; ++i) {
            if (i > 0 && leaf.row[i] == leaf.row[i - 1]) break;  // the repeated point that fills up the last leaf
            search_point(b, leaf, i, home, state);
        }
    }
}

std::int64_t scan_target() { return HWY_TARGET; }

}  // namespace
}  // namespace hausbench::scan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench::scan {

HWY_EXPORT(search_samples);
HWY_EXPORT(search_leaves);
HWY_EXPORT(scan_target);

void search_samples(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state) {
    HWY_DYNAMIC_DISPATCH(search_samples)(b, a, state);
}

void search_leaves(const PointBlocks& b, std::span<const PointLeaf> a, ScanState& state) {
    HWY_DYNAMIC_DISPATCH(search_leaves)(b, a, state);
}

std::int64_t scan_target() { return HWY_DYNAMIC_DISPATCH(scan_target)(); }

}  // namespace hausbench::scan
#endif
