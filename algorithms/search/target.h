// Distances to the target B, by its tree, its grid or its blocks, or by a scan where B is so small that it has neither.
#pragma once

#include "algorithms/kernel/closest.h"
#include "algorithms/kernel/triangle_block.h"
#include "algorithms/structures/triangle_blocks.h"
#include "algorithms/structures/triangle_grid.h"
#include "algorithms/structures/triangle_tree.h"

namespace hausbench {

// Triangles of B that are as soon scanned as searched: with so many a solver needs no tree.
inline constexpr Index scan_at_most = 32;

// A point of A posed, or of a piece of it, and what is known of its distance to B.
struct MeasuredPoint {
    Vec3 point;
    double squared = -1;  // distance to B, squared; negative: not known yet
    Index triangle = -1;  // of B, nearest
};

class Target {
public:
    // Both outlive this; `tree` is over `mesh`, or null. With `textbook` all distances but certified ones are those of
    // kernel/textbook.h, to show how they fail: bounds from them may be wrong.
    Target(const TriangleMesh& mesh, const TriangleTree* tree, bool textbook = false)
        : mesh_(mesh), tree_(tree), textbook_(textbook) {}

    Target(const TriangleMesh& mesh, const TriangleGrid* grid) : mesh_(mesh), grid_(grid) {}
    Target(const TriangleMesh& mesh, const TriangleBlocks* blocks) : mesh_(mesh), blocks_(blocks) {}
    Target(const TriangleMesh& mesh, std::nullptr_t) : mesh_(mesh) {}

    const TriangleMesh& mesh() const { return mesh_; }
    Triangle triangle(Index i) const { return triangle_of(mesh_, i); }

    // `warm` as in ClosestHints: a triangle to look at first, or -1.
    ClosestPoint closest(const Vec3& point, Index warm, Counters& counters) const;

    // Of `point` to one triangle. Counts nothing.
    double squared_distance(const Vec3& point, const Triangle& triangle) const;

    // Of the first `count` of up to 8 points in `block`, lane by lane. Counts nothing.
    void squared_distances(const PointBlock& block, std::size_t count, const Triangle& triangle, BlockFeet& feet) const;

    // A lower bound of the exact distance that holds under rounding.
    double certified_distance(const Vec3& point, Counters& counters) const;

private:
    const TriangleMesh& mesh_;
    const TriangleTree* tree_ = nullptr;
    const TriangleGrid* grid_ = nullptr;
    const TriangleBlocks* blocks_ = nullptr;
    bool textbook_ = false;
};

}  // namespace hausbench
