#include "algorithms/points/scan/point_blocks.h"

#include "algorithms/kernel/posed_box.h"

#include <algorithm>
#include <array>
#include <limits>

namespace hausbench::scan {
namespace {

void set_child(BlockNode& node, std::size_t c, const Box& box) {
    for (std::size_t k = 0; k < 3; ++k) {
        node.low[k][c] = box.low[static_cast<Index>(k)];
        node.high[k][c] = box.high[static_cast<Index>(k)];
    }
}

Box box_of(const PointLeaf& leaf) {
    Box box;
    const double* const axes[] = {leaf.x, leaf.y, leaf.z};
    for (Index k = 0; k < 3; ++k) {
        double low = axes[k][0], high = axes[k][0];
        for (std::size_t i = 1; i < block_points; ++i) {
            low = std::min(low, axes[k][i]);
            high = std::max(high, axes[k][i]);
        }
        box.low[k] = low;
        box.high[k] = high;
    }
    return box;
}

Box box_of(const BlockNode& node) {
    Box box;
    for (std::size_t k = 0; k < 3; ++k) {
        box.low[static_cast<Index>(k)] = *std::min_element(node.low[k], node.low[k] + block_children);
        box.high[static_cast<Index>(k)] = *std::max_element(node.high[k], node.high[k] + block_children);
    }
    return box;
}

std::array<double, 3> first_of(const PointLeaf& leaf) { return {leaf.x[0], leaf.y[0], leaf.z[0]}; }

}  // namespace

std::vector<PointLeaf> leaves_of(const Points& points, const std::vector<Index>* chosen, const MortonFrame& frame) {
    const std::vector<Index> order = morton_order(points, chosen, frame);
    std::vector<PointLeaf> leaves;
    leaves.reserve((order.size() + block_points - 1) / block_points);
    for (std::size_t begin = 0; begin < order.size(); begin += block_points) {
        PointLeaf& leaf = leaves.emplace_back();
        for (std::size_t i = 0; i < block_points; ++i) {
            const Index row = order[std::min(begin + i, order.size() - 1)];
            const double* point = points.row(row).data();
            leaf.x[i] = point[0];
            leaf.y[i] = point[1];
            leaf.z[i] = point[2];
            leaf.row[i] = row;
        }
    }
    return leaves;
}

PointBlocks::PointBlocks(const Points& points) : PointBlocks(points, nullptr, hausbench::box_of(points)) {}

PointBlocks::PointBlocks(const Points& points, const std::vector<Index>* chosen, const Box& box)
    : frame(box), leaves(leaves_of(points, chosen, frame)) {
    keys.reserve(leaves.size());
    for (const PointLeaf& leaf : leaves) keys.push_back(frame.key(first_of(leaf).data()));
    std::size_t total = 0;
    for (std::size_t n = leaves.size(); total == 0 || n > 1;) total += n = (n + block_children - 1) / block_children;
    nodes.reserve(total);
    std::size_t below = leaves.size();  // number of nodes or leaves on the level below
    do {
        const std::size_t begin = nodes.size();
        const std::size_t count = (below + block_children - 1) / block_children;
        for (std::size_t i = 0; i < count; ++i) {
            BlockNode& node = nodes.emplace_back();
            for (std::size_t c = 0; c < block_children; ++c) {
                const std::size_t child = i * block_children + c;
                if (child >= below) {
                    set_child(node, c, {Vec3::Constant(infinity), Vec3::Constant(-infinity)});
                } else {
                    set_child(node, c,
                              level_begin.empty() ? box_of(leaves[child]) : box_of(nodes[level_begin.back() + child]));
                }
            }
        }
        level_begin.push_back(begin);
        below = count;
    } while (below > 1);
}

std::size_t PointBlocks::leaf_at(const double* point) const {
    // If many points lie in one cell of the frame, several leaves have the same key. frame.before() also orders points
    // within a cell, so it tells these leaves apart.
    const auto [from, to] = std::equal_range(keys.begin(), keys.end(), frame.key(point));
    const auto begin = leaves.begin() + (from - keys.begin()), end = leaves.begin() + (to - keys.begin());
    const auto after = std::upper_bound(begin, end, point, [&](const double* p, const PointLeaf& leaf) {
        return frame.before(p, first_of(leaf).data());
    });
    return after == leaves.begin() ? 0 : static_cast<std::size_t>(after - leaves.begin()) - 1;
}

}  // namespace hausbench::scan
