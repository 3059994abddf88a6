// Visits the leaves of a WideTree near a point, nearest first. Compiled once for each instruction set: include this
// file after hwy/foreach_target.h.
#include "algorithms/kernel/watched.h"
#include "algorithms/structures/wide_tree.h"

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
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

// Lower bounds on the computed squared distances from a point to anything in each box of a node. If the point is near
// the node, they are the integers `squares`, in multiples of `unit`; if it is far away, they are the doubles
// `from_far`.
struct BoxDistances {
    alignas(64) double from_far[tree_width];
    alignas(32) std::int32_t squares[tree_width];
    double unit;  // a power of two; 0: the point is far away

    HWY_INLINE double operator[](std::size_t i) const { return unit > 0 ? unit * squares[i] : from_far[i]; }
};

// Loads the sides of the boxes along axis k, from box `lane` on, and converts their bytes to doubles.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE hn::Vec<BoxLanes> load_planes(const std::uint8_t (&xy)[tree_width][2], const std::uint8_t (&z)[tree_width],
                                         std::size_t lane, int k) {
    return hn::Set(BoxLanes(), k < 2 ? xy[lane][k] : z[lane]);
}
#else
HWY_INLINE hn::Vec<BoxLanes> load_planes(const std::uint8_t (&xy)[tree_width][2], const std::uint8_t (&z)[tree_width],
                                         std::size_t lane, int k) {
    const BoxLanes d;
    const hn::Rebind<std::int32_t, BoxLanes> d32;
    const hn::Rebind<std::uint16_t, BoxLanes> pairs;
    const hn::Repartition<std::uint8_t, decltype(pairs)> bytes;
    if (k == 2) return hn::PromoteTo(d, hn::PromoteTo(d32, hn::LoadU(hn::Rebind<std::uint8_t, BoxLanes>(), z + lane)));
    const auto both = hn::BitCast(pairs, hn::LoadU(bytes, xy[lane]));  // x in the lower byte, y in the upper
    return hn::PromoteTo(d, hn::PromoteTo(d32, k == 0 ? hn::And(both, hn::Set(pairs, 0xff)) : hn::ShiftRight<8>(both)));
}
#endif

// Computes the squared distances from a distant point to the boxes, in double precision, with the operations of
// squared_distance_to_box (box.h).
inline HWY_NOINLINE void measure_far_boxes(const QuantisedBoxes& boxes, const Vec3& p, BoxDistances& distances) {
    const BoxLanes d;
    const auto step = hn::Set(d, boxes.step);
    for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(d)) {
        const auto axis = [&](int k) HWY_ATTR {
            const auto origin = hn::Set(d, boxes.origin[k]), at = hn::Set(d, p[k]);
            const auto low = hn::Add(origin, hn::Mul(load_planes(boxes.low_xy, boxes.low_z, lane, k), step));
            const auto high = hn::Add(origin, hn::Mul(load_planes(boxes.high_xy, boxes.high_z, lane, k), step));
            const auto out = hn::Max(hn::Max(hn::Sub(low, at), hn::Sub(at, high)), hn::Zero(d));
            return hn::Mul(out, out);
        };
        hn::Store(hn::Add(hn::Add(axis(0), axis(1)), axis(2)), d, distances.from_far + lane);
    }
    distances.unit = 0;
}

