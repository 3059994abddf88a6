#include "algorithms/structures/triangle_grid.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <cmath>

namespace hausbench {

namespace {

constexpr double cells_per_triangle = 1;
constexpr std::size_t most_entries_per_triangle = 8;
constexpr int most_cells_of_an_axis = 1 << 12;

}  // namespace

int TriangleGrid::Axis::cell(double x) const {
    const double scaled = (x - low) * cells_per_length;
    return static_cast<int>(std::min(std::max(scaled, 0.0), static_cast<double>(cells - 1)));
}

// Divides a box into cells. Their sides are at most `edge` long, unless that takes more than most_cells_of_an_axis
// cells along an axis. The planes `before` and `after` start at the border between two cells and move outward until
// cell() confirms that they are beyond it, so rounding never puts a point of a cell outside its planes.
void TriangleGrid::lay(const Box& box, double edge) {
    for (int k = 0; k < 3; ++k) {
        Axis& axis = axes_[k];
        const double extent = box.high[k] - box.low[k];
        const double wanted = edge > 0 ? std::ceil(extent / edge) : 1;
        axis.low = box.low[k];
        axis.cells = static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(most_cells_of_an_axis)));
        axis.cells_per_length = extent > 0 ? axis.cells / extent : 0;
        if (!std::isfinite(axis.cells_per_length)) {
            axis.cells = 1;
            axis.cells_per_length = 0;
        }
        axis.before.assign(static_cast<std::size_t>(axis.cells), -std::numeric_limits<double>::infinity());
        axis.after.assign(static_cast<std::size_t>(axis.cells), std::numeric_limits<double>::infinity());
        const double step = extent / axis.cells,
                     ulp = std::max(std::max(std::abs(box.low[k]), std::abs(box.high[k])) * 0x1p-52,
                                    std::numeric_limits<double>::denorm_min());
        for (int i = 1; i < axis.cells; ++i) {
            double low = axis.low + i * step, high = low;
            for (double slack = ulp; axis.cell(low) >= i; slack *= 2) low -= slack;
            for (double slack = ulp; axis.cell(high) < i; slack *= 2) high += slack;
            axis.before[static_cast<std::size_t>(i)] =
                WATCHED_ELSE("grid: planes that are not moved outward", low, axis.low + (i + 0.25) * step);
            axis.after[static_cast<std::size_t>(i - 1)] = high;
        }
    }
}

TriangleGrid::Block TriangleGrid::block_of(const Box& box) const {
    Block block;
    for (int k = 0; k < 3; ++k) {
        block.low[k] = axes_[k].cell(box.low[k]);
        block.high[k] = axes_[k].cell(
            WATCHED_ELSE("grid: a triangle belongs to the first of its cells alone", box.high[k], box.low[k]));
    }
    return block;
}

std::size_t TriangleGrid::number(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(axes_[1].cells) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(axes_[0].cells) +
           static_cast<std::size_t>(x);
}

// Returns the number of entries in all cells: each triangle has one in every cell that its box touches.
std::size_t TriangleGrid::entries() const {
    std::size_t count = 0;
    for (Index i = 0; i < mesh_->triangles.rows(); ++i) {
        const Block block = block_of(box_of(triangle_of(*mesh_, i)));
        std::size_t cells = 1;
        for (int k = 0; k < 3; ++k) cells *= static_cast<std::size_t>(block.high[k] - block.low[k] + 1);
        count += cells;
    }
    return count;
}

TriangleGrid::TriangleGrid(const TriangleMesh& mesh) : mesh_(&mesh) {
    const auto count = static_cast<std::size_t>(mesh.triangles.rows());
    for (Index i = 0; i < mesh.triangles.rows(); ++i) box_.add(box_of(triangle_of(mesh, i)));
    const Vec3 extent = box_.high - box_.low;
    // Each side counts as at least a hundredth of the longest one, so that a flat box does not have volume 0 and gets
    // cells of about the size of its triangles.
    const double longest = extent.maxCoeff();
    const double volume = (extent.cwiseMax(0.01 * longest) / (longest > 0 ? longest : 1)).prod();
    double edge = longest * std::cbrt(volume / (cells_per_triangle * static_cast<double>(count)));
    for (lay(box_, edge);
         WATCHED("grid: as many cells as a triangle touches", entries() > most_entries_per_triangle * count);
         lay(box_, edge))
        edge *= 1.5;
    fill();
}

void TriangleGrid::fill() {
    const std::size_t cells = number(axes_[0].cells - 1, axes_[1].cells - 1, axes_[2].cells - 1) + 1;
    std::vector<std::int32_t> next(cells + 1, 0);
    const auto for_each_cell = [&](const auto& call) {
        for (Index i = 0; i < mesh_->triangles.rows(); ++i) {
            const Block block = block_of(box_of(triangle_of(*mesh_, i)));
            for (int z = block.low[2]; z <= block.high[2]; ++z)
                for (int y = block.low[1]; y <= block.high[1]; ++y)
                    for (int x = block.low[0]; x <= block.high[0]; ++x) call(number(x, y, z), i);
        }
    };
    for_each_cell([&](std::size_t cell, Index) { ++next[cell + 1]; });
    for (std::size_t c = 0; c < cells; ++c) next[c + 1] += next[c];
    cell_begin_ = next;
    order_.resize(static_cast<std::size_t>(next[cells]));
    for_each_cell([&](std::size_t cell, Index i) { order_[static_cast<std::size_t>(next[cell]++)] = i; });
}

