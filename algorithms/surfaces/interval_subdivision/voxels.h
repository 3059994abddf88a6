// The voxels of a grid over the box of a surface that may contain a point of the surface, and the octree above them. A
// voxel or cell is kept if interval arithmetic cannot exclude that the polynomial is 0 in it.
//
// Grid lines are at low + (high - low) * i / n, rounded. Neighbouring voxels share a line, so the voxels fill the box
// without gaps, whatever the rounding.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/interval_form.h"
#include "algorithms/scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace hausbench::interval_subdivision {

struct Voxels {
    using Grid = std::array<std::vector<double>, 3>;  // 2^depth + 1 lines per axis

    struct Node {
        std::array<int, 3> at;  // its lowest corner, counted in voxels
        int size;               // its edge, counted in voxels
        // The children are nodes[first] to nodes[first + count - 1]. If count is 0, the node is a voxel (of size 1) or
        // a cell without kept voxels.
        std::uint32_t first = 0, count = 0;
    };

    Grid grid;
    std::vector<Node> nodes;
    std::vector<std::uint32_t> leaves;
    std::array<std::vector<double>, 3> low, high;  // sides of these voxels along each axis, by leaf
    std::uint64_t evaluations = 0;

    // Returns the box of a cell. Inline, because searches need it for every cell: a call took a fifth of their
    // instructions.
    Box box_of(const std::array<int, 3>& at, int size) const {
        Box box;
        for (std::size_t k = 0; k < 3; ++k) {
            box.low[Eigen::Index(k)] = grid[k][std::size_t(at[k])];
            box.high[Eigen::Index(k)] = grid[k][std::size_t(at[k] + size)];
        }
        return box;
    }
    Box box_of(const Node& node) const { return box_of(node.at, node.size); }
    Box whole() const { return box_of(nodes.front()); }

    std::size_t bytes() const {
        return nodes.size() * sizeof(Node) + leaves.size() * (sizeof(std::uint32_t) + 6 * sizeof(double));
    }
};

// Finds the voxels that may contain a point of the surface, in a grid with 2^depth voxels along each axis. `form` is
// the kind of interval arithmetic. Sets the rounding mode itself. Throws InputError if the box is so small that grid
// lines coincide, or if it contains no point of the surface.
Voxels voxels_of(const AlgebraicSurface& surface, int depth, Form form);

}  // namespace hausbench::interval_subdivision
