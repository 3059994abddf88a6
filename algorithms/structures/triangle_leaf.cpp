#include "algorithms/structures/triangle_leaf.h"

#include <algorithm>
#include <array>

namespace hausbench {

namespace {

// The distinct vertices of a leaf: a small hash table that maps the index of a vertex in the mesh to its index in the
// leaf.
class VertexTable {
public:
    VertexTable() { place_.fill(-1); }

    // Returns the index of a vertex in the leaf; a new vertex gets the next free index.
    int place_of(Index vertex) {
        for (auto at = static_cast<std::size_t>(vertex);; ++at) {
            std::int8_t& place = place_[at % place_.size()];
            if (place < 0) {
                vertex_[static_cast<std::size_t>(count_)] = vertex;
                return place = static_cast<std::int8_t>(count_++);
            }
            if (vertex_[static_cast<std::size_t>(place)] == vertex) return place;
        }
    }
    int count() const { return count_; }

private:
    std::array<std::int8_t, 64> place_;
    std::array<Index, 3 * leaf_capacity> vertex_;
    int count_ = 0;
};

}  // namespace

Box TriangleLeaf::set(const TriangleMesh& mesh, std::span<const Index> triangles, double* vertices,
                      std::uint32_t& next) {
    std::array<Box, leaf_capacity> around;
    VertexTable table;
    first_vertex = next;
    count = static_cast<std::int32_t>(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Triangle t = triangle_of(mesh, triangles[i]);
        around[i] = box_of(t);
        const Vec3* const corners[3] = {&t.a, &t.b, &t.c};
        const Index* numbers = mesh.triangles.row(triangles[i]).data();
        const int turn = longest_edge(t);
        for (int v = 0; v < 3; ++v) {
            const int place = table.place_of(numbers[v]);
            double* to = vertices + 3 * (next + static_cast<std::size_t>(place));
            for (int k = 0; k < 3; ++k) to[k] = (*corners[v])[k];
            corner[(v + 3 - turn) % 3][i] = static_cast<std::uint8_t>(3 * place);
        }
    }
    for (int v = 0; v < 3; ++v) std::fill(corner[v] + triangles.size(), corner[v] + leaf_capacity, corner[v][0]);
    next += static_cast<std::uint32_t>(table.count());
    return boxes.set(std::span(around).first(triangles.size()));
}

}  // namespace hausbench
