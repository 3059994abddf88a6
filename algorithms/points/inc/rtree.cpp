#include "algorithms/points/inc/rtree.h"

#include <algorithm>
#include <numeric>

namespace hausbench::inc {
namespace {

// Sorts items so that each group of `capacity` successive items, called a tile, is close together in space and can
// become one node. Sorts by x and cuts the sequence into slabs, sorts each slab by y and cuts it into rows, and sorts
// each row by z. Equal coordinates are ordered by index, so the result depends only on the points.
void tile(std::vector<Index>& items, const Points& centres) {
    const auto sort = [&](std::size_t from, std::size_t to, int axis) {
        const auto at = [&](std::size_t i) { return items.begin() + static_cast<std::ptrdiff_t>(i); };
        std::sort(at(from), at(to), [&](Index i, Index j) {
            return centres(i, axis) != centres(j, axis) ? centres(i, axis) < centres(j, axis) : i < j;
        });
    };
    const std::size_t capacity = RTree::capacity, n = items.size();
    const auto groups = [&](std::size_t count) { return (count + capacity - 1) / capacity; };
    // Returns the number of items per slab (k = 3) or per row (k = 2) when `count` items are cut. It is a multiple of
    // `capacity`, chosen so that the number of slabs or rows is about the k-th root of the number of tiles.
    const auto run = [&](std::size_t count, int k) {
        const std::size_t tiles = groups(count);
        std::size_t runs = 1;
        while ((k == 2 ? runs * runs : runs * runs * runs) < tiles) ++runs;
        return capacity * ((tiles + runs - 1) / runs);
    };
    sort(0, n, 0);
    const std::size_t slab = run(n, 3);
    for (std::size_t x = 0; x < n; x += slab) {
        const std::size_t end = std::min(x + slab, n), row = run(end - x, 2);
        sort(x, end, 1);
        for (std::size_t y = x; y < end; y += row) sort(y, std::min(y + row, end), 2);
    }
}

Points rows_of(const Points& points, const std::vector<Index>& order) {
    Points result(points.rows(), 3);
    for (Index i = 0; i < points.rows(); ++i) result.row(i) = points.row(order[static_cast<std::size_t>(i)]);
    return result;
}

}  // namespace

RTree::RTree(const Points& points) : order_(static_cast<std::size_t>(points.rows())) {
    std::iota(order_.begin(), order_.end(), 0);
    tile(order_, points);
    points_ = rows_of(points, order_);

    const auto pack = [](std::vector<Node>& level, std::int32_t first, std::int32_t count, bool leaf, auto&& add) {
        for (std::int32_t i = 0; i < count; i += capacity) {
            Node node{{}, first + i, std::min(capacity, count - i), leaf};
            for (std::int32_t k = 0; k < node.count; ++k) add(node.box, i + k);
            level.push_back(node);
        }
    };
    std::vector<Node> level;
    pack(level, 0, static_cast<std::int32_t>(points.rows()), true,
         [&](Box& box, Index i) { box.add(Vec3(points_.row(i))); });
    while (level.size() > 1) {
        Points centres(static_cast<Eigen::Index>(level.size()), 3);
        for (std::size_t i = 0; i < level.size(); ++i) {
            centres.row(static_cast<Eigen::Index>(i)) = 0.5 * (level[i].box.low + level[i].box.high);
        }
        std::vector<Index> items(level.size());
        std::iota(items.begin(), items.end(), 0);
        tile(items, centres);
        const auto first = static_cast<std::int32_t>(nodes_.size());
        for (const Index i : items) nodes_.push_back(level[static_cast<std::size_t>(i)]);
        level.clear();
        pack(level, first, static_cast<std::int32_t>(items.size()), false,
             [&](Box& box, Index i) { box.add(nodes_[static_cast<std::size_t>(first + i)].box); });
    }
    nodes_.push_back(level.front());
}

std::size_t RTree::bytes() const {
    return nodes_.capacity() * sizeof(Node) + order_.capacity() * sizeof(Index) +
           static_cast<std::size_t>(points_.size()) * sizeof(double);
}

}  // namespace hausbench::inc
