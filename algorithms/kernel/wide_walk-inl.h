// The walk over a WideTree: leaves near a point, nearest first. Compiled once for every target.
#include "wide_tree.h"

#include <hwy/highway.h>

#include <bit>
#include <limits>

#if defined(HAUSBENCH_WIDE_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HAUSBENCH_WIDE_WALK_INL
#undef HAUSBENCH_WIDE_WALK_INL
#else
#define HAUSBENCH_WIDE_WALK_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, tree_width>;

struct LocalPoint {
    float low[3], high[3];

    HWY_INLINE LocalPoint(const LocalFrame& frame, const Vec3& point) {
        for (int k = 0; k < 3; ++k) frame.interval(point, k, low[k], high[k]);
    }
};

// Squared distances to the boxes of some children.
HWY_INLINE hn::Vec<Floats> measure_children(const WideNode& node, std::size_t lane, const LocalPoint& p) {
    const Floats d;
    const auto axis = [&](std::size_t k) HWY_ATTR {
        const auto below = hn::Sub(hn::Load(d, node.low[k] + lane), hn::Set(d, p.high[k]));
        const auto above = hn::Sub(hn::Set(d, p.low[k]), hn::Load(d, node.high[k] + lane));
        const auto out = hn::Max(hn::Max(below, above), hn::Zero(d));
        return hn::Mul(out, out);
    };
    return hn::Add(hn::Add(axis(0), axis(1)), axis(2));
}

// Goes down to the nearest child again and again; returns the leaf it ends in. A cheap way to a small radius.
HWY_INLINE std::size_t dive(const WideTree& tree, const LocalPoint& p, std::uint64_t& visits) {
    const Floats d;
    const hn::RebindToSigned<Floats> di;
    std::int32_t child = 0;
    while (child >= 0) {
        const WideNode& node = tree.nodes[static_cast<std::size_t>(child)];
        visits += static_cast<std::uint64_t>(node.count);
        // Distances are not negative, so their bits have their order; the last three make room for the lane. Lanes not in
        // use repeat the first child.
        auto nearest = hn::Set(di, std::numeric_limits<std::int32_t>::max());
        for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(d)) {
            const auto bits = hn::AndNot(hn::Set(di, 7), hn::BitCast(di, measure_children(node, lane, p)));
            nearest = hn::Min(nearest, hn::Or(bits, hn::Iota(di, static_cast<std::int32_t>(lane))));
        }
        child = node.child[hn::GetLane(hn::MinOfLanes(di, nearest)) & 7];
    }
    return static_cast<std::size_t>(~child);
}

// Calls leaf(i, squared) for leaves whose box may hold something at computed squared distance <= squared, near ones
// first; it may lower `squared`, and ends the walk by returning false.
template <class Leaf>
HWY_INLINE void walk(const WideTree& tree, const LocalPoint& p, double squared, std::uint64_t& visits, Leaf&& leaf) {
    struct Entry {
        float distance;
        std::int32_t child;
    };
    const Floats d;
    Entry stack[(tree_width - 1) * most_tree_levels + 1];
    std::size_t size = 0;
    std::int32_t child = 0;
    float bound = tree.frame.float_bound(squared);
    while (true) {
        if (child >= 0) {
            const WideNode& node = tree.nodes[static_cast<std::size_t>(child)];
            visits += static_cast<std::uint64_t>(node.count);
            alignas(64) float distances[tree_width];
            unsigned mask = 0;
            for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(d)) {
                const auto squares = measure_children(node, lane, p);
                hn::Store(squares, d, distances + lane);
                std::uint8_t bits[8] = {};
                hn::StoreMaskBits(d, hn::Le(squares, hn::Set(d, bound)), bits);
                mask |= static_cast<unsigned>(bits[0]) << lane;
            }
            mask &= (1U << node.count) - 1;
            if (std::has_single_bit(mask)) {
                child = node.child[std::countr_zero(mask)];
                continue;
            }
            // Insertion sort, farthest first, so that the nearest is popped first.
            const std::size_t base = size;
            for (; mask != 0; mask &= mask - 1) {
                const int c = std::countr_zero(mask);
                std::size_t place = size++;
                for (; place > base && stack[place - 1].distance < distances[c]; --place)
                    stack[place] = stack[place - 1];
                stack[place] = {distances[c], node.child[c]};
            }
        } else {
            const double before = squared;
            if (!leaf(static_cast<std::size_t>(~child), squared)) return;
            if (squared != before) bound = tree.frame.float_bound(squared);
        }
        Entry next;
        do {
            if (size == 0) return;
            next = stack[--size];
        } while (next.distance > bound);
        child = next.child;
    }
}

}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
