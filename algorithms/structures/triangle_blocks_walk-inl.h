// Functions that visit the leaves of TriangleBlocks near a point, nearest first or in any order. Compiled once for each
// instruction set: include this file after hwy/foreach_target.h.
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/triangle_frames-inl.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/structures/triangle_blocks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#if defined(HAUSBENCH_TRIANGLE_BLOCKS_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HAUSBENCH_TRIANGLE_BLOCKS_WALK_INL
#undef HAUSBENCH_TRIANGLE_BLOCKS_WALK_INL
#else
#define HAUSBENCH_TRIANGLE_BLOCKS_WALK_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {
namespace {

// Eight lanes at most. A search must finish one step before it knows the next one, and operations on wider vectors
// take longer to finish.
using F = hn::CappedTag<float, 8>;
using VF = hn::Vec<F>;
using Keys = hn::RebindToSigned<F>;

// How far away a point may be, by its largest |coordinate| in the local coordinates of a leaf or node:
//   - Below farthest_in_float, distances to boxes and triangles are computed in single precision, with errors of at
//     most 2^-9 and 2^-4 units.
//   - Below farthest_filtered, distances to boxes are computed in double precision, and no triangle of a leaf is
//     rejected.
//   - Farther away, even double precision cannot tell the children of a node apart. All are visited, unless
//     LocalPoint::beyond() rejects the whole node.
constexpr double farthest_in_float = 0x1p13, farthest_filtered = 0x1p60;
constexpr std::size_t most_levels = 9;  // 16^9 leaves exceed the range of Index

// A point in the local coordinates of a leaf or node.
struct LocalPoint {
    float at[3];
    double exactly[3];  // the same in double precision
    double most;        // the largest |coordinate|

    HWY_INLINE LocalPoint(const LocalUnits& units, const Vec3& point) : most(0) {
        for (int k = 0; k < 3; ++k) {
            exactly[k] = (point[k] - units.origin[k]) * units.inverse;
            at[k] = static_cast<float>(exactly[k]);
            most = std::max(most, std::abs(exactly[k]));
        }
    }
    HWY_INLINE bool is_near() const { return most < farthest_in_float; }
    HWY_INLINE bool is_filtered() const {
        return most < WATCHED_ELSE("triangle blocks: where boxes are no filter", farthest_filtered, 0x1p500);
    }

    // Returns a lower bound, in units, on the distance from the point to every triangle of the leaf or node: its
    // distance from the origin minus 2, because all of them are within sqrt(3) units of the origin.
    double base() const {
        double squared = 0;
        for (const double x : exactly) squared += x * x;
        return std::sqrt(squared) * (1 - 0x1p-50) -
               WATCHED_ELSE("triangle blocks: what all boxes are farther than", 2, -2);
    }

    // Returns true only if all triangles of the leaf or node are certainly farther away than `radius`. A coarse test
    // for very distant points. Returns false if coordinates are so large that they may have overflowed.
    HWY_INLINE bool beyond(const LocalUnits& units, double radius) const {
        return most < 0x1p900 &&
               (most - WATCHED("triangle blocks: the size of what is far away", 2)) * units.unit > radius;
    }
};

// The radius of a search: a triangle matters only if its computed distance is at most `distance`. The filters compare
// exact distances, up to the errors of single precision; so at() adds a bound on the errors of double precision. They
// matter only if a leaf or node is far from the origin compared with its size. Let M be the largest |coordinate| of
// the point and of the leaf or node (in the units of the mesh), and u = 2^-53:
//   - A triangle at computed distance f has an exact distance of at most f * (1 + 4u) + 8uM (kernel/rounding.h). Two
//     points are less than 4M apart, so f < 4M, and this is at most f + 24uM.
//   - The local coordinates of the point are computed from differences of at most 2M, each with an error of u * 2M. In
//     length, this is sqrt(3) * 2uM < 4uM.
//   - The distance to a box far away, computed in double precision, errs by 4u * 4M = 16uM.
// Together this is 44uM. The code adds 64uM; the rest is slack.
class SearchRadius {
public:
    double distance;

    HWY_INLINE SearchRadius(double far, const Vec3& point)
        : distance(far), point_magnitude_(point.cwiseAbs().maxCoeff()) {}

    HWY_INLINE double at(const LocalUnits& units) const {
        return distance + WATCHED("triangle blocks: rounding in double precision", rounding) *
                              std::max(units.magnitude, point_magnitude_);
    }

private:
    static constexpr double rounding = 64 * unit_roundoff;

