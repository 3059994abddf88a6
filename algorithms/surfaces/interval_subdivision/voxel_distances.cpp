#include "algorithms/surfaces/interval_subdivision/voxel_distances.h"

#include "algorithms/kernel/rounding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace hausbench::interval_subdivision {
namespace {

// Factors that exceed the rounding errors of square roots and of their sums. They only affect which cells are searched,
// so they do not change the result.
constexpr double wider = 1 + 1e-12, narrower = 1 - 1e-12;

// Returns the square of the least distance (or of the largest distance, if `largest`) between a point of box a and a
// point of box b. Rounds to nearest; every operation is monotone.
template <bool largest> double squared_distance(const Box& a, const Box& b) {
    double d[3];
    for (int k = 0; k < 3; ++k) {
        d[k] = largest ? std::max(b.high[k] - a.low[k], a.high[k] - b.low[k])
                       : std::max(std::max(b.low[k] - a.high[k], a.low[k] - b.high[k]), 0.0);
    }
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

// Returns a lower bound on squared_distance<largest>() between box a and any voxel in the cell.
template <bool largest> double at_least(const Box& a, const Voxels& b, const Voxels::Node& cell) {
    if (!largest) return squared_distance<false>(a, b.box_of(cell));
    double d[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const auto i = Eigen::Index(k);
        // The lowest high side and the highest low side of any voxel in the cell: the high side of the first voxel and
        // the low side of the last one.
        const double high = b.grid[k][std::size_t(cell.at[k]) + 1],
                     low = b.grid[k][std::size_t(cell.at[k] + cell.size) - 1];
        d[k] = std::max(high - a.low[i], a.high[i] - low);
    }
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

// Compares voxel i of A with all voxels of B. Returns the minimum of the squared least distances and the minimum of the
// squared largest distances.
VoxelDistances nearest_of_all(const Voxels& a, std::size_t i, const Voxels& b) {
    constexpr std::size_t lanes = 4;  // separate minima, so that the compiler may vectorise them
    const std::size_t m = b.leaves.size();
    const double *bl[3], *bh[3];
    double al[3], ah[3];
    for (std::size_t k = 0; k < 3; ++k) {
        bl[k] = b.low[k].data();
        bh[k] = b.high[k].data();
    }
    for (std::size_t k = 0; k < 3; ++k) {
        al[k] = a.low[k][i];
        ah[k] = a.high[k][i];
    }
    double least[lanes], largest[lanes];
    std::fill_n(least, lanes, infinity);
    std::fill_n(largest, lanes, infinity);
    const auto look = [&](std::size_t j, std::size_t lane) {
        double s[3], t[3];
        for (std::size_t k = 0; k < 3; ++k) {
            const double before = al[k] - bh[k][j], after = bl[k][j] - ah[k];
            const double apart = before > after ? before : after;
            s[k] = apart > 0 ? apart : 0;
            const double first = bh[k][j] - al[k], second = ah[k] - bl[k][j];
            t[k] = first > second ? first : second;
        }
        const double nearest = (s[0] * s[0] + s[1] * s[1]) + s[2] * s[2],
                     farthest = (t[0] * t[0] + t[1] * t[1]) + t[2] * t[2];
        least[lane] = nearest < least[lane] ? nearest : least[lane];
        largest[lane] = farthest < largest[lane] ? farthest : largest[lane];
    };
    std::size_t j = 0;
    for (; j + lanes <= m; j += lanes) {
        for (std::size_t lane = 0; lane < lanes; ++lane) look(j + lane, lane);
    }
    for (; j < m; ++j) look(j, 0);
    return {*std::min_element(least, least + lanes), *std::min_element(largest, largest + lanes)};
}

// Finds the largest squared distance of a voxel of A. The *distance* of a voxel is its distance to the nearest voxel of
// B. The distance between two voxels is the least distance between their points, or the largest if `largest`.
template <bool largest> class VoxelSearch {
public:
    VoxelSearch(const Voxels& a, const Voxels& b, VoxelWork& work) : a_(a), b_(b), work_(work) {
        double magnitude = 0;
        for (const Voxels* voxels : {&a, &b}) {
            for (const auto& lines : voxels->grid)
                magnitude = std::max({magnitude, std::abs(lines.front()), std::abs(lines.back())});
        }
        rounding_ = 64 * unit_roundoff * magnitude;
    }

    double run() {
        if (const auto voxel = middle_voxel(0)) add(0, *voxel, -1);
        while (!queue_.empty()) {
            const Cell cell = queue_.top();
            queue_.pop();
            if (cell.bound < std::sqrt(most_) || work_.stop_after(searches_)) break;
            split(cell);
        }
        return most_;
    }

private:
    // A cell of A that may contain a voxel farther from B than all voxels searched so far.
    struct Cell {
        double bound;  // upper bound on the distances of all its voxels
        std::uint32_t node;
        std::uint32_t voxel;  // one of its voxels, with a known distance
        double squared;       // its square
        bool operator<(const Cell& other) const { return bound < other.bound; }
    };

    // Queues those children of a cell that may contain a voxel farther than the maximum so far. The child that contains
    // the known voxel of the cell takes it over.
    void split(const Cell& cell) {
        const Voxels::Node &node = a_.nodes[cell.node], &voxel = a_.nodes[cell.voxel];
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            if (std::sqrt(cell.squared) * wider + farthest_shift(i, cell.voxel) < std::sqrt(most_)) continue;
            if (holds(a_.nodes[i], voxel))
                add(i, cell.voxel, cell.squared);
            else if (const auto middle = middle_voxel(i))
                add(i, *middle, -1);
        }
    }

    // Queues a cell if it may contain a voxel farther than the maximum so far. `voxel` is one of its voxels, and
    // `squared` the squared distance of this voxel, or negative if it is not known yet.
    void add(std::uint32_t node, std::uint32_t voxel, double squared) {
        const bool is_voxel = a_.nodes[node].size == 1;
        const double farther = is_voxel ? 0 : farthest_shift(node, voxel);
        if (squared < 0) {
            ++searches_;
            // If the voxel is at most this far away, no voxel of the cell can exceed the maximum so far.
            const double early_out = std::sqrt(most_) - farther;
            squared = nearest(a_.box_of(a_.nodes[voxel]), early_out > 0 ? early_out * early_out * narrower : -1);
        }
        if (squared > most_) most_ = squared;
        const double bound = std::sqrt(squared) * wider + farther;
        if (is_voxel || bound < std::sqrt(most_)) return;
        queue_.push({bound, node, voxel, squared});
        ++work_.counters.queue_pushes;
    }

    // Returns an upper bound on the length by which a voxel of A must be moved to reach the farthest voxel of the cell.
    double farthest_shift(std::uint32_t node, std::uint32_t leaf) const {
        const Voxels::Node &cell = a_.nodes[node], &voxel = a_.nodes[leaf];
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto& lines = a_.grid[k];
            const double step = (lines.back() - lines.front()) / double(lines.size() - 1);
            const double d = step * std::max(voxel.at[k] - cell.at[k], cell.at[k] + cell.size - 1 - voxel.at[k]);
            sum += d * d;
        }
        return std::sqrt(sum) * wider + rounding_;
    }

    static bool holds(const Voxels::Node& cell, const Voxels::Node& voxel) {
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k)
            inside = inside && voxel.at[k] >= cell.at[k] && voxel.at[k] < cell.at[k] + cell.size;
        return inside;
    }

