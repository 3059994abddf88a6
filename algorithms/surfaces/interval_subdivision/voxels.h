// The voxels of a grid over a surface's box that may contain a point of the surface according to interval arithmetic,
// and the octree above them.
//
// Grid lines are rounded numbers lo + (hi - lo) i / n, and voxels are the boxes between them: they cover the box
// without gaps.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/interval_form.h"
#include "algorithms/scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace hausbench {

struct Voxels {
    using Grid = std::array<std::vector<double>, 3>;  // 2^depth + 1 lines per axis

    struct Node {
        std::array<int, 3> at;  // position in voxels
        int size;
        // Range of children; count 0 marks a voxel, or a cell without kept voxels.
        std::uint32_t first = 0, count = 0;
    };

    Grid grid;
    std::vector<Node> nodes;
    std::vector<std::uint32_t> leaves;
    std::array<std::vector<double>, 3> low, high;  // by leaf
    std::uint64_t evaluations = 0;

    // Inline because searches call it for each cell; it took a fifth of their instructions otherwise.
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

// Makes 2^depth voxels per axis. Sets the rounding mode itself. Throws InputError if the box is too small for so many
// voxels, or contains no point of the surface.
Voxels voxels_of(const AlgebraicSurface& surface, int depth, Form form);

}  // namespace hausbench
