#include "kernel/rounding.h"
#include "triangle_blocks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "structures/triangle_blocks_search.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include "kernel/triangle_frames-inl.h"
#include "nearest-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {
namespace {

// Eight: a search waits for what it looked at before it knows what to look at next, and wider vectors take longer.
using F = hn::CappedTag<float, 8>;
using VF = hn::Vec<F>;
using Keys = hn::RebindToSigned<F>;

// Farther from the origin of a leaf or node, in its units, squares might overflow, and there is no filter.
constexpr double farthest_filtered = 0x1p40;
constexpr std::size_t most_levels = 9;  // 16^9 leaves are more than an Index counts

// A point in the coordinates of a leaf or node.
struct LocalPoint {
    float at[3];
    double most;  // |coordinate|

    HWY_INLINE LocalPoint(const LocalUnits& units, const Vec3& point) : most(0) {
        for (int k = 0; k < 3; ++k) {
            const double q = (point[k] - units.origin[k]) * units.inverse;
            at[k] = static_cast<float>(q);
            most = std::max(most, std::abs(q));
        }
    }
    HWY_INLINE bool is_near() const { return most < farthest_filtered; }

    // Where it is too far for a filter: no part of the content, which is within sqrt(3) units of the origin, is nearer.
    HWY_INLINE bool beyond(const LocalUnits& units, double reach) const {
        return most < 0x1p900 && (most * (1 - 0x1p-50) - 2) * units.unit > reach;
    }
};

// How far away something may be and still matter.
struct Reach {
    double distance;
    double rounding = 0;  // of the larger one of |coordinate| of the point and of what is there: may be added
    double point_magnitude = 0;

    HWY_INLINE double at(const LocalUnits& units) const {
        return distance + rounding * std::max(units.magnitude, point_magnitude);
    }
};

// To the nearest: a float that is at most x is at most this. Not infinite.
HWY_INLINE float limit_of(double x) { return x < 0x1p126 ? static_cast<float>(x) : std::numeric_limits<float>::max(); }

HWY_INLINE unsigned in_use(std::int32_t count) { return (1U << count) - 1; }

// Calls use(lane, squares) with the squared distances to the boxes of the children, as computed. Those of what is not in use are
// infinite.
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

// What the square of something within `reach` is at most in measure_children.
HWY_INLINE float box_limit(const BoxNode& node, const Reach& reach) {
    const double in_units = reach.at(node.units) * node.units.inverse;
    return limit_of(in_units * in_units * (1 + box_error));
}

// The children of a node in the order of their distance: squares in its units, rounded down to a multiple of 16 in the last place, as
// integers, which are in the same order; the last four bits tell the child.
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
        const Keys d;
        auto all = hn::Set(d, none);
        measure_children(node, point, [&](std::size_t lane, VF squares) HWY_ATTR {
            const auto bits = hn::AndNot(hn::Set(d, child_bits), hn::BitCast(d, squares));
            const auto keys = hn::Or(bits, hn::Iota(d, static_cast<std::int32_t>(lane)));
            hn::Store(keys, d, key + lane);
            all = hn::Min(all, keys);
        });
        return hn::GetLane(hn::MinOfLanes(d, all));
    }
    // Bit c: the square of child c is at most `most`. What is none is no number.
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
    // Where nothing is known of distances.
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

// The square, in units of the leaf, that a triangle within `reach` has at most.
HWY_INLINE float leaf_limit(const TriangleFramesLeaf& leaf, double error, const Reach& reach) {
    const double in_units = reach.at(leaf.units) * leaf.units.inverse + error;
    return limit_of(in_units * in_units);
}

