// The walk over a WideTree: leaves near a point, nearest first. Compiled once for every target.
#include "wide_tree.h"

#include <hwy/cache_control.h>
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

using BoxLanes = hn::CappedTag<double, tree_width>;

// Computed squared distances to some of the boxes, as squared_distance_to_box (box.h).
HWY_INLINE hn::Vec<BoxLanes> squared_distances_to_boxes(const QuantisedBoxes& boxes, std::size_t lane, const Vec3& p) {
    const BoxLanes d;
    const hn::Rebind<std::int32_t, BoxLanes> d32;
    const hn::Rebind<std::uint8_t, BoxLanes> d8;
    const auto axis = [&](int k) HWY_ATTR {
        const auto origin = hn::Set(d, boxes.origin[k]), step = hn::Set(d, boxes.step(k)), at = hn::Set(d, p[k]);
        const auto plane = [&](const std::uint8_t* q) HWY_ATTR {
            const auto steps = hn::PromoteTo(d, hn::PromoteTo(d32, hn::LoadU(d8, q + lane)));
            return hn::Add(origin, hn::Mul(steps, step));
        };
        const auto below = hn::Sub(plane(boxes.low[k]), at), above = hn::Sub(at, plane(boxes.high[k]));
        const auto out = hn::Max(hn::Max(below, above), hn::Zero(d));
        return hn::Mul(out, out);
    };
    return hn::Add(hn::Add(axis(0), axis(1)), axis(2));
}

// A bit for each lane: whether it is at most `squared`.
HWY_INLINE unsigned near(hn::Vec<BoxLanes> squares, double squared) {
    const BoxLanes d;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Le(squares, hn::Set(d, squared)), bits);
    return bits[0];
}

// Stores the squared distances to all boxes; the bits that are set tell those of the first `count` at most `squared` away.
HWY_INLINE unsigned near_boxes(const QuantisedBoxes& boxes, std::int32_t count, const Vec3& p, double squared,
                               double (&distances)[tree_width]) {
    const BoxLanes d;
    unsigned mask = 0;
    for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(d)) {
        const auto squares = squared_distances_to_boxes(boxes, lane, p);
        hn::Store(squares, d, distances + lane);
        mask |= near(squares, squared) << lane;
    }
    return mask & ((1U << count) - 1);
}

// A walk over the leaves near one point.
class Walk {
public:
    // `leaves`: what the caller keeps of each leaf, to be loaded early.
    template <class Leaf>
    HWY_INLINE Walk(const WideTree& tree, const Leaf* leaves, const Vec3& point, std::uint64_t& visits)
        : tree_(tree),
          leaves_(reinterpret_cast<const char*>(leaves)),
          leaf_bytes_(sizeof(Leaf)),
          point_(point),
          visits_(visits) {}

    // Goes down to the nearest child again and again; returns the leaf it ends in: a cheap way to a small radius. At most
    // once, before the leaves are visited, which then leave it out.
    HWY_INLINE std::size_t greedy_descent() {
        const BoxLanes d;
        const hn::RebindToUnsigned<BoxLanes> du;
        std::int32_t child = 0;
        while (child >= 0) {
            const WideNode& node = tree_.nodes[static_cast<std::size_t>(child)];
            visits_ += static_cast<std::uint64_t>(node.count);
            Step& step = path_[depth_++];
            step.node = &node;
            // The last three bits of a distance make room for the lane. Lanes not in use repeat the first child.
            auto nearest = hn::Set(d, std::numeric_limits<double>::max());
            for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(d)) {
                const auto squares = squared_distances_to_boxes(node.boxes, lane, point_);
                hn::Store(squares, d, step.distances + lane);
                const auto bits = hn::AndNot(hn::Set(du, 7), hn::BitCast(du, squares));
                nearest = hn::Min(nearest, hn::BitCast(d, hn::Or(bits, hn::Iota(du, lane))));
            }
            step.taken = static_cast<std::uint32_t>(hn::GetLane(hn::BitCast(du, hn::MinOfLanes(d, nearest))) & 7);
            child = node.child[step.taken];
        }
        // Most of the other leaves that will be visited are beside this one.
        const WideNode& last = *path_[depth_ - 1].node;
        for (std::int32_t c = 0; c < last.count; ++c) prefetch(last.child[c]);
        return static_cast<std::size_t>(~child);
    }

    // Calls leaf(i, squared) for leaves whose box may hold something at computed squared distance <= squared, near ones
    // first; it may lower `squared`, and ends the walk by returning false.
    template <class Leaf> HWY_INLINE void visit_leaves(double squared, Leaf&& leaf) {
        const BoxLanes d;
        std::int32_t child = 0;
        // What the descent has passed by; without one, the root.
        for (std::size_t i = 0; i < depth_; ++i) {
            const Step& step = path_[i];
            unsigned mask = 0;
            for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(d)) {
                mask |= near(hn::Load(d, step.distances + lane), squared) << lane;
            }
            push(*step.node, mask & ((1U << step.node->count) - 1) & ~(1U << step.taken), step.distances);
        }
        if (depth_ > 0 && !pop(squared, child)) return;
        while (true) {
            if (child >= 0) {
                const WideNode& node = tree_.nodes[static_cast<std::size_t>(child)];
                visits_ += static_cast<std::uint64_t>(node.count);
                alignas(64) double distances[tree_width];
                const unsigned mask = near_boxes(node.boxes, node.count, point_, squared, distances);
                if (std::has_single_bit(mask)) {
                    child = node.child[std::countr_zero(mask)];
                    continue;
                }
                push(node, mask, distances);
            } else if (!leaf(static_cast<std::size_t>(~child), squared)) {
                return;
            }
            if (!pop(squared, child)) return;
        }
    }

private:
    struct Entry {
        double distance;
        std::int32_t child;
    };
    struct Step {
        alignas(64) double distances[tree_width];
        const WideNode* node;
        std::uint32_t taken;
    };

    HWY_INLINE void prefetch(std::int32_t child) const {
        const char* place = child >= 0 ? reinterpret_cast<const char*>(tree_.nodes.data() + child)
                                       : leaves_ + static_cast<std::size_t>(~child) * leaf_bytes_;
        hwy::Prefetch(place);
        hwy::Prefetch(place + 64);
    }

    // Insertion sort, farthest first, so that the nearest is popped first.
    HWY_INLINE void push(const WideNode& node, unsigned mask, const double (&distances)[tree_width]) {
        const std::size_t base = size_;
        for (; mask != 0; mask &= mask - 1) {
            const int c = std::countr_zero(mask);
            std::size_t place = size_++;
            for (; place > base && stack_[place - 1].distance < distances[c]; --place)
                stack_[place] = stack_[place - 1];
            stack_[place] = {distances[c], node.child[c]};
            prefetch(node.child[c]);
        }
    }

    // False: nothing is left that is near enough.
    HWY_INLINE bool pop(double squared, std::int32_t& child) {
        while (size_ > 0) {
            const Entry& next = stack_[--size_];
            child = next.child;
            if (next.distance <= squared) return true;
        }
        return false;
    }

    const WideTree& tree_;
    const char* leaves_;
    std::size_t leaf_bytes_;
    const Vec3& point_;
    std::uint64_t& visits_;
    std::size_t depth_ = 0, size_ = 0;
    Step path_[most_tree_levels];
    Entry stack_[(tree_width - 1) * most_tree_levels + 1];
};

}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