// For a point near the boxes: calls use(lane, squares) for each vector of boxes; the first of them is box `lane`. The
// squares are lower bounds on the squared distances, in units of (step / 16)^2. If the point is far away, more than
// 2^10 steps from the origin along some axis, returns false without a call.
//
// Along one axis, let q = (p - origin) / step be the coordinate of the point in steps, with |q| <= 2^10. As computed,
// it errs by at most 2^-42, because the difference is rounded. A plane may be inside the content by 2^-45 steps
// (QuantisedBoxes::set).
//
// The sum q + 1.5 * 2^48 leaves four bits of q after the binary point. So its last 16 bits are the integer n nearest to
// 16 * q, with n + 1 >= 16 * q + 1/2 and n - 1 <= 16 * q - 1/2. Let low and high be the bytes of the two planes of a
// box. If 16 * low - 1 - n is positive, it is less than the exact distance to the content along this axis, in
// sixteenths of a step, by at least 1/4: the 1/2 from above, minus the errors of q and of the plane. The same is true
// for n - (16 * high + 1) on the other side.
//
// Both numbers are at most 16 * 255 - 1 + 2^14 = 20463. So 1/4 is a relative difference of at least 2^-17: far more
// than double precision loses in computing the distance to a point of the content (rounding.h; underflow is negligible
// compared with a step of at least 2^-440). Hence the squares do not exceed the computed squared distances to the
// content.
//
// All these integers fit into 16 bits, and the sum of three squares is below 2^31. The product of this sum and (step /
// 16)^2 is exact, because step is a power of two.
#if HWY_TARGET == HWY_SCALAR
template <class Use> HWY_INLINE bool measure_near_boxes(const QuantisedBoxes& boxes, const Vec3& p, Use&& use) {
    std::int32_t squares[tree_width] = {};
    for (int k = 0; k < 3; ++k) {
        const double q = (p[k] - boxes.origin[k]) * boxes.inverse;
        if (!(std::abs(q) <= 0x1p10)) return false;
        const auto n = static_cast<std::int16_t>(std::bit_cast<std::uint64_t>(q + 0x1.8p48));
        for (std::size_t i = 0; i < tree_width; ++i) {
            const int low = k < 2 ? boxes.low_xy[i][k] : boxes.low_z[i],
                      high = k < 2 ? boxes.high_xy[i][k] : boxes.high_z[i];
            const int out = std::max({16 * low - 1 - n, n - (16 * high + 1), 0});
            squares[i] += out * out;
        }
    }
    const hn::CappedTag<std::int32_t, tree_width> d32;
    for (std::size_t i = 0; i < tree_width; ++i) use(i, hn::Set(d32, squares[i]));
    return true;
}
#else
template <class Use> HWY_INLINE bool measure_near_boxes(const QuantisedBoxes& boxes, const Vec3& p, Use&& use) {
    const hn::CappedTag<double, 4> d;
    const hn::Repartition<std::int32_t, decltype(d)> d32;
    const hn::Repartition<std::int16_t, decltype(d)> d16;
    const hn::Repartition<std::uint8_t, decltype(d)> d8;
    const auto inverse = hn::Set(d, boxes.inverse),
               most = hn::Set(d, WATCHED_ELSE("tree walk: coordinates near a node fit into 16 bits", 0x1p10, 0x1p12)),
               last_bits = hn::Set(d, 0x1.8p48);
    const auto xy = hn::Mul(hn::Sub(hn::LoadDup128(d, p.data()), hn::LoadDup128(d, boxes.origin)), inverse);
    const auto z = hn::Mul(hn::Sub(hn::Set(d, p[2]), hn::Set(d, boxes.origin[2])), inverse);
    const auto near = hn::And(hn::Le(hn::Abs(xy), most), hn::Le(hn::Abs(z), most));
    if (HWY_UNLIKELY(WATCHED("tree walk: far from a node, distances are not integers", !hn::AllTrue(d, near))))
        return false;
    // Byte patterns that select the last 16 bits of each coordinate: x and y repeated, and z with zeros between.
    alignas(16) static constexpr std::uint8_t from_xy[16] = {0, 1, 8, 9, 0, 1, 8, 9, 0, 1, 8, 9, 0, 1, 8, 9};
    alignas(16) static constexpr std::uint8_t from_z[16] = {0, 1, 255, 255, 0, 1, 255, 255,
                                                            0, 1, 255, 255, 0, 1, 255, 255};
    const auto n_xy =
        hn::BitCast(d16, hn::TableLookupBytes(hn::BitCast(d8, hn::Add(xy, last_bits)), hn::LoadDup128(d8, from_xy)));
    const auto n_z =
        hn::BitCast(d16, hn::TableLookupBytesOr0(hn::BitCast(d8, hn::Add(z, last_bits)), hn::LoadDup128(d8, from_z)));
    const auto one = hn::Set(d16, 1);
    const hn::Rebind<std::uint8_t, decltype(d16)> pairs;
    const hn::Rebind<std::uint8_t, decltype(d32)> singles;
    using Numbers = hn::Vec<decltype(d16)>;
    const auto out = [&](Numbers n, Numbers low, Numbers high) HWY_ATTR {
        const auto under =
            hn::Sub(hn::Sub(hn::ShiftLeft<4>(low),
                            WATCHED_ELSE("tree walk: a point is moved towards lower planes", one, hn::Zero(d16))),
                    n);
        const auto over =
            hn::Sub(n, hn::Add(hn::ShiftLeft<4>(high),
                               WATCHED_ELSE("tree walk: a point is moved towards upper planes", one, hn::Zero(d16))));
        return hn::Max(hn::Max(under, over), hn::Zero(d16));
    };
    for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(d32)) {
        const auto load_xy = [&](const std::uint8_t(&q)[tree_width][2])
                                 HWY_ATTR { return hn::PromoteTo(d16, hn::LoadU(pairs, q[lane])); };
        const auto load_z = [&](const std::uint8_t(&q)[tree_width])
                                HWY_ATTR { return hn::BitCast(d16, hn::PromoteTo(d32, hn::LoadU(singles, q + lane))); };
        const auto out_xy = out(n_xy, load_xy(boxes.low_xy), load_xy(boxes.high_xy));
        const auto out_z = out(n_z, load_z(boxes.low_z), load_z(boxes.high_z));
        auto odd = hn::Zero(d32);
        const auto squares_xy = hn::ReorderWidenMulAccumulate(d32, out_xy, out_xy, hn::Zero(d32), odd);
        const auto even = hn::ReorderWidenMulAccumulate(d32, out_z, out_z, squares_xy, odd);
        use(lane, hn::RearrangeToOddPlusEven(even, odd));
    }
    return true;
}
#endif