// Returns a lower bound on the computed squared distance from the point to everything outside a block of cells. Returns
// infinity if the block is the whole grid.
double TriangleGrid::beyond(const Vec3& point, const Block& block) const {
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        Box side = box_;
        if (block.high[k] + 1 < axes_[k].cells) {
            side.low[k] = std::max(box_.low[k], axes_[k].before[static_cast<std::size_t>(block.high[k] + 1)]);
            least = std::min(least, squared_distance_to_box(point, side));
        }
        side = box_;
        if (block.low[k] > 0) {
            side.high[k] = std::min(
                box_.high[k], WATCHED_ELSE("grid: cells beyond the block are as far as the whole box", axes_[k].after,
                                           axes_[k].before)[static_cast<std::size_t>(block.low[k] - 1)]);
            least = std::min(least, squared_distance_to_box(point, side));
        }
    }
    return least;
}

// Calls look(triangle) for the triangles of each cell that may contain a point within the squared distance `squared`.
// look() may lower the variable that `squared` refers to.
template <class Look>
void TriangleGrid::search(const Vec3& point, const double& squared, Counters& counters, const Look& look) const {
    int at[3];
    for (int k = 0; k < 3; ++k) at[k] = axes_[k].cell(point[k]);
    const auto look_into = [&](int x, int y, int z) {
        const std::size_t cell = number(x, y, z);
        if (cell_begin_[cell] == cell_begin_[cell + 1]) return;
        ++counters.node_visits;
        const int place[3] = {x, y, z};
        Box box = box_;
        for (int k = 0; k < 3; ++k) {
            box.low[k] = std::max(box.low[k], axes_[k].before[static_cast<std::size_t>(place[k])]);
            box.high[k] = std::min(box.high[k], axes_[k].after[static_cast<std::size_t>(place[k])]);
        }
        if (squared_distance_to_box(point, box) > squared) return;
        for (std::int32_t j = cell_begin_[cell]; j < cell_begin_[cell + 1]; ++j)
            look(order_[static_cast<std::size_t>(j)]);
    };
    for (int shell = 0;; ++shell) {
        Block block;
        for (int k = 0; k < 3; ++k) {
            block.low[k] = std::max(at[k] - shell, 0);
            block.high[k] = std::min(at[k] + shell, axes_[k].cells - 1);
        }
        for (int z = block.low[2]; z <= block.high[2]; ++z) {
            for (int y = block.low[1]; y <= block.high[1]; ++y) {
                // If a row goes through the inside of the shell, only its ends belong to the shell.
                const bool inside = std::abs(z - at[2]) < shell && std::abs(y - at[1]) < shell;
                for (int x = block.low[0]; x <= block.high[0]; ++x) {
                    if (inside && std::abs(x - at[0]) < shell) x = std::min(at[0] + shell, block.high[0] + 1);
                    if (x <= block.high[0]) look_into(x, y, z);
                }
            }
        }
        const double farther = beyond(point, block);
        if (farther > WATCHED_ELSE("grid: a shell ends the search where it is as far as what was found", squared,
                                   0.25 * squared) ||
            std::isinf(farther))
            return;
    }
}

ClosestPoint TriangleGrid::closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const {
    ++counters.closest_point_queries;
    ClosestPoint best;
    best.squared_distance = hints.squared_radius;
    const auto measure = [&](Index i) {
        const Triangle triangle = triangle_of(*mesh_, i);
        if (squared_distance_to_box(point, box_of(triangle)) > best.squared_distance) return;
        ++counters.point_triangle_distances;
        offer(best, closest_point(point, triangle), i);
    };
    if (hints.warm_triangle >= 0) measure(hints.warm_triangle);
    search(point, best.squared_distance, counters, [&](Index i) {
        if (best.triangle < 0 || best.squared_distance > hints.early_out_squared) measure(i);
    });
    return best;
}

double TriangleGrid::certified_distance(const Vec3& point, Counters& counters) const {
    const double nearest = closest(point, {}, counters).squared_distance;
    double least = distance_at_least(nearest, true);
    search(point, nearest, counters,
           [&](Index i) { certify(point, triangle_of(*mesh_, i), nearest, least, counters); });
    return least;
}

std::size_t TriangleGrid::bytes() const {
    std::size_t planes = 0;
    for (const Axis& axis : axes_) planes += axis.before.capacity() + axis.after.capacity();
    return planes * sizeof(double) + cell_begin_.capacity() * sizeof(std::int32_t) + order_.capacity() * sizeof(Index);
}

}  // namespace hausbench