// Calls leaf(number) for each leaf that may have something within `reach`, in any order, and ends where it returns false.
template <class Leaf>
HWY_INLINE void visit_within(const TriangleBlocks::Tree& tree, const Vec3& point, const Reach& reach,
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
        if (local.is_near()) {
            const F d;
            const VF most = hn::Set(d, box_limit(node, reach));
            unsigned within = 0;
            measure_children(node, local, [&](std::size_t lane, VF squares) HWY_ATTR {
                within |= lane_bits(d, hn::Le(squares, most)) << lane;
            });
            mask &= within;
        } else if (local.beyond(node.units, reach.at(node.units))) {
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

// Calls leaf(number) for leaves that may have something within `reach`, which it may lower, and ends where it returns false. Nearest
// child first.
template <class Leaf>
HWY_INLINE void visit_nearest(const TriangleBlocks::Tree& tree, const Vec3& point, const Reach& reach,
                              std::uint64_t& visits, const Leaf& leaf) {
    struct Step {
        OrderedChildren children;
        const BoxNode* node;
        std::uint32_t level, first;  // of the children
    };
    Step path[most_levels];
    std::size_t depth = 0;
    std::uint32_t level = static_cast<std::uint32_t>(tree.level_begin.size()), index = 0;
    const auto limit = [&](const Step& step) { return box_limit(*step.node, reach); };
    const auto beyond = [&](const Step& step, std::int32_t key) {
        return (key & ~OrderedChildren::child_bits) > std::bit_cast<std::int32_t>(limit(step));
    };
    while (true) {
        const BoxNode& node = tree.nodes[tree.level_begin[level - 1] + index];
        visits += static_cast<std::uint64_t>(node.count);
        const LocalPoint local(node.units, point);
        Step* step = path + depth++;
        std::int32_t next = OrderedChildren::none;
        if (HWY_LIKELY(local.is_near())) {
            next = step->children.set(node, local);
        } else if (!local.beyond(node.units, reach.at(node.units))) {
            next = step->children.set_unknown(node.count);
        }
        step->node = &node;
        step->level = level - 1;
        step->first = static_cast<std::uint32_t>(index * frames_width);
        if (step->level == 0) {
            // The nearest leaf, and then the others as they come: none has to wait for another then.
            if (!beyond(*step, next)) {
                const auto nearest = static_cast<unsigned>(next & OrderedChildren::child_bits);
                if (!leaf(std::size_t{step->first + nearest})) return;
                for (unsigned mask = step->children.within(limit(*step)) & ~(1U << nearest); mask != 0;
                     mask &= mask - 1) {
                    const auto c = static_cast<std::uint32_t>(std::countr_zero(mask));
                    if (beyond(*step, step->children.key[c])) continue;
                    if (!leaf(std::size_t{step->first + c})) return;
                }
            }
            if (--depth == 0) return;
            next = (--step)->children.least();
        }
        while (beyond(*step, next)) {
            if (--depth == 0) return;
            next = (--step)->children.least();
        }
        step->children.remove(next);
        index = step->first + static_cast<std::uint32_t>(next & OrderedChildren::child_bits);
        level = step->level;
    }
}

// The exact distance of a triangle is at most its computed one, times 1 + 4u, and this part of M, the largest |coordinate| of it and the
// point. Limits of boxes and leaves, and `beyond`, have room for the factor.
constexpr double computed_rounding = 8 * unit_roundoff;

// The search for one closest point. Nothing whose computed distance is within the reach is ever left out, but triangles are measured in
// double precision only once most of those that frames cannot tell from the nearest are known.
class ClosestSearch {
public:
    HWY_INLINE ClosestSearch(const TriangleBlocks::Tree& tree, const Vec3& point, double early_out, ClosestPoint& best,
                             Counters& counters)
        : tree_(tree),
          point_(point),
          early_out_(early_out),
          best_(best),
          counters_(counters),
          reach_{std::sqrt(best.squared_distance), computed_rounding, point.cwiseAbs().maxCoeff()} {}

    // Frames shorten the reach by what is certain of exact distances. That the computed distance of a nearest triangle is no larger than
    // that is so in practice, and not proven; so it is looked at, and what was left out is searched where it is larger.
    HWY_INLINE void run() {
        walk<true>();
        if (done_) return;
        const double needed = std::sqrt(best_.squared_distance);
        if (HWY_LIKELY(needed <= reach_.distance)) return;
        reach_.distance = needed;
        walk<false>();
    }

private:
    // A leaf that was looked at. Which of its triangles matter is settled once the reach is short: no branch depends on them before.
    struct Seen {
        alignas(64) float squared[frames_width];
        const TriangleFramesLeaf* leaf;
        double error;
    };
    static constexpr std::size_t most_seen = 24;

    template <bool by_frames> HWY_INLINE void walk() {
        visit_nearest(tree_, point_, reach_, counters_.node_visits, [&](std::size_t number) HWY_ATTR {
            look_at<by_frames>(tree_.leaves[number]);
            return !done_;
        });
        if (!done_) measure();
    }

    template <bool by_frames> HWY_INLINE void look_at(const TriangleFramesLeaf& leaf) {
        const LocalPoint local(leaf.units, point_);
        Seen& seen = seen_[leaves_++];
        seen.leaf = &leaf;
        seen.error = leaf_error(local);
        if (HWY_UNLIKELY(!local.is_near())) {
            if (local.beyond(leaf.units, reach_.at(leaf.units))) {
                --leaves_;
                return;
            }
            std::fill(seen.squared, seen.squared + frames_width, 0.0F);
            measure();
            return;
        }
        leaf_squares(leaf, local, seen.squared);
        if constexpr (by_frames) {
            const double nearest = std::sqrt(static_cast<double>(least_of(seen.squared))) * (1 + 0x1p-50);
            const double most = (nearest + seen.error) * leaf.units.unit;
            const double rounding =
                2 * computed_rounding * (most + std::max(leaf.units.magnitude, reach_.point_magnitude));
            reach_.distance = std::min(reach_.distance, most + rounding);
        }
        if (!by_frames || leaves_ == most_seen || reach_.distance * reach_.distance <= early_out_) measure();
    }

    // What the reach leaves of the triangles seen.
    void measure() {
        std::size_t count = 0;
        for (const Seen& seen : std::span(seen_, leaves_)) {
            const float most = leaf_limit(*seen.leaf, seen.error, reach_);
            for (unsigned mask = squares_within(seen.squared, most) & in_use(seen.leaf->count); mask != 0;
                 mask &= mask - 1)
                candidate_[count++] = seen.leaf->triangle[std::countr_zero(mask)];
        }
        leaves_ = 0;
        counters_.point_triangle_distances += count;
        offer_triangles(point_, tree_.mesh, candidate_, count, best_);
        done_ = best_.triangle >= 0 && best_.squared_distance <= early_out_;
        reach_.distance = std::min(reach_.distance, std::sqrt(best_.squared_distance));
    }

    const TriangleBlocks::Tree& tree_;
    const Vec3& point_;
    double early_out_;
    ClosestPoint& best_;
    Counters& counters_;
    Reach reach_;
    bool done_ = false;
    std::size_t leaves_ = 0;
    Seen seen_[most_seen];
    Index candidate_[most_seen * frames_width];
};

void blocks_closest(const TriangleBlocks::Tree& tree, const Vec3& point, double early_out, ClosestPoint& best,
                    Counters& counters) {
    ClosestSearch(tree, point, early_out, best, counters).run();
}

// The triangles of a leaf that may be within `reach`.
HWY_INLINE unsigned leaf_within(const TriangleFramesLeaf& leaf, const Vec3& point, const Reach& reach) {
    const LocalPoint local(leaf.units, point);
    if (HWY_UNLIKELY(!local.is_near())) return local.beyond(leaf.units, reach.at(leaf.units)) ? 0 : in_use(leaf.count);
    alignas(64) float squared[frames_width];
    leaf_squares(leaf, local, squared);
    return squares_within(squared, leaf_limit(leaf, leaf_error(local), reach)) & in_use(leaf.count);
}

void blocks_certify(const TriangleBlocks::Tree& tree, const Vec3& point, double nearest, double& least,
                    Counters& counters) {
    const Reach reach{std::sqrt(nearest)};
    visit_within(tree, point, reach, counters.node_visits, [&](std::size_t number) HWY_ATTR {
        const TriangleFramesLeaf& leaf = tree.leaves[number];
        for (unsigned mask = leaf_within(leaf, point, reach); mask != 0; mask &= mask - 1)
            certify(point, triangle_of(tree.mesh, leaf.triangle[std::countr_zero(mask)]), nearest, least, counters);
        return true;
    });
}

// Copies the triangles of a leaf that `mask` names, moved to the place of `near`.
HWY_INLINE void append_lanes(const TriangleFramesLeaf& leaf, unsigned mask, NearTriangles<float>& near) {
    const F d;
    near.make_room(frames_width);
    const auto ratio_of = static_cast<float>(leaf.units.unit * near.units.inverse);
    float move[3];
    double away = 0;
    for (int k = 0; k < 3; ++k) {
        const double delta = (leaf.units.origin[k] - near.units.origin[k]) * near.units.inverse;
        move[k] = static_cast<float>(delta);
        away += delta * delta;
    }
    const VF ratio = hn::Set(d, ratio_of), moved = hn::Set(d, limit_of(0.15 * (std::sqrt(away) + 2.0 * ratio_of)));
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d)) {
        const unsigned lanes = mask >> lane & ((1U << hn::Lanes(d)) - 1);
        if (lanes == 0) continue;
        const std::uint8_t bits[8] = {static_cast<std::uint8_t>(lanes), static_cast<std::uint8_t>(lanes >> 8)};
        const auto chosen = hn::LoadMaskBits(d, bits);
        const std::size_t to = near.count();
        const auto load = [&](std::size_t i) HWY_ATTR { return hn::Load(d, leaf.frames.row[i] + lane); };
        const auto put = [&](std::size_t i, VF value)
                             HWY_ATTR { hn::CompressStore(value, chosen, d, near.row(i) + to); };
        VF squares = hn::Zero(d);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            VF shift = hn::Mul(load(frame_row::shift + axis), ratio);
            for (std::size_t k = 0; k < 3; ++k) {
                const VF along = load(3 * axis + k);
                put(3 * axis + k, along);
                shift = hn::Sub(shift, hn::Mul(along, hn::Set(d, move[k])));
            }
            put(frame_row::shift + axis, shift);
            squares = hn::Add(squares, hn::Mul(shift, shift));
        }
        // 0.8 R and what makes up for rounding here (near_error).
        const VF corner = hn::Add(hn::Sqrt(squares), hn::Mul(load(frame_row::length), ratio));
        put(frame_row::count, hn::Add(hn::Mul(corner, hn::Set(d, 0.8001F)), moved));
        for (const std::size_t i : {frame_row::length, frame_row::ac_length, frame_row::bc_length})
            put(i, hn::Mul(load(i), ratio));
        for (const std::size_t i : {frame_row::ac, frame_row::ac + 1, frame_row::bc, frame_row::bc + 1})
            put(i, load(i));
        for (unsigned rest = lanes; rest != 0; rest &= rest - 1)
            near.triangle.push_back(leaf.triangle[lane + static_cast<std::size_t>(std::countr_zero(rest))]);
    }
}

