// The walk over a WideTree: leaves near a point, nearest first. Compiled once for every target.
#include "wide_tree.h"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <bit>
#include <cmath>
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

// From far away: stores the computed squared distances to the boxes, as squared_distance_to_box (box.h).
inline HWY_NOINLINE void measure_far_boxes(const QuantisedBoxes& boxes, const Vec3& p,
                                           double (&distances)[tree_width]) {
    const BoxLanes d;
    const hn::Rebind<std::int32_t, BoxLanes> d32;
    const hn::Rebind<std::uint8_t, BoxLanes> d8;
    const auto step = hn::Set(d, boxes.step);
    for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(d)) {
        const auto axis = [&](int k) HWY_ATTR {
            const auto origin = hn::Set(d, boxes.origin[k]), at = hn::Set(d, p[k]);
            const auto plane = [&](const std::uint8_t* q) HWY_ATTR {
                const auto steps = hn::PromoteTo(d, hn::PromoteTo(d32, hn::LoadU(d8, q + lane)));
                return hn::Add(origin, hn::Mul(steps, step));
            };
            const auto below = hn::Sub(plane(boxes.low[k]), at), above = hn::Sub(at, plane(boxes.high[k]));
            const auto out = hn::Max(hn::Max(below, above), hn::Zero(d));
            return hn::Mul(out, out);
        };
        hn::Store(hn::Add(hn::Add(axis(0), axis(1)), axis(2)), d, distances + lane);
    }
}

// Calls use(lane, squares) with squared distances to some boxes, until all boxes have had their turn: none is more than the
// computed squared distance to a point of the box's content.
//
// All is in sixteenths of a step from the origin, and integers. Along an axis, let q be the coordinate of the point in
// steps, |q| <= 2^10; the double difference errs by 2^-42 at most, planes by 2^-45. The last bits of q + 1.5 2^48 tell 16 q
// to nearest, so `above` is 16 q + 1/2 or more and `below` is 16 q - 1/2 or less. Hence a positive low - above or below -
// high, at most 20481, is less than the exact distance to the content by 1/4 and more, which is a factor of 1 + 2^-17 or
// more: far more than what is lost in double precision (rounding.h; what underflows is nothing beside a step of 2^-440).
// Three squares sum up to less than 2^31, and the product with the square of a sixteenth of a step, a power of two, is
// exact.
template <class Use> HWY_INLINE void measure_boxes(const QuantisedBoxes& boxes, const Vec3& p, Use&& use) {
    const BoxLanes d;
    const hn::CappedTag<std::int32_t, tree_width> di;
    const hn::Rebind<std::uint8_t, decltype(di)> d8;
    std::int32_t above[3], below[3];
    bool far = false;
    for (int k = 0; k < 3; ++k) {
        const double q = (p[k] - boxes.origin[k]) * boxes.inverse;
        far |= !(std::abs(q) <= 0x1p10);
        // Unsigned, since the bits of a far point may be anything.
        const auto nearest = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(q + 0x1.8p48));
        above[k] = static_cast<std::int32_t>(nearest + 1);
        below[k] = static_cast<std::int32_t>(nearest - 1);
    }
    if (HWY_UNLIKELY(far)) {
        alignas(64) double distances[tree_width];
        measure_far_boxes(boxes, p, distances);
        for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(d)) use(lane, hn::Load(d, distances + lane));
        return;
    }
    const auto unit = hn::Set(d, boxes.step * boxes.step * 0x1p-8);
    for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(di)) {
        const auto axis = [&](int k) HWY_ATTR {
            const auto plane = [&](const std::uint8_t* q)
                                   HWY_ATTR { return hn::ShiftLeft<4>(hn::PromoteTo(di, hn::LoadU(d8, q + lane))); };
            const auto under = hn::Sub(plane(boxes.low[k]), hn::Set(di, above[k]));
            const auto over = hn::Sub(hn::Set(di, below[k]), plane(boxes.high[k]));
            const auto out = hn::Max(hn::Max(under, over), hn::Zero(di));
            return hn::Mul(out, out);
        };
        const auto squares = hn::Add(hn::Add(axis(0), axis(1)), axis(2));
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET <= HWY_AVX3  // as many lanes of either kind
        use(lane, hn::Mul(unit, hn::PromoteTo(d, squares)));
#else
        const hn::Half<decltype(di)> half;
        use(lane, hn::Mul(unit, hn::PromoteTo(d, hn::LowerHalf(half, squares))));
        use(lane + hn::Lanes(d), hn::Mul(unit, hn::PromoteTo(d, hn::UpperHalf(half, squares))));
#endif
    }
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
    unsigned mask = 0;
    measure_boxes(boxes, p, [&](std::size_t lane, hn::Vec<BoxLanes> squares) HWY_ATTR {
        hn::Store(squares, BoxLanes(), distances + lane);
        mask |= near(squares, squared) << lane;
    });
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
            measure_boxes(node.boxes, point_, [&](std::size_t lane, hn::Vec<BoxLanes> squares) HWY_ATTR {
                hn::Store(squares, d, step.distances + lane);
                const auto bits = hn::AndNot(hn::Set(du, 7), hn::BitCast(du, squares));
                nearest = hn::Min(nearest, hn::BitCast(d, hn::Or(bits, hn::Iota(du, lane))));
            });
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
