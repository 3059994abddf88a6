#include "algorithms/points/zhang2017/point_octree.h"

#include "algorithms/kernel/posed_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace hausbench::zhang2017 {
namespace {

double middle_of(double low, double high) { return low + 0.5 * (high - low); }

// Returns a cube that contains the box and shares its low corner. If rounding makes the cube too small, its high corner
// is raised to the high corner of the box.
Box cube_around(const Box& box) {
    const double side = (box.high - box.low).maxCoeff();
    return {box.low, (box.low + Vec3::Constant(side)).cwiseMax(box.high)};
}

}  // namespace

int octant_of(const Box& cell, const Vec3& point) {
    int octant = 0;
    for (int k = 0; k < 3; ++k) octant |= point[k] >= middle_of(cell.low[k], cell.high[k]) ? 1 << k : 0;
    return octant;
}

Box part_of(const Box& cell, int octant) {
    Box part = cell;
    for (int k = 0; k < 3; ++k) ((octant >> k) & 1 ? part.low : part.high)[k] = middle_of(cell.low[k], cell.high[k]);
    return part;
}

Box PointOctree::root_around(const Points& points) { return cube_around(box_of(points)); }

PointOctree::PointOctree(const Points& points) : PointOctree(points, root_around(points)) {}

PointOctree::PointOctree(const Points& points, const Box& root_cell, int deepest)
    : deepest_(deepest), root_cell_(root_cell), order_(static_cast<std::size_t>(points.rows())), points_(points) {
    std::iota(order_.begin(), order_.end(), 0);
    scratch_.resize(order_.size());
    nodes_.reserve(2 * order_.size());
    nodes_.emplace_back();
    build(0, 0, static_cast<std::int32_t>(points.rows()), root_cell_, 0);
    nodes_.shrink_to_fit();
    for (Index i = 0; i < points.rows(); ++i) points_.row(i) = points.row(order_[static_cast<std::size_t>(i)]);
    scratch_ = {};
}

void PointOctree::build(std::int32_t at, std::int32_t first, std::int32_t count, Box cell, int depth) {
    const auto begin = order_.begin() + first, end = begin + count;
    const auto point = [&](Index i) { return Vec3(points_.row(i)); };
    std::array<std::int32_t, 9> starts{};
    int parts = 0;
    while (depth < deepest_ && count > 1) {
        starts.fill(0);
        for (auto i = begin; i != end; ++i) ++starts[static_cast<std::size_t>(octant_of(cell, point(*i))) + 1];
        parts = static_cast<int>(std::count_if(starts.begin() + 1, starts.end(), [](std::int32_t n) { return n > 0; }));
        if (parts > 1) break;
        const bool same = std::all_of(begin, end, [&](Index i) { return point(i) == point(*begin); });
        if (same) break;
        cell = part_of(cell, octant_of(cell, point(*begin)));
        ++depth;
    }
    nodes_[static_cast<std::size_t>(at)] = {cell, depth, 0, 0, first, count};
    if (parts < 2) return;

    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    auto next = starts;
    for (auto i = begin; i != end; ++i) {  // keeps the order of the points within an octant
        const auto octant = static_cast<std::size_t>(octant_of(cell, point(*i)));
        scratch_[static_cast<std::size_t>(first + next[octant]++)] = *i;
    }
    std::copy(scratch_.begin() + first, scratch_.begin() + first + count, begin);
    const auto child = static_cast<std::int32_t>(nodes_.size());
    nodes_[static_cast<std::size_t>(at)].first_child = child;
    nodes_[static_cast<std::size_t>(at)].child_count = parts;
    nodes_.resize(nodes_.size() + static_cast<std::size_t>(parts));
    std::int32_t number = child;
    for (std::size_t octant = 0; octant < 8; ++octant) {
        const std::int32_t from = starts[octant], to = starts[octant + 1];
        if (from < to) build(number++, first + from, to - from, part_of(cell, static_cast<int>(octant)), depth + 1);
    }
}

std::size_t PointOctree::bytes() const {
    return nodes_.capacity() * sizeof(Node) + order_.capacity() * sizeof(Index) +
           static_cast<std::size_t>(points_.size()) * sizeof(double);
}

}  // namespace hausbench::zhang2017
