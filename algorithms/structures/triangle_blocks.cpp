#include "triangle_blocks.h"

#include "kernel/morton.h"
#include "kernel/rounding.h"

#include <algorithm>
#include <bit>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "structures/triangle_blocks.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include "kernel/triangle_frames-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {
namespace {

using F = FrameLanes<float>;
using VF = hn::Vec<F>;

// Farther from the origin of a leaf or node, in its units, squares might overflow, and there is no filter.
constexpr double farthest_filtered = 0x1p40;

// A point in the coordinates of a leaf or node.
struct LocalPoint {
    float at[3];
    double most;  // |coordinate|

    // Where it is too far for a filter: no part of the content, which is within sqrt(3) units of the origin, is nearer.
    HWY_INLINE bool beyond(const LocalUnits& units, double reach) const {
        return most < 0x1p900 && (most * (1 - 0x1p-50) - 2) * units.unit > reach;
    }

    HWY_INLINE LocalPoint(const LocalUnits& units, const Vec3& point) : most(0) {
        for (int k = 0; k < 3; ++k) {
            const double q = (point[k] - units.origin[k]) * units.inverse;
            at[k] = static_cast<float>(q);
            most = std::max(most, std::abs(q));
        }
    }
};

constexpr float infinite = std::numeric_limits<float>::infinity();
// Rounded to nearest; what is added makes up for that.
HWY_INLINE float float_above(double x) { return x < 0x1p126 ? static_cast<float>(x * (1 + 0x1p-22)) : infinite; }

// What is certainly at least so far away, in units, of the content of each child.
HWY_INLINE unsigned boxes_within(const BoxNode& node, const LocalPoint& point, double reach,
                                 float (&least)[frames_width]) {
    const F d;
    const VF slack = hn::Set(d, float_above(point.most * 0x1p-23)), keep = hn::Set(d, 1 - 0x1p-21F),
             most = hn::Set(d, float_above(reach));
    unsigned mask = 0;
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d)) {
        VF squares = hn::Zero(d);
        for (std::size_t k = 0; k < 3; ++k) {
            const VF q = hn::Set(d, point.at[k]);
            const VF out =
                hn::Max(hn::Sub(hn::Load(d, node.low[k] + lane), q), hn::Sub(q, hn::Load(d, node.high[k] + lane)));
            const VF outside = hn::Max(out, hn::Zero(d));
            squares = hn::Add(squares, hn::Mul(outside, outside));
        }
        const VF distance = hn::Sub(hn::Mul(hn::Sqrt(squares), keep), slack);
        hn::StoreU(distance, d, least + lane);
        mask |= mask_bits<float>(hn::Le(distance, most)) << lane;
    }
    return mask & ((1U << node.count) - 1);
}

// Squared distances to the triangles of a leaf.
HWY_INLINE void leaf_squares(const TriangleFramesLeaf& leaf, const LocalPoint& point, float (&squared)[frames_width]) {
    const F d;
    const VF x = hn::Set(d, point.at[0]), y = hn::Set(d, point.at[1]), z = hn::Set(d, point.at[2]);
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d)) {
        const auto row = [&](std::size_t i) HWY_ATTR { return hn::Load(d, leaf.frames.row[i] + lane); };
        hn::StoreU(squared_in_frames<float>(row, x, y, z), d, squared + lane);
    }
}

HWY_INLINE unsigned squares_within(const float (&squared)[frames_width], float most) {
    const F d;
    unsigned mask = 0;
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d))
        mask |= mask_bits<float>(hn::Le(hn::LoadU(d, squared + lane), hn::Set(d, most))) << lane;
    return mask;
}

// The square, in units of the leaf, that a triangle within `reach` (a length) has at most.
HWY_INLINE float leaf_limit(const TriangleFramesLeaf& leaf, const LocalPoint& point, double reach) {
    constexpr double error = frame_error<float> * frame_roundoff<float>;
    const double units = reach * leaf.units.inverse + error * (2 * point.most + 2) + frame_underflow<float>;
    return float_above(units * units);
}