void blocks_gather(const TriangleBlocks::Tree& tree, const Vec3& centre, double radius, NearTriangles<float>& near,
                   Counters& counters) {
    const Reach reach{radius};
    visit_within(tree, centre, reach, counters.node_visits, [&](std::size_t number) HWY_ATTR {
        const TriangleFramesLeaf& leaf = tree.leaves[number];
        counters.point_triangle_distances += static_cast<std::uint64_t>(leaf.count);
        if (const unsigned mask = leaf_within(leaf, centre, reach); mask != 0) append_lanes(leaf, mask, near);
        return near.count() <= near.most;
    });
}

}  // namespace
}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench {

HWY_EXPORT(blocks_closest);
HWY_EXPORT(blocks_certify);
HWY_EXPORT(blocks_gather);

ClosestPoint TriangleBlocks::closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const {
    ++counters.closest_point_queries;
    ClosestPoint best;
    best.squared_distance = hints.squared_radius;
    if (hints.warm_triangle >= 0) {
        ++counters.point_triangle_distances;
        offer(best, closest_point(point, triangle_of(*mesh_, hints.warm_triangle)), hints.warm_triangle);
        if (best.triangle >= 0 && best.squared_distance <= hints.early_out_squared) return best;
    }
    HWY_DYNAMIC_DISPATCH(blocks_closest)(tree(), point, hints.early_out_squared, best, counters);
    return best;
}

double TriangleBlocks::certified_distance(const Vec3& point, Counters& counters) const {
    const double nearest = closest(point, {}, counters).squared_distance;
    double least = distance_at_least(nearest, true);
    HWY_DYNAMIC_DISPATCH(blocks_certify)(tree(), point, nearest, least, counters);
    return least;
}

void TriangleBlocks::gather(const Vec3& centre, double radius, NearTriangles<float>& near, Counters& counters) const {
    HWY_DYNAMIC_DISPATCH(blocks_gather)(tree(), centre, radius, near, counters);
}

}  // namespace hausbench
#endif