    double point_magnitude_;
};

// Rounds an upper limit to float. Rounding is monotone, so every float that is at most x is at most the result. Never
// infinite, so the infinite distances of unused lanes are above every limit.
HWY_INLINE float limit_of(double x) { return x < 0x1p126 ? static_cast<float>(x) : std::numeric_limits<float>::max(); }

// Returns the mask of the first `count` lanes.
HWY_INLINE unsigned in_use(std::int32_t count) { return (1U << count) - 1; }

// Computes the squared distances from a point to the boxes of a node's children, in units of the node. Calls use(lane,
// squares) for each vector of children, of which `lane` is the first. Unused lanes are infinite.
template <class Use> HWY_INLINE void measure_children(const BoxNode& node, const LocalPoint& point, const Use& use) {
    const F d;
    const VF at[3] = {hn::Set(d, point.at[0]), hn::Set(d, point.at[1]), hn::Set(d, point.at[2])};
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d)) {
        const auto square = [&](std::size_t k) HWY_ATTR {
            const VF out = hn::Max(hn::Sub(hn::Load(d, node.low[k] + lane), at[k]),
                                   hn::Sub(at[k], hn::Load(d, node.high[k] + lane)));
            const VF outside = hn::Max(out, hn::Zero(d));
            return hn::Mul(outside, outside);
        };
        use(lane, hn::Add(hn::Add(square(0), square(1)), square(2)));
    }
}

// Like measure_children(), but for a point so far away that single precision could not tell the boxes apart. Computes
// distances (not squares) in double precision, subtracts `base`, a lower bound on all of them, and rounds the rest to
// float. Compare the results with far_limit(): it is rounded in the same way, and rounding is monotone. SearchRadius
// includes the errors of double precision.
template <class Use>
HWY_INLINE void measure_far_children(const BoxNode& node, const LocalPoint& point, double base, const Use& use) {
    alignas(64) float above[frames_width];
    for (std::size_t c = 0; c < frames_width; ++c) {
        double squared = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double out = std::max({static_cast<double>(node.low[k][c]) - point.exactly[k],
                                         point.exactly[k] - static_cast<double>(node.high[k][c]), 0.0});
            squared += out * out;
        }
        above[c] = static_cast<float>(std::sqrt(squared) - base);  // infinite if not in use
    }
    const F d;
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d)) use(lane, hn::Load(d, above + lane));
}

// Returns the limit for measure_far_children(): a box for which it gives a larger number has no triangle within
// `radius`.
inline float far_limit(const BoxNode& node, double base, const SearchRadius& radius) {
    return limit_of(radius.at(node.units) * node.units.inverse - base);
}

// Returns the limit for measure_children(): a box for which it gives a larger square has no triangle within `radius`.
HWY_INLINE float box_limit(const BoxNode& node, const SearchRadius& radius) {
    const double in_units = radius.at(node.units) * node.units.inverse;
    return limit_of(in_units * in_units * (1 + WATCHED("triangle blocks: distances to boxes, rounded", box_error)));
}

// The children of a node that are still to be visited: least() returns the key of the nearest one, and remove() removes
// it. A key is a distance as a float, with the number of the child in its last four bits. Keys are compared as
// integers, which have the same order as non-negative floats.
struct alignas(64) OrderedChildren {
    std::int32_t key[frames_width];

    static constexpr std::int32_t none = std::numeric_limits<std::int32_t>::max(), child_bits = frames_width - 1;