// Calls leaf(number) for leaves that may have something within `reach`, which it may lower: near ones first, mostly.
template <class Leaf>
HWY_INLINE void visit_leaves(const TriangleBlocks::Tree& tree, const Vec3& point, const double& reach,
                             std::uint64_t& visits, const Leaf& leaf) {
    struct Entry {
        double least;
        std::uint32_t level, index;
    };
    Entry stack[(frames_width - 1) * 9 + 1];  // 16^9 leaves are more than an Index counts
    std::size_t size = 0;
    Entry at{0, static_cast<std::uint32_t>(tree.level_begin.size()), 0};
    while (true) {
        if (at.level == 0) {
            if (!leaf(std::size_t{at.index})) return;
        } else {
            const BoxNode& node = tree.nodes[tree.level_begin[at.level - 1] + at.index];
            visits += static_cast<std::uint64_t>(node.count);
            const LocalPoint local(node.units, point);
            float least[frames_width];
            unsigned mask = (1U << node.count) - 1;
            if (!(local.most < farthest_filtered) && local.beyond(node.units, reach)) {
                mask = 0;
            } else if (local.most < farthest_filtered) {
                mask = boxes_within(node, local, reach * node.units.inverse, least);
            } else {
                std::fill(least, least + frames_width, 0.0F);
            }
            const std::size_t base = size;
            for (; mask != 0; mask &= mask - 1) {
                const auto c = static_cast<std::size_t>(std::countr_zero(mask));
                const Entry entry{least[c] * node.units.unit, at.level - 1,
                                  static_cast<std::uint32_t>(at.index * frames_width + c)};
                std::size_t place = size++;
                for (; place > base && stack[place - 1].least < entry.least; --place) stack[place] = stack[place - 1];
                stack[place] = entry;
            }
        }
        do {
            if (size == 0) return;
            at = stack[--size];
        } while (at.least > reach);
    }
}

HWY_INLINE double reach_of(double squared, double magnitude) {
    return std::sqrt(squared) * (1 + 8 * unit_roundoff) + 16 * unit_roundoff * magnitude;
}

void blocks_closest(const TriangleBlocks::Tree& tree, const Vec3& point, double early_out, ClosestPoint& best,
                    Counters& counters) {
    const double magnitude = std::max(tree.magnitude, point.cwiseAbs().maxCoeff());
    double reach = reach_of(best.squared_distance, magnitude);
    const auto measure = [&](Index triangle) {
        ++counters.point_triangle_distances;
        offer(best, closest_point(point, triangle_of(tree.mesh, triangle)), triangle);
        reach = reach_of(best.squared_distance, magnitude);
    };
    const auto done = [&] { return best.triangle >= 0 && best.squared_distance <= early_out; };
    visit_leaves(tree, point, reach, counters.node_visits, [&](std::size_t number) HWY_ATTR {
        const TriangleFramesLeaf& leaf = tree.leaves[number];
        const LocalPoint local(leaf.units, point);
        const unsigned all = (1U << leaf.count) - 1;
        if (!(local.most < farthest_filtered)) {
            if (local.beyond(leaf.units, reach)) return true;
            for (unsigned mask = all; mask != 0 && !done(); mask &= mask - 1)
                measure(leaf.triangle[std::countr_zero(mask)]);
            return !done();
        }
        float squared[frames_width];
        leaf_squares(leaf, local, squared);
        unsigned mask = squares_within(squared, leaf_limit(leaf, local, reach)) & all;
        if (mask == 0) return true;
        // The nearest first, so that few others are left.
        std::size_t nearest = static_cast<std::size_t>(std::countr_zero(mask));
        for (unsigned rest = mask & (mask - 1); rest != 0; rest &= rest - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(rest));
            if (squared[i] < squared[nearest]) nearest = i;
        }
        measure(leaf.triangle[nearest]);
        mask &= ~(1U << nearest);
        if (mask != 0) mask &= squares_within(squared, leaf_limit(leaf, local, reach));
        for (; mask != 0 && !done(); mask &= mask - 1) measure(leaf.triangle[std::countr_zero(mask)]);
        return !done();
    });
}

