#include "algorithms/kernel/rounding.h"
#include "algorithms/structures/triangle_blocks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/structures/triangle_blocks_search.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include "algorithms/structures/nearest-inl.h"
#include "algorithms/structures/triangle_blocks_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {
namespace {

// The search for one closest point. Visits leaves, nearest first, and lowers the search radius by fast distances in
// single precision. Double precision comes later, for several leaves at once: then the radius is short, so few
// triangles remain. Never skips a triangle whose distance in double precision is within the radius.
class ClosestSearch {
public:
    HWY_INLINE ClosestSearch(const TriangleBlocks::Tree& tree, const Vec3& point, double early_out, ClosestPoint& best,
                             Counters& counters)
        : tree_(tree),
          point_(point),
          early_out_(early_out),
          best_(best),
          counters_(counters),
          radius_(std::sqrt(best.squared_distance), point) {}

    // The first walk lowers the radius in single precision, to an upper bound on the exact distance. If the mesh is far
    // from the origin compared with its size, rounding may make the computed distance of the nearest triangle larger
    // than this bound, so the walk may skip triangles in between. A second walk looks for them, with the computed
    // distance as the radius. No test can show that it is needed: on every known input it finds no other triangle,
    // because computed distances are closer to exact ones than is proven.
    HWY_INLINE void run() {
        walk<true>();
        if (done_) return;
        const double needed = std::sqrt(best_.squared_distance);
        if (HWY_LIKELY(needed <= radius_.distance)) return;
        radius_.distance = needed;
        walk<false>();
    }

private:
    // A visited leaf whose triangles still need distances in double precision. measure() chooses among them later, when
    // the radius is short. This avoids unpredictable branches on single triangles.
    struct Seen {
        alignas(64) float squared[frames_width];  // squared distances by frames, in units of the leaf
        const TriangleFramesLeaf* leaf;
        double error;  // of these distances, see leaf_error()
    };
    static constexpr std::size_t most_seen = 24;

