// Triangles along a Hilbert curve, sixteen per leaf, under a tree of boxes with sixteen children per node. The tree is
// implicit: it has no pointers, because the index of a child follows from the index of its parent.
//
// It is quick to build: a radix sort, then one pass. It is quick to search because each leaf keeps a *frame* for each
// of its triangles, in single precision: a coordinate system with the triangle in its xy plane, in which a distance
// takes only products and sums (kernel/triangle_frames.h). Frames only filter: they reject triangles that are too far
// away. The distances to all others are computed in double precision, so answers have the same bits as a plain scan
// (kernel/closest.h).
//
// Each leaf and each node has *local coordinates*: an origin and a unit, which is a power of two, such that all
// coordinates of its *content* (the triangles in it or below it) are between -1 and 1. So the precision depends on the
// content: one stray triangle far away makes the other boxes in the same node coarse, but not the boxes in the nodes
// below them. A leaf that would mix triangles of very different scales is divided into several leaves.
//
// Proof that the filter never rejects a triangle that could be the closest. Everything is in local coordinates; u =
// 2^-24 is the unit roundoff of float, and the errors of double precision are far below it. Let s be a squared distance
// as computed in single precision, and d the exact distance.
//
//   - Boxes, near, absolute errors. The |coordinate| of a box side is at most 1. Rounding it to float costs u/2; moving
//     it outward by plane_error = 8u and rounding again costs u. Rounding a coordinate q of the point costs u|q|. If
//     |q| <= 4, this is at most 5.5u in total, so the content is still inside. If |q| > 4, the 8u cover the errors of
//     the side, and the point is more than (3/4)|q| outside: then u|q| is a relative error of less than (4/3)u in the
//     distance along this axis.
//   - Boxes, near, relative errors. To these (4/3)u, the difference of coordinates adds u. Squaring doubles both and
//     adds u, and two sums add 2u: (8/3)u + 2u + u + 2u < 8u. So s <= d^2 * (1 + 8u). The limit for s is enlarged by
//     box_error = 16u; the rest is slack.
//   - Boxes, far: these errors grow with |q|. Before they are as large as the content, distances to boxes are computed
//     in double precision instead (farthest_in_float in triangle_blocks_walk-inl.h).
//   - Triangles: |sqrt(s) - d| <= frame_error * u * (|q| + R), where q is the point and R the largest |corner|
//     (kernel/triangle_frames.h). Here |q| <= 2 max|q_k|, and R <= sqrt(3) < 2.
//   - The search radius is the computed distance of some triangle. A triangle with computed squared distance f
//     (kernel/point_triangle.h) has an exact distance of at most sqrt(f) * (1 + 4u) + 8uM, where now u = 2^-53 and M is
//     the largest |coordinate| of the triangle and the point (kernel/rounding.h). SearchRadius in
//     triangle_blocks_walk-inl.h enlarges the radius accordingly.
#pragma once

#include "algorithms/kernel/closest.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/kernel/triangle_frames.h"
#include "algorithms/kernel/watched.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace hausbench {

// Local coordinates: (x - origin) / unit, where `unit` is a power of two.
struct LocalUnits {
    double origin[3];
    double unit, inverse;  // inverse = 1 / unit
    double magnitude;      // upper bound on |x_k| over all x in the box given to set()

    // Sets origin and unit such that the local coordinates of the box are between -1 and 1. The unit is at least
    // `least`, so that it is positive even for a single point.
    void set(const Box& box, double least);
};

// A leaf of up to sixteen triangles, with their indices in the mesh. Each triangle is stored as a *frame*, a coordinate
// system that makes distances cheap (kernel/triangle_frames.h), in the local coordinates `units`.
struct alignas(64) TriangleFramesLeaf {
    TriangleFrames<float> frames;  // unused lanes repeat the last triangle
    LocalUnits units;
    Index triangle[frames_width];
    std::int32_t count;
};

// The boxes of up to sixteen children, in the local coordinates `units`.
struct alignas(64) BoxNode {
    float low[3][frames_width], high[3][frames_width];  // unused lanes are infinitely far from everything
    LocalUnits units;
    std::int32_t count;
};

// Allowances for rounding in single precision. Each box in a node is larger than its triangles by plane_error on each
// side. A computed squared distance to a box may be too large by a factor of 1 + box_error.
inline constexpr float plane_error = 0x1p-21F;
inline constexpr double box_error = 0x1p-20;

// The triangles near a region of space, at most `most_triangles`, for callers that compute the distances of many points
// in this region. Stored as frames (kernel/triangle_frames.h) in the local coordinates `units`.
template <class T> class NearTriangles {
public:
    static constexpr std::size_t most_triangles = 256;

    LocalUnits units;
    std::vector<Index> triangle;
    // TriangleBlocks::gather() stops once there are more triangles than this. Must not exceed the default, because the
    // last leaf may add up to frames_width triangles at once.
    std::size_t most = most_triangles - frames_width;

    // Removes all triangles. Triangles added later are stored in the local coordinates `place`.
    void clear(const LocalUnits& place) {
        units = place;
        triangle.clear();
    }
    std::size_t count() const { return triangle.size(); }

    // Returns row i, with one number per triangle. The first frame_row::count rows are the rows of TriangleFrames; the
    // last row bounds the errors of distances (near_error). Some finite numbers follow the last triangle, so that whole
    // vectors can be loaded.
    T* row(std::size_t i) { return rows_.data() + i * stride; }
    const T* row(std::size_t i) const { return rows_.data() + i * stride; }

    // The length of a row. It is constant, so that the compiler can compute addresses, and leaves room to store a whole
    // vector at the position of any triangle.
    static constexpr std::size_t stride = most_triangles + frames_width;

private:
    std::vector<T> rows_ = std::vector<T>((frame_row::count + 1) * stride);
};