void blocks_certify(const TriangleBlocks::Tree& tree, const Vec3& point, double nearest, double& least,
                    Counters& counters) {
    const double reach = reach_of(nearest, std::max(tree.magnitude, point.cwiseAbs().maxCoeff()));
    visit_leaves(tree, point, reach, counters.node_visits, [&](std::size_t number) HWY_ATTR {
        const TriangleFramesLeaf& leaf = tree.leaves[number];
        const LocalPoint local(leaf.units, point);
        unsigned mask = (1U << leaf.count) - 1;
        if (local.most < farthest_filtered) {
            float squared[frames_width];
            leaf_squares(leaf, local, squared);
            mask &= squares_within(squared, leaf_limit(leaf, local, reach));
        } else if (local.beyond(leaf.units, reach)) {
            return true;
        }
        for (; mask != 0; mask &= mask - 1)
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
    const VF ratio = hn::Set(d, ratio_of), moved = hn::Set(d, float_above(0.15 * (std::sqrt(away) + 2.0 * ratio_of)));
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
        // 0.8 R and what makes up for rounding here.
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
    visit_leaves(tree, centre, radius, counters.node_visits, [&](std::size_t number) HWY_ATTR {
        const TriangleFramesLeaf& leaf = tree.leaves[number];
        const LocalPoint local(leaf.units, centre);
        unsigned mask = (1U << leaf.count) - 1;
        if (local.most < farthest_filtered) {
            float squared[frames_width];
            leaf_squares(leaf, local, squared);
            counters.point_triangle_distances += static_cast<std::uint64_t>(leaf.count);
            mask &= squares_within(squared, leaf_limit(leaf, local, radius));
        } else if (local.beyond(leaf.units, radius)) {
            return true;
        }
        if (mask != 0) append_lanes(leaf, mask, near);
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

namespace {

// Where the largest |coordinate| of the mesh is M, no unit is smaller than this part of it.
constexpr double least_unit_of_magnitude = 0x1p-100;

}  // namespace

void LocalUnits::set(const Box& box, double least) {
    double half = least;
    for (int k = 0; k < 3; ++k) {
        origin[k] = 0.5 * (box.low[k] + box.high[k]);
        half = std::max({half, box.high[k] - origin[k], origin[k] - box.low[k]});
    }
    // The power of two above it: the exponent and one more.
    const std::uint64_t exponent = (std::bit_cast<std::uint64_t>(half) >> 52) + 1;
    unit = std::bit_cast<double>(exponent << 52);
    inverse = std::bit_cast<double>((2046 - exponent) << 52);
}

template <class T> void NearTriangles<T>::make_room(std::size_t more) {
    const std::size_t wanted = count() + more + frames_width;
    if (wanted <= stride) return;
    const std::size_t larger = (2 * wanted + frames_width - 1) / frames_width * frames_width;
    std::vector<T> copy(near_rows * larger);
    for (std::size_t i = 0; i < near_rows && stride > 0; ++i) std::copy_n(row(i), count(), copy.data() + i * larger);
    rows = std::move(copy);
    stride = larger;
}
template void NearTriangles<float>::make_room(std::size_t);
template void NearTriangles<double>::make_room(std::size_t);

TriangleOrder::TriangleOrder(const TriangleMesh& mesh) {
    Points centres(mesh.triangles.rows(), 3);
    Box box;
    for (Index i = 0; i < mesh.triangles.rows(); ++i) {
        const Triangle t = triangle_of(mesh, i);
        const Vec3 centre = (t.a + t.b + t.c) / 3;
        centres.row(i) = centre;
        box.add(centre);
    }
    order = morton_order(centres, nullptr, MortonFrame(box));
}

TriangleBlocks::TriangleBlocks(const TriangleMesh& mesh) : mesh_(&mesh) {
    const std::vector<Index> order = TriangleOrder(mesh).order;
    for (Index v = 0; v < mesh.vertices.rows(); ++v)
        magnitude_ = std::max(magnitude_, mesh.vertices.row(v).cwiseAbs().maxCoeff());
    const double least_unit = std::max(magnitude_ * least_unit_of_magnitude, 0x1p-900);
    leaves_.resize((order.size() + frames_width - 1) / frames_width);
    std::vector<Box> boxes(leaves_.size()), below;
    for (std::size_t l = 0; l < leaves_.size(); ++l) {
        TriangleFramesLeaf& leaf = leaves_[l];
        const std::size_t begin = l * frames_width;
        leaf.count = static_cast<std::int32_t>(std::min(frames_width, order.size() - begin));
        for (std::size_t i = 0; i < frames_width; ++i) {
            leaf.triangle[i] = order[std::min(begin + i, order.size() - 1)];
            boxes[l].add(box_of(triangle_of(mesh, leaf.triangle[i])));
        }
        leaf.units.set(boxes[l], least_unit);
        CornerRows corners;
        for (std::size_t i = 0; i < frames_width; ++i) {
            const Triangle t = triangle_of(mesh, leaf.triangle[i]);
            const Vec3* const of[3] = {&t.a, &t.b, &t.c};
            for (std::size_t v = 0; v < 3; ++v)
                for (std::size_t k = 0; k < 3; ++k)
                    corners.row[3 * v + k][i] =
                        ((*of[v])[static_cast<Index>(k)] - leaf.units.origin[k]) * leaf.units.inverse;
        }
        make_frames(corners, leaf.frames);
    }
    do {
        below.swap(boxes);
        add_level(below, boxes, least_unit);
    } while (boxes.size() > 1);
}

// Planes are moved outward by 2^-23, which is more than rounding them to float, twice, takes: they are at most 1.
void TriangleBlocks::add_level(const std::vector<Box>& below, std::vector<Box>& boxes, double least_unit) {
    level_begin_.push_back(nodes_.size());
    const std::size_t count = (below.size() + frames_width - 1) / frames_width;
    boxes.assign(count, Box());
    for (std::size_t n = 0; n < count; ++n) {
        BoxNode& node = nodes_.emplace_back();
        const std::size_t begin = n * frames_width, end = std::min(begin + frames_width, below.size());
        node.count = static_cast<std::int32_t>(end - begin);
        for (std::size_t c = begin; c < end; ++c) boxes[n].add(below[c]);
        node.units.set(boxes[n], least_unit);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto local = [&](double x) {
                return static_cast<float>((x - node.units.origin[k]) * node.units.inverse);
            };
            for (std::size_t c = 0; c < frames_width; ++c) {
                const bool used = begin + c < end;
                const auto axis = static_cast<Index>(k);
                node.low[k][c] =
                    used ? local(below[begin + c].low[axis]) - 0x1p-23F : std::numeric_limits<float>::infinity();
                node.high[k][c] =
                    used ? local(below[begin + c].high[axis]) + 0x1p-23F : -std::numeric_limits<float>::infinity();
            }
        }
    }
}

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

namespace {

// Of triangles begin to end - 1 of the list, in coordinates of the place; what is not in use is as the last.
template <class T>
void frames_of(const TriangleMesh& mesh, const std::vector<Index>& triangles, std::size_t begin, std::size_t end,
               const LocalUnits& units, TriangleFrames<T>& frames, double (&size)[frames_width]) {
    CornerRows corners;
    for (std::size_t i = 0; i < frames_width; ++i) {
        const Triangle t = triangle_of(mesh, triangles[std::min(begin + i, end - 1)]);
        const Vec3* const of[3] = {&t.a, &t.b, &t.c};
        size[i] = 0;
        for (std::size_t v = 0; v < 3; ++v) {
            Vec3 local;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto axis = static_cast<Index>(k);
                corners.row[3 * v + k][i] = local[axis] = ((*of[v])[axis] - units.origin[k]) * units.inverse;
            }
            size[i] = std::max(size[i], local.norm());
        }
    }
    make_frames(corners, frames);
}

template <class T>
void copy_frames(const TriangleFrames<T>& frames, const double (&size)[frames_width], std::size_t to,
                 NearTriangles<T>& near) {
    for (std::size_t i = 0; i < frame_row::count; ++i) std::copy_n(frames.row[i], frames_width, near.row(i) + to);
    for (std::size_t i = 0; i < frames_width; ++i)
        near.row(frame_row::count)[to + i] = static_cast<T>(size[i] * (1 + 0x1p-20));
}

}  // namespace

void TriangleBlocks::append(Index triangle, NearTriangles<float>& near) const {
    near.make_room(frames_width);
    TriangleFrames<float> frames;
    double size[frames_width];
    const std::size_t to = near.count();
    near.triangle.push_back(triangle);
    frames_of(*mesh_, near.triangle, to, to + 1, near.units, frames, size);
    copy_frames(frames, size, to, near);
}

void set_frames(const TriangleMesh& mesh, const std::vector<Index>& triangles, NearTriangles<double>& near) {
    near.triangle.clear();
    near.make_room(triangles.size() + frames_width);
    near.triangle = triangles;
    for (std::size_t begin = 0; begin < triangles.size(); begin += frames_width) {
        TriangleFrames<double> frames;
        double size[frames_width];
        frames_of(mesh, triangles, begin, std::min(begin + frames_width, triangles.size()), near.units, frames, size);
        copy_frames(frames, size, begin, near);
    }
}

std::size_t TriangleBlocks::bytes() const {
    return leaves_.capacity() * sizeof(TriangleFramesLeaf) + nodes_.capacity() * sizeof(BoxNode) +
           level_begin_.capacity() * sizeof(std::size_t);
}

}  // namespace hausbench
#endif