    HWY_INLINE std::int32_t least() const {
        const Keys d;
        auto all = hn::Load(d, key);
        for (std::size_t lane = hn::Lanes(d); lane < frames_width; lane += hn::Lanes(d))
            all = hn::Min(all, hn::Load(d, key + lane));
        return hn::GetLane(hn::MinOfLanes(d, all));
    }
    HWY_INLINE void remove(std::int32_t taken) {
        const Keys d;
        for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d)) {
            const auto keys = hn::Load(d, key + lane);
            hn::Store(hn::IfThenElse(hn::Eq(keys, hn::Set(d, taken)), hn::Set(d, none), keys), d, key + lane);
        }
    }
    // Set the key of each child to its squared distance or, in set_far(), to its distance minus `base`. Return the
    // least key.
    HWY_INLINE std::int32_t set(const BoxNode& node, const LocalPoint& point) {
        return set_by([&](const auto& use) HWY_ATTR { measure_children(node, point, use); });
    }
    HWY_INLINE std::int32_t set_far(const BoxNode& node, const LocalPoint& point, double base) {
        return set_by([&](const auto& use) HWY_ATTR { measure_far_children(node, point, base, use); });
    }
    template <class Measure> HWY_INLINE std::int32_t set_by(const Measure& measure) {
        const Keys d;
        auto all = hn::Set(d, none);
        measure([&](std::size_t lane, VF distances) HWY_ATTR {
            const auto bits = hn::AndNot(hn::Set(d, child_bits), hn::BitCast(d, distances));
            const auto keys = hn::Or(bits, hn::Iota(d, static_cast<std::int32_t>(lane)));
            hn::Store(keys, d, key + lane);
            all = hn::Min(all, keys);
        });
        return hn::GetLane(hn::MinOfLanes(d, all));
    }
    // Returns a mask of the children whose distance, as stored in the key, is at most `most`. A removed child has the
    // key `none`, which is NaN as a float, so it never counts.
    HWY_INLINE unsigned within(float most) const {
        const F d;
        const Keys di;
        unsigned mask = 0;
        for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d)) {
            const auto squares = hn::BitCast(d, hn::AndNot(hn::Set(di, child_bits), hn::Load(di, key + lane)));
            mask |= lane_bits(d, hn::Le(squares, hn::Set(d, most))) << lane;
        }
        return mask;
    }
    // Sets the keys if no distances are known: every child gets the distance 0. Returns the least key.
    HWY_INLINE std::int32_t set_unknown(std::int32_t count) {
        for (std::int32_t c = 0; c <= child_bits; ++c) key[c] = c < count ? c : none;
        return 0;
    }
};

// Computes the squared distances from a point to the triangles of a leaf in single precision, in units of the leaf.
HWY_INLINE void leaf_squares(const TriangleFramesLeaf& leaf, const LocalPoint& point, float (&squared)[frames_width]) {
    const F d;
    const VF x = hn::Set(d, point.at[0]), y = hn::Set(d, point.at[1]), z = hn::Set(d, point.at[2]);
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d)) {
        const auto row = [&](std::size_t i) HWY_ATTR { return hn::Load(d, leaf.frames.row[i] + lane); };
        hn::Store(squared_in_lanes(d, row, x, y, z), d, squared + lane);
    }
}

HWY_INLINE unsigned squares_within(const float (&squared)[frames_width], float most) {
    const F d;
    unsigned mask = 0;
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d))
        mask |= lane_bits(d, hn::Le(hn::Load(d, squared + lane), hn::Set(d, most))) << lane;
    return mask;
}

HWY_INLINE float least_of(const float (&squared)[frames_width]) {
    const F d;
    VF all = hn::Load(d, squared);
    for (std::size_t lane = hn::Lanes(d); lane < frames_width; lane += hn::Lanes(d))
        all = hn::Min(all, hn::Load(d, squared + lane));
    return hn::GetLane(hn::MinOfLanes(d, all));
}

// Returns an upper bound on the error of a distance from leaf_squares(), as a length in units of the leaf.
HWY_INLINE double leaf_error(const LocalPoint& point) {
    return WATCHED("triangle blocks: the error of frames",
                   frame_error<float> * frame_roundoff<float> * (2 * point.most + 2));
}

// Returns the limit for leaf_squares(): a triangle with a larger square is not within `radius`. `error` is
// leaf_error().
HWY_INLINE float leaf_limit(const TriangleFramesLeaf& leaf, double error, const SearchRadius& radius) {
    const double in_units = radius.at(leaf.units) * leaf.units.inverse + error;
    return limit_of(in_units * in_units);
}

// Calls leaf(number), in any order, for each leaf that may contain a triangle within `radius` of `point`. Stops when a
// call returns false.
template <class Leaf>
HWY_INLINE void visit_within(const TriangleBlocks::Tree& tree, const Vec3& point, const SearchRadius& radius,
                             std::uint64_t& visits, const Leaf& leaf) {
    struct Entry {
        std::uint32_t level, index;
    };
    Entry stack[frames_width * most_levels];
    std::size_t size = 0;
    stack[size++] = {static_cast<std::uint32_t>(tree.level_begin.size()), 0};
    while (size > 0) {
        const Entry at = stack[--size];
        const BoxNode& node = tree.nodes[tree.level_begin[at.level - 1] + at.index];
        visits += static_cast<std::uint64_t>(node.count);
        const LocalPoint local(node.units, point);
        unsigned mask = in_use(node.count);
        if (HWY_LIKELY(local.is_filtered())) {
            const F d;
            const double base = local.is_near() ? 0 : local.base();
            const VF most = hn::Set(d, local.is_near() ? box_limit(node, radius) : far_limit(node, base, radius));
            unsigned within = 0;
            const auto compare = [&](std::size_t lane, VF distances)
                                     HWY_ATTR { within |= lane_bits(d, hn::Le(distances, most)) << lane; };
            if (HWY_LIKELY(local.is_near()))
                measure_children(node, local, compare);
            else
                measure_far_children(node, local, base, compare);
            mask &= within;
        } else if (local.beyond(node.units, radius.at(node.units))) {
            mask = 0;
        }
        for (; mask != 0; mask &= mask - 1) {
            const auto child = static_cast<std::uint32_t>(at.index * frames_width) +
                               static_cast<std::uint32_t>(std::countr_zero(mask));
            if (at.level > 1)
                stack[size++] = {at.level - 1, child};
            else if (!leaf(std::size_t{child}))
                return;
        }
    }
}

