// A uniform grid over the triangles of a mesh, for closest point queries near its surface, as in Kang et al. 2018.
//
// A triangle belongs to every cell that its box touches. A query looks into the cell of the point and then, shell by
// shell, into the cells around it, until everything outside the last shell is farther away than the nearest triangle
// found. The grid works well if triangles have similar sizes and the point is near. From far away a query looks into
// most cells, and if sizes differ much, a few cells hold most triangles. Trees (triangle_tree.h) have neither
// weakness.
//
// Queries need no slack for rounding. Along each axis, the cell number is a monotone function of the coordinate, as
// computed, and the distance to a cell is the distance to planes that lie outside it, as this function confirms
// (Axis::before and Axis::after). So a cell is skipped only if no point in it has a computed distance that could win.
// The closest point of a triangle is always in a cell that the triangle belongs to, because closest_point() returns a
// point inside the triangle's box.
#pragma once

#include "algorithms/kernel/closest.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace hausbench {

class TriangleGrid {
public:
    static constexpr std::string_view structure_name = "uniform grid";
    static constexpr int structure_layout = 1;

    // `mesh` must outlive the grid. Cells are nearly cubes. There are about as many cells as triangles, but fewer if
    // triangles would otherwise belong to more than 8 cells on average. O(n) time and memory.
    explicit TriangleGrid(const TriangleMesh& mesh);

    // Returns the same closest point, bit for bit, as closest_by_scan (kernel/closest.h). O(1) near a surface of evenly
    // sized triangles, O(n) at worst.
    ClosestPoint closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // Returns a proven lower bound on the exact distance, the same as certified_distance_by_scan (kernel/closest.h).
    double certified_distance(const Vec3& point, Counters& counters) const;

    const TriangleMesh& mesh() const { return *mesh_; }
    std::size_t bytes() const;

private:
    struct Axis {
        double low = 0, cells_per_length = 0;
        int cells = 1;
        // Coordinates in cells i and later are >= before[i]; coordinates in cells up to i are <= after[i].
        std::vector<double> before, after;

        // Returns the number of the cell that contains the coordinate x, clamped to the grid.
        int cell(double x) const;
    };
    // A box of cells.
    struct Block {
        int low[3], high[3];  // cell numbers, both inclusive
    };

    void lay(const Box& box, double edge);
    std::size_t entries() const;
    void fill();
    Block block_of(const Box& box) const;
    std::size_t number(int x, int y, int z) const;
    double beyond(const Vec3& point, const Block& block) const;
    template <class Look>
    void search(const Vec3& point, const double& squared, Counters& counters, const Look& look) const;

    const TriangleMesh* mesh_;
    Box box_;
    Axis axes_[3];
    // The triangles of cell i are order_[j] for cell_begin_[i] <= j < cell_begin_[i + 1].
    std::vector<std::int32_t> cell_begin_;
    std::vector<Index> order_;
};

}  // namespace hausbench
