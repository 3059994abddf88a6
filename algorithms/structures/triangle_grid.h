// A uniform grid over the triangles of a mesh, for closest point queries near its surface, as in Kang et al. 2018.
//
// A triangle belongs to every cell that its box touches. A query looks into the cells around the point, shell by
// shell, until a shell is farther than the nearest triangle found. The grid works well if triangles have similar
// sizes and the point is near. From far away a query looks into most cells, and if sizes differ much, a few cells
// hold most triangles. Trees (triangle_tree.h) have neither weakness.
//
// There is no slack for rounding: cells are numbered by a function that is monotone in each coordinate, as
// computed, and distances to cells are distances to planes beyond which the number changes. So a cell is left out
// only if no computed distance to a point in it could win, and the closest point of a triangle, which is clamped to
// its box, lies in a cell that the triangle belongs to.
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

    // `mesh` must outlive this. Cells are cubes, about as many as triangles, but fewer if triangles would belong to
    // more than 8 cells each on average. O(n) time and memory.
    explicit TriangleGrid(const TriangleMesh& mesh);

    // Returns the same bits as closest_by_scan (kernel/closest.h), with the same hints. O(1) near a surface of
    // evenly sized triangles, O(n) at worst.
    ClosestPoint closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const;

    // Returns the same bits as certified_distance_by_scan.
    double certified_distance(const Vec3& point, Counters& counters) const;

    const TriangleMesh& mesh() const { return *mesh_; }
    std::size_t bytes() const;

private:
    struct Axis {
        double low = 0, cells_per_length = 0;
        int cells = 1;
        // Coordinates in cells i and later are >= before[i]; coordinates in cells up to i are <= after[i].
        std::vector<double> before, after;

        int cell(double x) const;
    };
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
    // Cell i: order_[cell_begin_[i]] to [cell_begin_[i + 1] - 1].
    std::vector<std::int32_t> cell_begin_;
    std::vector<Index> order_;
};

}  // namespace hausbench
