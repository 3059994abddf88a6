// Distances from points to B, the target mesh, by a tree, a grid, blocks of triangles or a scan of all triangles.
#pragma once

#include "algorithms/kernel/closest.h"
#include "algorithms/kernel/triangle_block.h"
#include "algorithms/structures/triangle_blocks.h"
#include "algorithms/structures/triangle_grid.h"
#include "algorithms/structures/triangle_tree.h"

namespace hausbench {

// If B has at most this many triangles, testing all of them is as fast as using a tree.
inline constexpr Index scan_at_most = 32;

// A point of A, moved by its pose, and its distance to B if that is known. Usually a vertex of A or a corner of a piece
// cut from a triangle of A.
struct MeasuredPoint {
    Vec3 point;
    double squared = -1;  // squared distance to B; negative: unknown
    Index triangle = -1;  // nearest triangle of B
};

// The mesh B, with an optional structure that speeds up closest point queries.
class Target {
public:
    // `tree` is over `mesh`, or null to scan all triangles. Both must outlive this object. With `textbook`, distances
    // come from textbook formulas (kernel/textbook.h), to show where these fail; bounds may then be wrong. Certified
    // distances never use these formulas.
    Target(const TriangleMesh& mesh, const TriangleTree* tree, bool textbook = false)
        : mesh_(mesh), tree_(tree), textbook_(textbook) {}

    Target(const TriangleMesh& mesh, const TriangleGrid* grid) : mesh_(mesh), grid_(grid) {}
    Target(const TriangleMesh& mesh, const TriangleBlocks* blocks) : mesh_(mesh), blocks_(blocks) {}
    Target(const TriangleMesh& mesh, std::nullptr_t) : mesh_(mesh) {}

    const TriangleMesh& mesh() const { return mesh_; }
    Triangle triangle(Index i) const { return triangle_of(mesh_, i); }

    // Returns the point of B closest to `point`. `warm` is a triangle of B to test first, or -1 for none.
    ClosestPoint closest(const Vec3& point, Index warm, Counters& counters) const;

    // Returns the squared distance from `point` to one triangle. Changes no counter.
    double squared_distance(const Vec3& point, const Triangle& triangle) const;

    // Computes the squared distances from the first `count` points of `block` (at most 8) to one triangle, and stores
    // the distance of point k in feet.squared_distance[k]. Changes no counter.
    void squared_distances(const PointBlock& block, std::size_t count, const Triangle& triangle, BlockFeet& feet) const;

    // Returns a lower bound on the exact distance from `point` to B; valid under rounding.
    double certified_distance(const Vec3& point, Counters& counters) const;

private:
    const TriangleMesh& mesh_;
    const TriangleTree* tree_ = nullptr;
    const TriangleGrid* grid_ = nullptr;
    const TriangleBlocks* blocks_ = nullptr;
    bool textbook_ = false;
};

}  // namespace hausbench
