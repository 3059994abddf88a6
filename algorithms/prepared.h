// Structures built once for a scene, before any query: exactly those that a solver declares in needs(), each timed.
#pragma once

#include "kernel/adjacency.h"
#include "kernel/bvh.h"
#include "kernel/octree.h"
#include "kernel/point_blocks.h"
#include "kernel/point_octree.h"
#include "kernel/rtree.h"
#include "kernel/swept_sphere.h"
#include "scene.h"

#include <compare>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

enum class Structure {
    octree,        // TriangleOctree, of a mesh
    point_octree,  // PointOctree, of points (or of the vertices of a mesh)
    rtree,         // RTree, likewise
    point_blocks,  // PointBlocks, likewise
    bvh,           // TriangleBvh, of a mesh
    swept_bvh,     // SweptSphereBvh, of a mesh
    point_bvh,     // PointBvh, of points (or of the vertices of a mesh)
    adjacency,     // Adjacency, of a mesh
};
enum class Side { source, target };

struct Need {
    Structure structure;
    Side side;

    auto operator<=>(const Need&) const = default;
};

using Needs = std::vector<Need>;

std::string to_string(const Need& need);  // "target octree"

// Whether this structure can be built over a shape of this kind.
bool fits(Structure structure, ShapeKind kind);

struct PreparationTime {
    std::string name;  // as to_string(Need), or "solver" for what the solver built itself
    double seconds;
    std::size_t bytes;
};

class Prepared {
public:
    // Builds each need once. `scene` must outlive this. O(n log n) for each structure.
    Prepared(const Scene& scene, const Needs& needs);

    bool has(Structure structure, Side side) const;

    // Over the elements (triangles) of that side, unposed. Throws std::logic_error if it was not declared.
    const TriangleOctree& octree(Side side) const;
    const TriangleBvh& bvh(Side side) const;
    const SweptSphereBvh& swept_bvh(Side side) const;
    const Adjacency& adjacency(Side side) const;

    // Over the points of that side, unposed; they throw likewise.
    const PointOctree& point_octree(Side side) const;
    const RTree& rtree(Side side) const;
    const PointBlocks& point_blocks(Side side) const;
    const PointBvh& point_bvh(Side side) const;

    const std::vector<PreparationTime>& times() const { return times_; }

    // The structures that the getters have returned so far; the contract test fails for a declared one that is never used.
    const std::map<Need, int>& uses() const { return uses_; }

private:
    template <class Kind> const Kind& get(const std::optional<Kind> (&built)[2], Structure structure, Side side) const;

    std::optional<TriangleOctree> octree_[2];
    std::optional<PointOctree> point_octree_[2];
    std::optional<RTree> rtree_[2];
    std::optional<PointBlocks> point_blocks_[2];
    std::optional<TriangleBvh> bvh_[2];
    std::optional<SweptSphereBvh> swept_bvh_[2];
    std::optional<PointBvh> point_bvh_[2];
    std::optional<Adjacency> adjacency_[2];
    std::vector<PreparationTime> times_;
    mutable std::map<Need, int> uses_;
};

}  // namespace hausbench
