// Distances to the mesh B, the target. A tree, a grid or blocks of triangles find them; without these, a scan of
// all triangles does.
#pragma once

#include "algorithms/kernel/closest.h"
#include "algorithms/kernel/triangle_block.h"
#include "algorithms/structures/triangle_blocks.h"
#include "algorithms/structures/triangle_grid.h"
#include "algorithms/structures/triangle_tree.h"

namespace hausbench {

// If B has at most this many triangles, testing all of them is as fast as using a tree.
inline constexpr Index scan_at_most = 32;

// A point of A, moved by its pose, and its distance to B if that is known. Often a vertex of A or of a
// piece of a triangle.
struct MeasuredPoint {
    Vec3 point;
    double squared = -1;  // squared distance to B; negative: unknown
    Index triangle = -1;  // nearest triangle of B
};

// The mesh B with at most one structure for closest point queries.
class Target {
public:
    // `tree` is over `mesh`, or null to scan all triangles. Both arguments must outlive this. With `textbook`,
    // distances are computed with textbook formulas (kernel/textbook.h), to show how these fail, so bounds from them
    // may be wrong; only certified distances are computed as usual.
    Target(const TriangleMesh& mesh, const TriangleTree* tree, bool textbook = false)
        : mesh_(mesh), tree_(tree), textbook_(textbook) {}

    Target(const TriangleMesh& mesh, const TriangleGrid* grid) : mesh_(mesh), grid_(grid) {}
    Target(const TriangleMesh& mesh, const TriangleBlocks* blocks) : mesh_(mesh), blocks_(blocks) {}
    Target(const TriangleMesh& mesh, std::nullptr_t) : mesh_(mesh) {}

    const TriangleMesh& mesh() const { return mesh_; }
    Triangle triangle(Index i) const { return triangle_of(mesh_, i); }

    // Returns the point of B closest to `point`. `warm` is a triangle of B to test first, or -1, as in ClosestHints.
    ClosestPoint closest(const Vec3& point, Index warm, Counters& counters) const;

    // Returns the squared distance from `point` to one triangle. Changes no counter.
    double squared_distance(const Vec3& point, const Triangle& triangle) const;

    // Computes the squared distances from the first `count` points of `block` (at most 8) to one triangle:
    // feet.squared_distance[k] belongs to point k. Changes no counter.
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