using BoxSquares = hn::Vec<hn::CappedTag<std::int32_t, tree_width>>;

// Returns a mask of the lanes whose square is at most `most`.
HWY_INLINE unsigned at_most(BoxSquares squares, std::int32_t most) {
    const hn::CappedTag<std::int32_t, tree_width> d;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Gt(squares, hn::Set(d, most)), bits);
    return ~static_cast<unsigned>(bits[0]) & ((1U << hn::Lanes(d)) - 1);
}

// Returns (step / 16)^2, the unit in which measure_near_boxes() gives squares.
HWY_INLINE double square_unit(const QuantisedBoxes& boxes) { return boxes.step * boxes.step * 0x1p-8; }

// Returns the largest integer n with n * square_unit() <= `squared`, but at most 2^31 - 1. The scale is a power of
// two, so the product is exact unless it underflows; then it is less than 1, so n is 0.
HWY_INLINE std::int32_t whole_units(const QuantisedBoxes& boxes, double squared) {
    const double scale = boxes.inverse * 16;
    return static_cast<std::int32_t>(WATCHED_ELSE("tree walk: a radius of more units than an integer holds",
                                                  std::min(squared * (scale * scale), 0x1p31 - 1),
                                                  squared * (scale * scale)));
}

// Returns a mask of the boxes whose squared distance `from_far` is at most `squared`.
inline unsigned near_from_far(const BoxDistances& distances, double squared) {
    const BoxLanes d;
    unsigned mask = 0;
    for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(d)) {
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::Le(hn::Load(d, distances.from_far + lane), hn::Set(d, squared)), bits);
        mask |= (bits[0] & ((1U << hn::Lanes(d)) - 1)) << lane;
    }
    return mask;
}

// Computes the distances from p to all boxes. Returns a mask of those among the first `count` boxes whose squared
// distance is at most `squared`, which must not be negative.
HWY_INLINE unsigned near_boxes(const QuantisedBoxes& boxes, std::int32_t count, const Vec3& p, double squared,
                               BoxDistances& distances) {
    const hn::CappedTag<std::int32_t, tree_width> d;
    unsigned mask = 0;
    const std::int32_t most = whole_units(boxes, squared);
    const bool near = measure_near_boxes(boxes, p, [&](std::size_t lane, BoxSquares squares) HWY_ATTR {
        hn::Store(squares, d, distances.squares + lane);
        mask |= at_most(squares, most) << lane;
    });
    distances.unit = square_unit(boxes);
    if (HWY_UNLIKELY(!near)) {
        measure_far_boxes(boxes, p, distances);
        mask = near_from_far(distances, squared);
    }
    return mask & ((1U << count) - 1);
}

// Like near_boxes(), but with distances that were computed before. Bits of unused boxes may be set, too.
HWY_INLINE unsigned near_again(const QuantisedBoxes& boxes, const BoxDistances& distances, double squared) {
    const hn::CappedTag<std::int32_t, tree_width> d;
    if (HWY_UNLIKELY(!(distances.unit > 0))) return near_from_far(distances, squared);
    const std::int32_t most = whole_units(boxes, squared);
    unsigned mask = 0;
    for (std::size_t lane = 0; lane < tree_width; lane += hn::Lanes(d)) {
        mask |= at_most(hn::Load(d, distances.squares + lane), most) << lane;
    }
    return mask;
}