    template <bool by_frames> HWY_INLINE void walk() {
        visit_nearest(tree_, point_, radius_, counters_.node_visits, [&](std::size_t number) HWY_ATTR {
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
            if (local.beyond(leaf.units, radius_.at(leaf.units))) {
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
            radius_.distance = std::min(radius_.distance, (nearest + seen.error) * leaf.units.unit);
        }
        if (!by_frames || leaves_ == most_seen || radius_.distance * radius_.distance <= early_out_) measure();
    }

    // Computes distances in double precision for the triangles in `seen_` that may still be within the radius. Updates
    // `best_` and the radius, and empties `seen_`.
    void measure() {
        std::size_t count = 0;
        for (const Seen& seen : std::span(seen_, leaves_)) {
            const float most = leaf_limit(*seen.leaf, seen.error, radius_);
            for (unsigned mask = squares_within(seen.squared, most) & in_use(seen.leaf->count); mask != 0;
                 mask &= mask - 1)
                candidate_[count++] = seen.leaf->triangle[std::countr_zero(mask)];
        }
        leaves_ = 0;
        counters_.point_triangle_distances += count;
        offer_triangles(point_, tree_.mesh, candidate_, count, best_);
        done_ = best_.triangle >= 0 && best_.squared_distance <= early_out_;
        radius_.distance = std::min(radius_.distance, std::sqrt(best_.squared_distance));
    }

    const TriangleBlocks::Tree& tree_;
    const Vec3& point_;
    double early_out_;
    ClosestPoint& best_;
    Counters& counters_;
    SearchRadius radius_;
    bool done_ = false;
    std::size_t leaves_ = 0;
    Seen seen_[most_seen];
    Index candidate_[most_seen * frames_width];
};

void blocks_closest(const TriangleBlocks::Tree& tree, const Vec3& point, double early_out, ClosestPoint& best,
                    Counters& counters) {
    ClosestSearch(tree, point, early_out, best, counters).run();
}

// Vectors of up to sixteen lanes, for functions that visit leaves in any order. ClosestSearch uses at most eight,
// because it must wait for each result before it chooses the next leaf, and wider vectors take longer.
using Wide = FrameLanes<float>;

// Returns a mask of the triangles of a leaf that may be within `radius` of the point.
HWY_INLINE unsigned leaf_within(const TriangleFramesLeaf& leaf, const Vec3& point, const SearchRadius& radius) {
    const LocalPoint local(leaf.units, point);
    if (HWY_UNLIKELY(!local.is_near())) return local.beyond(leaf.units, radius.at(leaf.units)) ? 0 : in_use(leaf.count);
    const Wide d;
    const auto x = hn::Set(d, local.at[0]), y = hn::Set(d, local.at[1]), z = hn::Set(d, local.at[2]);
    const auto most = hn::Set(d, leaf_limit(leaf, leaf_error(local), radius));
    unsigned within = 0;
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d)) {
        const auto row = [&](std::size_t i) HWY_ATTR { return hn::Load(d, leaf.frames.row[i] + lane); };
        within |= lane_bits(d, hn::Le(squared_in_lanes(d, row, x, y, z), most)) << lane;
    }
    return within & in_use(leaf.count);
}

void blocks_certify(const TriangleBlocks::Tree& tree, const Vec3& point, double nearest, double& least,
                    Counters& counters) {
    const SearchRadius radius(std::sqrt(nearest), point);
    visit_within(tree, point, radius, counters.node_visits, [&](std::size_t number) HWY_ATTR {
        const TriangleFramesLeaf& leaf = tree.leaves[number];
        for (unsigned mask = leaf_within(leaf, point, radius); mask != 0; mask &= mask - 1)
            certify(point, triangle_of(tree.mesh, leaf.triangle[std::countr_zero(mask)]), nearest, least, counters);
        return true;
    });
}

// Appends the triangles of a leaf that are set in `mask` to `near`, with their frames converted to the local
// coordinates near.units.
HWY_INLINE void append_lanes(const TriangleFramesLeaf& leaf, unsigned mask, NearTriangles<float>& near) {
    const Wide d;
    const auto ratio_of = static_cast<float>(leaf.units.unit * near.units.inverse);
    float move[3];
    double away = 0;
    for (int k = 0; k < 3; ++k) {
        const double delta = (leaf.units.origin[k] - near.units.origin[k]) * near.units.inverse;
        move[k] = static_cast<float>(delta);
        away += delta * delta;
    }
    const auto ratio = hn::Set(d, ratio_of), moved = hn::Set(d, limit_of(0.15 * (std::sqrt(away) + 2.0 * ratio_of)));
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d)) {
        const unsigned lanes = mask >> lane & ((1U << hn::Lanes(d)) - 1);
        if (lanes == 0) continue;
        const std::uint8_t bits[8] = {static_cast<std::uint8_t>(lanes), static_cast<std::uint8_t>(lanes >> 8)};
        const auto chosen = hn::LoadMaskBits(d, bits);
        const std::size_t to = near.count();
        const auto load = [&](std::size_t i) HWY_ATTR { return hn::Load(d, leaf.frames.row[i] + lane); };
        const auto put = [&](std::size_t i, hn::Vec<Wide> value)
                             HWY_ATTR { hn::StoreU(hn::Compress(value, chosen), d, near.row(i) + to); };
        auto squares = hn::Zero(d);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            auto shift = hn::Mul(load(frame_row::shift + axis), ratio);
            for (std::size_t k = 0; k < 3; ++k) {
                const auto along = load(3 * axis + k);
                put(3 * axis + k, along);
                shift = hn::Sub(shift, hn::Mul(along, hn::Set(d, move[k])));
            }
            put(frame_row::shift + axis, shift);
            squares = hn::Add(squares, hn::Mul(shift, shift));
        }
        // The last row bounds the error of distances: 0.8 * R + 0.15 * W, as derived at near_error (triangle_blocks.h).
        // `corner` is an upper bound on R, the largest distance of a corner from the origin, and `moved` is 0.15 * W.
        // The factor 0.8001 instead of 0.8 absorbs rounding errors here.
        const auto corner = hn::Add(hn::Sqrt(squares), hn::Mul(load(frame_row::length), ratio));
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
    const SearchRadius around(radius, centre);
    visit_within(tree, centre, around, counters.node_visits, [&](std::size_t number) HWY_ATTR {
        const TriangleFramesLeaf& leaf = tree.leaves[number];
        counters.point_triangle_distances += static_cast<std::uint64_t>(leaf.count);
        if (const unsigned mask = leaf_within(leaf, centre, around); mask != 0) append_lanes(leaf, mask, near);
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
