// Distances to the target B, by its tree, its grid or its blocks, or by a scan if B is too small to have one.
#pragma once

#include "algorithms/kernel/closest.h"
#include "algorithms/kernel/triangle_block.h"
#include "algorithms/structures/triangle_blocks.h"
#include "algorithms/structures/triangle_grid.h"
#include "algorithms/structures/triangle_tree.h"

namespace hausbench {

// Up to this many triangles of B, a scan is as fast as a tree.
inline constexpr Index scan_at_most = 32;

// A point of A posed, or of a piece of it, with its distance to B if known.
struct MeasuredPoint {
    Vec3 point;
    double squared = -1;  // squared distance to B; negative: unknown
    Index triangle = -1;  // nearest triangle of B
};

class Target {
public:
    // Both arguments must outlive this; `tree` is over `mesh`, or null. With `textbook` all distances except certified ones come from
    // kernel/textbook.h, to show how they fail, so bounds from them may be wrong.
    Target(const TriangleMesh& mesh, const TriangleTree* tree, bool textbook = false)
        : mesh_(mesh), tree_(tree), textbook_(textbook) {}

    Target(const TriangleMesh& mesh, const TriangleGrid* grid) : mesh_(mesh), grid_(grid) {}
    Target(const TriangleMesh& mesh, const TriangleBlocks* blocks) : mesh_(mesh), blocks_(blocks) {}
    Target(const TriangleMesh& mesh, std::nullptr_t) : mesh_(mesh) {}

    const TriangleMesh& mesh() const { return mesh_; }
    Triangle triangle(Index i) const { return triangle_of(mesh_, i); }

    // Returns the closest point of B. `warm` is a triangle to try first, or -1, as in ClosestHints.
    ClosestPoint closest(const Vec3& point, Index warm, Counters& counters) const;

    // Returns the squared distance of `point` to one triangle. Counts nothing.
    double squared_distance(const Vec3& point, const Triangle& triangle) const;

    // Likewise for the first `count` of up to 8 points in `block`, lane by lane. Counts nothing.
    void squared_distances(const PointBlock& block, std::size_t count, const Triangle& triangle, BlockFeet& feet) const;

    // Returns a lower bound of the exact distance; valid under rounding.
    double certified_distance(const Vec3& point, Counters& counters) const;

private:
    const TriangleMesh& mesh_;
    const TriangleTree* tree_ = nullptr;
    const TriangleGrid* grid_ = nullptr;
    const TriangleBlocks* blocks_ = nullptr;
    bool textbook_ = false;
};

}  // namespace hausbench
