// The walks over triangle blocks: leaves near a point, nearest first or in any order. Compiled once for every target: include it after
// hwy/foreach_target.h.
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/triangle_frames-inl.h"
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

// Eight: a search must wait for its last result before it knows the next place, and wider vectors take longer.
using F = hn::CappedTag<float, 8>;
using VF = hn::Vec<F>;
using Keys = hn::RebindToSigned<F>;

// Distances from the origin of a leaf or node, in its units. Nearer than this, single precision is enough to filter:
// it errs by 2^-9 units for boxes, and by 2^-4 for triangles. Farther, boxes are measured in double precision, and so
// are all triangles of a leaf; still farther even that tells nothing, and there is no filter.
constexpr double farthest_in_float = 0x1p13, farthest_filtered = 0x1p60;
constexpr std::size_t most_levels = 9;  // 16^9 leaves are more than an Index counts

// A point in the coordinates of a leaf or node.
struct LocalPoint {
    float at[3];
    double exactly[3];
    double most;  // |coordinate|

    HWY_INLINE LocalPoint(const LocalUnits& units, const Vec3& point) : most(0) {
        for (int k = 0; k < 3; ++k) {
            exactly[k] = (point[k] - units.origin[k]) * units.inverse;
            at[k] = static_cast<float>(exactly[k]);
            most = std::max(most, std::abs(exactly[k]));
        }
    }
    HWY_INLINE bool is_near() const { return most < farthest_in_float; }
    HWY_INLINE bool is_filtered() const { return most < farthest_filtered; }

    // All content, which is within sqrt(3) units of the origin, is farther than this, in units.
    double base() const {
        double squared = 0;
        for (const double x : exactly) squared += x * x;
        return std::sqrt(squared) * (1 - 0x1p-50) - 2;
    }

    // Too far for a filter: no part of the content is nearer.
    HWY_INLINE bool beyond(const LocalUnits& units, double radius) const {
        return most < 0x1p900 && (most - 2) * units.unit > radius;
    }
};

// The largest distance that still matters. Rounding adds far less to a distance than the errors of single precision,
// unless a place is small beside its coordinates. M is the largest |coordinate| of the point and the place, u =
// 2^-53: a triangle at computed distance f is within f (1 + 4u) + 8uM (kernel/rounding.h), f < 4M: 24uM; a coordinate
// of the point in units of the place errs by u of at most 2M: sqrt(3) 2uM < 4uM; and a distance to a box from far
// away, computed in double precision, by 4u of at most 4M. Together this is less than the 64uM that are used.
class SearchRadius {
public:
    double distance;

    HWY_INLINE SearchRadius(double far, const Vec3& point)
        : distance(far), point_magnitude_(point.cwiseAbs().maxCoeff()) {}

    HWY_INLINE double at(const LocalUnits& units) const {
        return distance + rounding * std::max(units.magnitude, point_magnitude_);
    }

private:
    static constexpr double rounding = 64 * unit_roundoff;

    double point_magnitude_;
};

// To the nearest: a float that is at most x is at most this. Not infinite.
HWY_INLINE float limit_of(double x) { return x < 0x1p126 ? static_cast<float>(x) : std::numeric_limits<float>::max(); }

HWY_INLINE unsigned in_use(std::int32_t count) { return (1U << count) - 1; }

// Calls use(lane, squares) with the computed squared distances to the boxes of the children. Those of unused children
// are infinite.
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

// The same from far away, where single precision would tell nothing: the excess of the distances to the boxes over
// `base`. Rounding is monotone, so a larger excess is never rounded below the rounded far_limit; SearchRadius
// accounts for the error of a distance itself.
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

// What something within `radius` has at most there.
inline float far_limit(const BoxNode& node, double base, const SearchRadius& radius) {
    return limit_of(radius.at(node.units) * node.units.inverse - base);
}

// Returns the largest computed square of anything within `radius` in measure_children.
HWY_INLINE float box_limit(const BoxNode& node, const SearchRadius& radius) {
    const double in_units = radius.at(node.units) * node.units.inverse;
    return limit_of(in_units * in_units * (1 + box_error));
}

// The children of a node in the order of their distance: squares in its units, or the excess of a distance over a
// base, rounded down to a multiple of 16 in the last place, as integers, which have the same order; the last four
// bits name the child.
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
    // Returns the least.
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
    // Sets bit c if child c is at most `most` away. Unused children are NaN.
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
    // Takes all children, in their own order, because their distances are unknown.
    HWY_INLINE std::int32_t set_unknown(std::int32_t count) {
        for (std::int32_t c = 0; c <= child_bits; ++c) key[c] = c < count ? c : none;
        return 0;
    }
};

// Squared distances to the triangles of a leaf.
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

// How much a computed distance in the frames of a leaf may differ from the exact one, in its units.
HWY_INLINE double leaf_error(const LocalPoint& point) {
    return frame_error<float> * frame_roundoff<float> * (2 * point.most + 2);
}

// The square, in units of the leaf, that a triangle within `radius` has at most.
HWY_INLINE float leaf_limit(const TriangleFramesLeaf& leaf, double error, const SearchRadius& radius) {
    const double in_units = radius.at(leaf.units) * leaf.units.inverse + error;
    return limit_of(in_units * in_units);
}

// Calls leaf(number) for each leaf that may have something within `radius`, in any order, and ends where it returns false.
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

// A node on the way to the nearest leaf, and which of its children are left.
struct WalkStep {
    OrderedChildren children;
    const BoxNode* node;
    double base;                 // negative: the keys are squares
    std::uint32_t level, first;  // of the children

    // Returns the least key.
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
    HWY_INLINE bool beyond(std::int32_t key, const SearchRadius& radius) const {
        return (key & ~OrderedChildren::child_bits) > std::bit_cast<std::int32_t>(limit(radius));
    }
    HWY_INLINE std::uint32_t child(std::int32_t key) const {
        return first + static_cast<std::uint32_t>(key & OrderedChildren::child_bits);
    }

    // The nearest leaf, and then the others as they come: none has to wait for another then. False: leaf() wants no more.
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

// Calls leaf(number) for leaves that may have something within `radius`, which it may lower, and ends where it returns false. Nearest
// child first.
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