// A node on the path from the root to the current node, and its children that are still to be visited.
struct WalkStep {
    OrderedChildren children;
    const BoxNode* node;
    double base;                 // the keys are distances minus this; negative: the keys are squared distances
    std::uint32_t level, first;  // the level of the children, and the index of child 0 in that level

    // Moves to a node and sets the keys of its children. Returns the least key, or `none` if all triangles below the
    // node are farther away than the radius.
    HWY_INLINE std::int32_t set(const BoxNode& at, const Vec3& point, const SearchRadius& radius) {
        const LocalPoint local(at.units, point);
        node = &at;
        base = -1;
        if (HWY_LIKELY(local.is_near())) return children.set(at, local);
        if (local.is_filtered()) {
            base = local.base();
            return children.set_far(at, local, base);
        }
        return local.beyond(at.units, radius.at(at.units)) ? OrderedChildren::none : children.set_unknown(at.count);
    }
    HWY_INLINE float limit(const SearchRadius& radius) const {
        return HWY_LIKELY(base < 0) ? box_limit(*node, radius) : far_limit(*node, base, radius);
    }
    // Returns whether the child with this key, and so every child with a larger key, is farther away than the radius.
    HWY_INLINE bool beyond(std::int32_t key, const SearchRadius& radius) const {
        return (key & ~OrderedChildren::child_bits) > std::bit_cast<std::int32_t>(limit(radius));
    }
    HWY_INLINE std::uint32_t child(std::int32_t key) const {
        return first + static_cast<std::uint32_t>(key & OrderedChildren::child_bits);
    }

    // For a node whose children are leaves: calls leaf(number) for the nearest leaf, which has the key `least`, then
    // for all others within the radius, in any order, so that the processor can overlap their work. Returns false if a
    // call returns false.
    template <class Leaf>
    HWY_INLINE bool visit_leaves(std::int32_t least, const SearchRadius& radius, const Leaf& leaf) const {
        if (beyond(least, radius)) return true;
        if (!leaf(std::size_t{child(least)})) return false;
        const auto nearest = static_cast<unsigned>(least & OrderedChildren::child_bits);
        for (unsigned mask = children.within(limit(radius)) & ~(1U << nearest); mask != 0; mask &= mask - 1) {
            const auto c = static_cast<std::uint32_t>(std::countr_zero(mask));
            if (!beyond(children.key[c], radius) && !leaf(std::size_t{first + c})) return false;
        }
        return true;
    }
};

// Calls leaf(number) for the leaves that may contain a triangle within `radius` of `point`. At every node, the nearest
// child comes first. leaf() may lower the radius. Stops when a call returns false.
template <class Leaf>
HWY_INLINE void visit_nearest(const TriangleBlocks::Tree& tree, const Vec3& point, const SearchRadius& radius,
                              std::uint64_t& visits, const Leaf& leaf) {
    WalkStep path[most_levels];
    std::size_t depth = 0;
    std::uint32_t level = static_cast<std::uint32_t>(tree.level_begin.size()), index = 0;
    while (true) {
        const BoxNode& node = tree.nodes[tree.level_begin[level - 1] + index];
        visits += static_cast<std::uint64_t>(node.count);
        WalkStep* step = path + depth++;
        std::int32_t next = step->set(node, point, radius);
        step->level = level - 1;
        step->first = static_cast<std::uint32_t>(index * frames_width);
        if (step->level == 0) {
            if (!step->visit_leaves(next, radius, leaf) || --depth == 0) return;
            next = (--step)->children.least();
        }
        while (step->beyond(next, radius)) {
            if (--depth == 0) return;
            next = (--step)->children.least();
        }
        step->children.remove(next);
        index = step->child(next);
        level = step->level;
    }
}

}  // namespace
}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