// Computes the distances from p to all boxes and returns the index of the nearest, or of a hardly farther one, because
// the last three bits of squares are ignored. Unused boxes never win: they repeat box 0 and have a higher index.
HWY_INLINE std::uint32_t nearest_box(const QuantisedBoxes& boxes, const Vec3& p, BoxDistances& distances) {
    const hn::CappedTag<std::int32_t, tree_width> d;
    // The last three bits of a square are replaced with the index of the box, so that the minimum tells the index.
    auto nearest = hn::Set(d, std::numeric_limits<std::int32_t>::max());
    const bool near = measure_near_boxes(boxes, p, [&](std::size_t lane, BoxSquares squares) HWY_ATTR {
        hn::Store(squares, d, distances.squares + lane);
        const auto bits = hn::AndNot(hn::Set(d, 7), squares);
        nearest = hn::Min(nearest, hn::Or(bits, hn::Iota(d, static_cast<std::int32_t>(lane))));
    });
    distances.unit = square_unit(boxes);
    if (HWY_LIKELY(near)) return static_cast<std::uint32_t>(hn::GetLane(hn::MinOfLanes(d, nearest)) & 7);
    measure_far_boxes(boxes, p, distances);
    return static_cast<std::uint32_t>(std::min_element(distances.from_far, distances.from_far + tree_width) -
                                      distances.from_far);
}

// Visits the leaves of a tree near one point, nearest first.
class Walk {
public:
    // `leaves` is the caller's array with one entry per leaf. The walk prefetches the entries of leaves that it will
    // visit, but does not read them.
    template <class Leaf>
    HWY_INLINE Walk(const WideTree& tree, const Leaf* leaves, const Vec3& point, std::uint64_t& visits)
        : tree_(tree),
          leaves_(reinterpret_cast<const char*>(leaves)),
          leaf_bytes_(sizeof(Leaf)),
          point_(point),
          visits_(visits) {}

    // Goes from the root to the nearest child again and again, and returns the leaf that it reaches: a cheap way to
    // find a near triangle, and so a small radius. Call it at most once, before visit_leaves(), which then skips that
    // leaf.
    HWY_INLINE std::size_t greedy_descent() {
        std::int32_t child = 0;
        while (child >= 0) {
            const WideNode& node = tree_.nodes[static_cast<std::size_t>(child)];
            visits_ += static_cast<std::uint64_t>(node.count);
            Step& step = path_[depth_++];
            step.node = &node;
            step.taken = nearest_box(node.boxes, point_, step.distances);
            child = node.child[step.taken];
        }
        // Most other leaves to be visited have the same parent, so prefetch all its children.
        const WideNode& last = *path_[depth_ - 1].node;
        for (std::int32_t c = 0; c < last.count; ++c) prefetch(last.child[c]);
        return static_cast<std::size_t>(~child);
    }

    // Calls leaf(i, squared) for each leaf i that may contain a triangle at a computed squared distance of at most
    // `squared`, near leaves first. leaf() may lower `squared`. Stops when a call returns false.
    template <class Leaf> HWY_INLINE void visit_leaves(double squared, Leaf&& leaf) {
        std::int32_t child = 0;
        // Start with the children that greedy_descent() did not take; if it was not called, start at the root.
        for (std::size_t i = 0; i < depth_; ++i) {
            const Step& step = path_[i];
            const unsigned mask = near_again(step.node->boxes, step.distances, squared);
            push(*step.node, mask & ((1U << step.node->count) - 1) & ~(1U << step.taken), step.distances);
        }
        if (depth_ > 0 && !pop(squared, child)) return;
        while (true) {
            if (child >= 0) {
                const WideNode& node = tree_.nodes[static_cast<std::size_t>(child)];
                visits_ += static_cast<std::uint64_t>(node.count);
                BoxDistances distances;
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
    // A node on the path of greedy_descent(), which goes on to the child `taken`.
    struct Step {
        BoxDistances distances;
        const WideNode* node;
        std::uint32_t taken;
    };

    HWY_INLINE void prefetch(std::int32_t child) const {
        const char* place = child >= 0 ? reinterpret_cast<const char*>(tree_.nodes.data() + child)
                                       : leaves_ + static_cast<std::size_t>(~child) * leaf_bytes_;
        hwy::Prefetch(place);
        hwy::Prefetch(place + 64);
    }

    // Pushes the children that are set in `mask` onto the stack, farthest first, so that the nearest is popped first.
    HWY_INLINE void push(const WideNode& node, unsigned mask, const BoxDistances& distances) {
        const std::size_t base = size_;
        for (; mask != 0; mask &= mask - 1) {
            const auto c = static_cast<std::size_t>(std::countr_zero(mask));
            const double distance = distances[c];
            std::size_t place = size_++;
            for (; place > base && stack_[place - 1].distance < distance; --place) stack_[place] = stack_[place - 1];
            stack_[place] = {distance, node.child[c]};
            prefetch(node.child[c]);
        }
    }

    // Pops entries until one is at a squared distance of at most `squared`, and sets `child` to it. Returns false if
    // there is none.
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
