// Finds the triangles that share an edge of a mesh.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace hausbench::tang {

// The edges of a mesh and the triangles at each edge. Edges are compared by vertex index, so triangles that touch only
// at duplicated vertices share no edge. An edge may have one, two or more triangles; a triangle with the vertices (i,
// i, j) is listed twice at the edge ij.
class Adjacency {
public:
    static constexpr std::string_view structure_name = "adjacency";
    static constexpr bool structure_of_meshes_only = true;  // points have no neighbours
    static constexpr int structure_layout = 1;

    // O(n) time if each vertex belongs to few triangles, O(n log n) in the worst case; O(n) memory.
    explicit Adjacency(const TriangleMesh& mesh);

    Index edges() const { return static_cast<Index>(begin_.size()) - 1; }

    // Returns the index of the edge between corners k and k + 1 (mod 3) of a triangle.
    Index edge(Index triangle, int k) const {
        return edge_of_[3 * static_cast<std::size_t>(triangle) + static_cast<std::size_t>(k)];
    }

    // Returns the triangles at an edge, in ascending order.
    std::span<const Index> triangles(Index edge) const {
        const auto e = static_cast<std::size_t>(edge);
        return {triangles_.data() + begin_[e], static_cast<std::size_t>(begin_[e + 1] - begin_[e])};
    }

    std::size_t bytes() const;

private:
    std::vector<Index> edge_of_;  // the three edges of each triangle
    // triangles_[begin_[e]] to triangles_[begin_[e + 1] - 1] are the triangles at edge e.
    std::vector<std::int32_t> begin_;
    std::vector<Index> triangles_;
};

}  // namespace hausbench::tang