    // Returns a voxel near the middle of the cell, in the order of the octree. Returns nothing if the cell has no
    // voxels.
    std::optional<std::uint32_t> middle_voxel(std::uint32_t node) const {
        const Voxels::Node& cell = a_.nodes[node];
        if (cell.size == 1) return node;
        for (std::uint32_t i = 0; i < cell.count; ++i) {
            if (const auto voxel = middle_voxel(cell.first + (i + cell.count / 2) % cell.count)) return voxel;
        }
        return std::nullopt;
    }

    // Returns the squared distance from voxel a to the nearest voxel of B. Stops early once the distance is at most
    // `squared_early_out`; there may then be a nearer voxel.
    double nearest(const Box& a, double squared_early_out) {
        struct Entry {
            double least;
            std::uint32_t node;
        };
        Entry stack[8 * 16];
        std::size_t size = 0;
        stack[size++] = {0, 0};
        double best = infinity;
        while (size > 0 && best > squared_early_out) {
            const Entry entry = stack[--size];
            if (entry.least >= best) continue;
            const Voxels::Node& node = b_.nodes[entry.node];
            const std::size_t begin = size;
            for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
                const Voxels::Node& child = b_.nodes[i];
                if (child.size > 1 && child.count == 0) continue;
                ++work_.counters.box_distances;
                if (child.size == 1) {
                    best = std::min(best, squared_distance<largest>(a, b_.box_of(child)));
                } else if (const double least = at_least<largest>(a, b_, child); least < best) {
                    stack[size++] = {least, i};
                }
            }
            std::sort(stack + begin, stack + size, [](const Entry& x, const Entry& y) { return x.least > y.least; });
        }
        return best;
    }

    const Voxels &a_, &b_;
    VoxelWork& work_;
    double rounding_;  // bounds the rounding errors of grid lines, without which voxels would be exact translates
    std::priority_queue<Cell> queue_;
    double most_ = 0;  // the largest squared distance so far
    std::uint64_t searches_ = 0;
};

}  // namespace

double largest_squared_distance(const Box& a, const Box& b) { return squared_distance<true>(a, b); }

VoxelDistances distances_of_all(const Voxels& a, const Voxels& b, VoxelWork& work) {
    VoxelDistances most;
    for (std::size_t i = 0; i < a.leaves.size(); ++i) {
        if (work.stop_after(i)) break;
        const VoxelDistances nearest = nearest_of_all(a, i, b);
        work.counters.box_distances += b.leaves.size();
        most.least = std::max(most.least, nearest.least);
        most.largest = std::max(most.largest, nearest.largest);
    }
    return most;
}

VoxelDistances distances_by_search(const Voxels& a, const Voxels& b, VoxelWork& work) {
    const double least = VoxelSearch<false>(a, b, work).run();
    return {least, VoxelSearch<true>(a, b, work).run()};
}

}  // namespace hausbench::interval_subdivision
