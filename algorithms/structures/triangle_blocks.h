// Triangles along a Hilbert curve, sixteen per leaf, under an implicit tree of boxes with sixteen children per
// node.
//
// Quick to build (a radix sort, then one pass) and quick to search: a leaf keeps its triangles as frames in single
// precision (kernel/triangle_frames.h), in its own coordinates. Frames only filter. The triangles that pass are
// measured in double precision, so answers have the same bits as a plain scan (kernel/closest.h).
//
// Each leaf and each node has an origin and a unit, a power of two, in which the coordinates of its content are at
// most 1. So precision follows the content: one stray triangle far away makes the boxes beside it coarse, but none
// of the boxes below them. A run of triangles that mixes scales is cut into leaves of one scale each.
//
// The filter loses nothing. u = 2^-24, and errors of double precision are far below it.
//   - Boxes. A plane is at most 1: rounding it to float and moving it outward by plane_error costs u/2 + u. A
//     coordinate q of the point errs by u|q| when it is rounded. If |q| <= 4, all this is less than
//     8u = plane_error. If |q| > 4, the point is more than 3/4 |q| outside, and u|q| is less than 4/3 u of that. A
//     difference errs by u, a square by another u, and the sums by 2u: s <= d^2 (1 + 8u), and box_error is 16u. Far
//     away, where this error is as large as the content, boxes are measured in double precision.
//   - Leaves. |sqrt(s) - d| <= frame_error u (|q| + R) (kernel/triangle_frames.h), with |q| <= 2 max|q_k| and
//     R < 2.
//   - A triangle with computed squared distance f (kernel/point_triangle.h) is within sqrt(f) (1 + 4u) + 8uM of the
//     point, where u = 2^-53 and M is the largest |coordinate| of the triangle and the point (kernel/rounding.h).
#pragma once

#include "algorithms/kernel/closest.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/kernel/triangle_frames.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace hausbench {

// Coordinates relative to `origin`, in units of a power of two.
struct LocalUnits {
    double origin[3];
    double unit, inverse;
    double magnitude;  // no |coordinate| of the content is larger

    // Sets them for the content of a box, which then lies in [-1, 1]. The unit is at least `least`, so that a
    // single point has one, too.
    void set(const Box& box, double least);
};

struct alignas(64) TriangleFramesLeaf {
    TriangleFrames<float> frames;  // unused lanes repeat the last one in use
    LocalUnits units;
    Index triangle[frames_width];
    std::int32_t count;
};

struct alignas(64) BoxNode {
    float low[3][frames_width], high[3][frames_width];  // unused lanes are infinitely far from everything
    LocalUnits units;
    std::int32_t count;
};

// The planes of a node are farther out by plane_error, and squares may be too large by a factor of 1 + box_error.
inline constexpr float plane_error = 0x1p-21F;
inline constexpr double box_error = 0x1p-20;

// Triangles near a place, for callers that measure many points there, as frames in the coordinates of the place.
// There are at most `most_triangles`.
template <class T> class NearTriangles {
public:
    static constexpr std::size_t most_triangles = 256;

    LocalUnits units;
    std::vector<Index> triangle;
    // Gathering stops once there are more than this; must not exceed the default.
    std::size_t most = most_triangles - frames_width;

    void clear(const LocalUnits& place) {
        units = place;
        triangle.clear();
    }
    std::size_t count() const { return triangle.size(); }

    // Returns row i: the rows of TriangleFrames, then one more for the error (see near_error). The values behind
    // the last triangle, up to a multiple of frames_width, are finite.
    T* row(std::size_t i) { return rows_.data() + i * stride; }
    const T* row(std::size_t i) const { return rows_.data() + i * stride; }

    // The distance between rows, in numbers. It is a constant for the compiler, with room for a vector that is
    // stored behind the last triangle.
    static constexpr std::size_t stride = most_triangles + frames_width;

private:
    std::vector<T> rows_ = std::vector<T>((frame_row::count + 1) * stride);
};

inline constexpr std::size_t near_rows = frame_row::count + 1;
// Like frame_error, for frames that were moved to another place: no distance errs by more than near_error u
// (|p| + the last row).
//
// Let W be the distance of the place from the origin of the leaf plus twice the leaf's unit, so W is at least the
// shift there. Moving costs, in each coordinate, u W each for rounding an axis, the way and the shift, and 3u W for
// products and sums: sqrt(3) 6u W < 11u W. The rest errs as described in kernel/triangle_frames.h, where
// R <= |a| + L is the R of the triangle itself: 64u (|p| + R) + 12u W <= 80u (|p| + 0.8 R + 0.15 W). Frames made at
// the place have R as their last row. The proof needs 0.8 R beside 0.15 W, but no test can, because frames err by
// far less than 64u (|p| + R) on every known input.
template <class T> inline constexpr double near_error = frame_error<T> + 16;

class TriangleBlocks {
public:
    static constexpr std::string_view structure_name = "triangle blocks";
    static constexpr int structure_layout = 1;

    // `mesh` must outlive this. O(n) for tame data (see kernel/morton.h); about 87 bytes per triangle. The result
    // is the same for any number of threads.
    explicit TriangleBlocks(const TriangleMesh& mesh, const Threads& threads = Threads());

    // Returns the same bits as closest_by_scan (kernel/closest.h), with the same hints. O(log n) on well-behaved
    // meshes.
    ClosestPoint closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // Returns a lower bound of the exact distance; valid under rounding and not less than
    // certified_distance_by_scan.
    double certified_distance(const Vec3& point, Counters& counters) const;

    // Appends all triangles within `radius` of `centre`, and perhaps some slightly farther ones. It stops early
    // once there are more than near.most.
    void gather(const Vec3& centre, double radius, NearTriangles<float>& near, Counters& counters) const;

    const TriangleMesh& mesh() const { return *mesh_; }
    const std::vector<TriangleFramesLeaf>& leaves() const { return leaves_; }
    std::size_t bytes() const;

    // For the walks in triangle_blocks_search.cpp.
    struct Tree {
        const std::vector<TriangleFramesLeaf>& leaves;
        const std::vector<BoxNode>& nodes;
        // The begin of each level in `nodes`: level 1 has the boxes of the leaves, the last level is one node.
        const std::vector<std::size_t>& level_begin;
        const TriangleMesh& mesh;
    };

private:
    Tree tree() const { return {leaves_, nodes_, level_begin_, *mesh_}; }
    void add_level(const std::vector<Box>& below, std::vector<Box>& boxes, double least_unit);

    const TriangleMesh* mesh_;
    std::vector<TriangleFramesLeaf> leaves_;
    std::vector<BoxNode> nodes_;
    std::vector<std::size_t> level_begin_;
};

// Sets `near` to all triangles of a list, in frames of double precision.
void set_frames(const TriangleMesh& mesh, const std::vector<Index>& triangles, NearTriangles<double>& near);

// The triangles of a mesh, ordered by their centres along a Hilbert curve, so that neighbours in the order are
// neighbours in space.
struct TriangleOrder {
    static constexpr std::string_view structure_name = "triangle order";
    static constexpr int structure_layout = 1;

    // O(n) for tame data (see kernel/morton.h). The result is the same for any number of threads.
    explicit TriangleOrder(const TriangleMesh& mesh, const Threads& threads = Threads());

    std::vector<Index> order;

    std::size_t bytes() const { return order.capacity() * sizeof(Index); }
};

}  // namespace hausbench