inline constexpr std::size_t near_rows = frame_row::count + 1;
// The counterpart of frame_error for NearTriangles. gather() takes frames from leaves and converts them to other local
// coordinates, which costs precision. The distance from a point p to a triangle, as computed, is off by at most
//     near_error<T> * u * (|p| + E),
// where u is the unit roundoff of T, and E is the number of this triangle in the last row.
//
// Proof for T = float, in the new coordinates. Let W be the distance between the two origins plus twice the leaf's
// unit. Every corner in the leaf is within W of both origins, so no shift (frame_row::shift) is larger than W. In each
// coordinate, converting costs u * W for each of three roundings (of the axis, of the vector between the origins and
// of the shift) and 3u * W for the products and sums: 6u * W in total, and sqrt(3) * 6u * W < 11u * W in length. Apart
// from that, distances err by at most 64u * (|p| + R), as derived in kernel/triangle_frames.h, where R is the largest
// |corner| of this triangle. Together,
//     64u * (|p| + R) + 12u * W <= 80u * (|p| + 0.8 * R + 0.15 * W),
// so 16 more than frame_error and E = 0.8 * R + 0.15 * W are enough. The code uses |a| + L for R, which is at least as
// large: a is the origin of the frame, and L its longest edge. Frames that set_frames() makes in the new coordinates
// at once have E = R.
//
// The proof needs the term 0.8 * R in addition to 0.15 * W. No test can show this, because on every known input frames
// err by far less than 64u * (|p| + R).
template <class T>
inline const double near_error = WATCHED_ELSE("triangle blocks: frames that were moved", frame_error<T> + 16, 0.25);

class TriangleBlocks {
public:
    static constexpr std::string_view structure_name = "triangle blocks";
    static constexpr int structure_layout = 1;

    // `mesh` must outlive this object. O(n) time, unless the sizes of details differ by many orders of magnitude (see
    // morton_order in kernel/morton.h); about 87 bytes per triangle. The result is the same for any number of threads.
    explicit TriangleBlocks(const TriangleMesh& mesh, const Threads& threads = Threads());

    // Returns the same closest point, bit for bit, as closest_by_scan (kernel/closest.h). O(log n) on well-behaved
    // meshes.
    ClosestPoint closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // Returns a lower bound on the exact distance, valid under rounding and at least as large as the result of
    // certified_distance_by_scan (kernel/closest.h).
    double certified_distance(const Vec3& point, Counters& counters) const;

    // Appends to `near` all triangles within `radius` of `centre`, and perhaps some slightly farther ones. Stops early
    // once there are more than near.most, so the list is complete only if near.count() <= near.most afterwards.
    void gather(const Vec3& centre, double radius, NearTriangles<float>& near, Counters& counters) const;

    const TriangleMesh& mesh() const { return *mesh_; }
    const std::vector<TriangleFramesLeaf>& leaves() const { return leaves_; }
    std::size_t bytes() const;

    // A view of the members, for the functions in triangle_blocks_search.cpp.
    struct Tree {
        const std::vector<TriangleFramesLeaf>& leaves;
        const std::vector<BoxNode>& nodes;
        // Level i of the tree begins at nodes[level_begin[i - 1]]. Level 1 has the boxes of the leaves; the last level
        // is a single node, the root. Child c of node n is node 16 * n + c of the level below; for level 1, leaf 16 * n
        // + c.
        const std::vector<std::size_t>& level_begin;
        const TriangleMesh& mesh;
    };

private:
    Tree tree() const { return {leaves_, nodes_, level_begin_, *mesh_}; }
    // Appends one level of nodes over the boxes `below`, sixteen per node. Sets `boxes` to the boxes around these
    // nodes.
    void add_level(const std::vector<Box>& below, std::vector<Box>& boxes, double least_unit);

    const TriangleMesh* mesh_;
    std::vector<TriangleFramesLeaf> leaves_;
    std::vector<BoxNode> nodes_;
    std::vector<std::size_t> level_begin_;
};

// Stores the given triangles, at most `most_triangles`, in `near`, with frames in double precision.
void set_frames(const TriangleMesh& mesh, const std::vector<Index>& triangles, NearTriangles<double>& near);

// The triangles of a mesh, ordered by their centres along a Hilbert curve, so that neighbours in the order are
// neighbours in space.
struct TriangleOrder {
    static constexpr std::string_view structure_name = "triangle order";
    static constexpr int structure_layout = 1;

    // O(n) time in general (see morton_order in kernel/morton.h). The result is the same for any number of threads.
    explicit TriangleOrder(const TriangleMesh& mesh, const Threads& threads = Threads());

    std::vector<Index> order;

    std::size_t bytes() const { return order.capacity() * sizeof(Index); }
};

}  // namespace hausbench
