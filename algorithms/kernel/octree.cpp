#include "octree.h"

#include "rounding.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hausbench {
namespace {

// Keeps the smaller squared distance; among equals the lower index.
void offer(ClosestPoint& best, const TrianglePoint& candidate, Index triangle) {
    const double squared = candidate.squared_distance;
    if (squared > best.squared_distance) return;
    if (squared == best.squared_distance && best.triangle >= 0 && best.triangle < triangle) return;
    best = {squared, candidate.point, triangle};
}

// Lowers `least` to what is certain of this triangle. One whose box is beyond the nearest is at least as far as that.
void certify(const Vec3& point, const Triangle& triangle, double nearest, double& least, Counters& counters) {
    if (squared_distance_to_box(point, box_of(triangle)) > nearest) return;
    ++counters.point_triangle_distances;
    const TrianglePoint foot = closest_point(point, triangle);
    least = std::min(least, distance_certainly_at_least(point, triangle, foot.point));
}

}  // namespace

ClosestPoint closest_by_scan(const TriangleMesh& mesh, const Vec3& point, const ClosestHints& hints, Counters& counters) {
    ++counters.closest_point_queries;
    ClosestPoint best;
    best.squared_distance = hints.squared_radius;
    for (Index i = 0; i < mesh.triangles.rows(); ++i) {
        ++counters.point_triangle_distances;
        offer(best, closest_point(point, triangle_of(mesh, i)), i);
        if (best.triangle >= 0 && best.squared_distance <= hints.squared_enough) break;
    }
    return best;
}

double certified_distance_by_scan(const TriangleMesh& mesh, const Vec3& point, Counters& counters) {
    const double nearest = closest_by_scan(mesh, point, {}, counters).squared_distance;
    double least = distance_at_least(nearest, true);
    for (Index i = 0; i < mesh.triangles.rows(); ++i) {
        certify(point, triangle_of(mesh, i), nearest, least, counters);
    }
    return least;
}

struct TriangleOctree::Builder {
    TriangleOctree& tree;
    std::vector<Box> boxes;
    std::vector<Vec3> centres;
    std::vector<Index> scratch;

    // Fills node `at` with order_[first, first + count), whose centres lie in the cube around `centre`.
    void build(std::int32_t at, std::int32_t first, std::int32_t count, Vec3 centre, double half, int depth) {
        std::vector<Index>& order = tree.order_;
        Box box;
        for (std::int32_t i = first; i < first + count; ++i) box.add(boxes[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])]);
        tree.nodes_[static_cast<std::size_t>(at)] = {box, 0, 0, first, count};

        std::array<std::int32_t, 9> begin{};
        const auto octant = [&](Index triangle) {
            const Vec3& c = centres[static_cast<std::size_t>(triangle)];
            return (c[0] >= centre[0] ? 1 : 0) + (c[1] >= centre[1] ? 2 : 0) + (c[2] >= centre[2] ? 4 : 0);
        };
        const auto step = [&](int k) {
            return Vec3((k & 1) != 0 ? half : -half, (k & 2) != 0 ? half : -half, (k & 4) != 0 ? half : -half);
        };
        // Cells that would have a single child are passed over.
        while (count > leaf_size && depth < max_depth) {
            begin.fill(0);
            for (std::int32_t i = first; i < first + count; ++i) ++begin[static_cast<std::size_t>(octant(order[static_cast<std::size_t>(i)])) + 1];
            ++depth;
            half *= 0.5;
            const auto all = std::find(begin.begin() + 1, begin.end(), count);
            if (all == begin.end()) break;
            centre += step(static_cast<int>(all - begin.begin()) - 1);
        }
        const bool split = std::count_if(begin.begin() + 1, begin.end(), [](std::int32_t n) { return n > 0; }) > 1;
        if (!split) {
            std::sort(order.begin() + first, order.begin() + first + count);
            return;
        }

        for (std::size_t k = 0; k < 8; ++k) begin[k + 1] += begin[k];
        std::array<std::int32_t, 9> next = begin;
        std::copy_n(order.begin() + first, count, scratch.begin());
        for (std::int32_t i = 0; i < count; ++i) {
            const Index triangle = scratch[static_cast<std::size_t>(i)];
            order[static_cast<std::size_t>(first + next[static_cast<std::size_t>(octant(triangle))]++)] = triangle;
        }
        std::int32_t children = 0;
        for (std::size_t k = 0; k < 8; ++k) children += begin[k + 1] > begin[k];
        auto child = static_cast<std::int32_t>(tree.nodes_.size());
        tree.nodes_[static_cast<std::size_t>(at)].first_child = child;
        tree.nodes_[static_cast<std::size_t>(at)].child_count = children;
        tree.nodes_.resize(tree.nodes_.size() + static_cast<std::size_t>(children));
        for (std::size_t k = 0; k < 8; ++k) {
            if (begin[k + 1] == begin[k]) continue;
            build(child++, first + begin[k], begin[k + 1] - begin[k], centre + step(static_cast<int>(k)), half, depth);
        }
    }
};

TriangleOctree::TriangleOctree(const TriangleMesh& mesh) : mesh_(&mesh) {
    const auto count = static_cast<std::size_t>(mesh.triangles.rows());
    Builder builder{*this, std::vector<Box>(count), std::vector<Vec3>(count), std::vector<Index>(count)};
    order_.resize(count);
    Box all;
    for (std::size_t i = 0; i < count; ++i) {
        order_[i] = static_cast<Index>(i);
        builder.boxes[i] = box_of(triangle_of(mesh, static_cast<Index>(i)));
        builder.centres[i] = 0.5 * (builder.boxes[i].low + builder.boxes[i].high);
        all.add(builder.centres[i]);
    }
    nodes_.resize(1);
    const double half = 0.5 * (all.high - all.low).maxCoeff();
    builder.build(0, 0, static_cast<std::int32_t>(count), 0.5 * (all.low + all.high), half, 0);
    nodes_.shrink_to_fit();
    triangles_.reserve(count);
    for (const Index triangle : order_) triangles_.push_back(triangle_of(mesh, triangle));
}

// Calls leaf(node) for the leaves whose box is no farther than `bound` (squared; the leaf may lower it), nearest first.
// The walk ends when leaf() returns false.
template <class Leaf>
void TriangleOctree::traverse(const Vec3& point, const double& bound, Counters& counters, Leaf&& leaf) const {
    struct Entry {
        double squared;
        std::int32_t node;
    };
    std::array<Entry, 8 * (max_depth + 1)> stack;
    std::size_t size = 0;
    stack[size++] = {squared_distance_to_box(point, nodes_[0].box), 0};
    ++counters.node_visits;
    while (size > 0) {
        const Entry entry = stack[--size];
        if (entry.squared > bound) continue;
        const Node& node = nodes_[static_cast<std::size_t>(entry.node)];
        if (node.child_count == 0) {
            if (!leaf(node)) return;
            continue;
        }
        // Insertion sort, farthest first, so that the nearest is popped first.
        const std::size_t base = size;
        for (std::int32_t child = node.first_child; child < node.first_child + node.child_count; ++child) {
            ++counters.node_visits;
            const double squared = squared_distance_to_box(point, nodes_[static_cast<std::size_t>(child)].box);
            if (squared > bound) continue;
            std::size_t place = size++;
            for (; place > base && stack[place - 1].squared < squared; --place) stack[place] = stack[place - 1];
            stack[place] = {squared, child};
        }
    }
}

ClosestPoint TriangleOctree::closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const {
    ++counters.closest_point_queries;
    ClosestPoint best;
    best.squared_distance = hints.squared_radius;
    if (hints.warm_triangle >= 0) {
        ++counters.point_triangle_distances;
        offer(best, closest_point(point, triangle_of(*mesh_, hints.warm_triangle)), hints.warm_triangle);
        if (best.triangle >= 0 && best.squared_distance <= hints.squared_enough) return best;
    }
    traverse(point, best.squared_distance, counters, [&](const Node& node) {
        for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
            const auto at = static_cast<std::size_t>(i);
            if (order_[at] == hints.warm_triangle) continue;
            if (squared_distance_to_box(point, box_of(triangles_[at])) > best.squared_distance) continue;
            ++counters.point_triangle_distances;
            offer(best, closest_point(point, triangles_[at]), order_[at]);
            if (best.triangle >= 0 && best.squared_distance <= hints.squared_enough) return false;
        }
        return true;
    });
    return best;
}

double TriangleOctree::certified_distance(const Vec3& point, Counters& counters) const {
    const double nearest = closest(point, {}, counters).squared_distance;
    double least = distance_at_least(nearest, true);
    traverse(point, nearest, counters, [&](const Node& node) {
        for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
            certify(point, triangles_[static_cast<std::size_t>(i)], nearest, least, counters);
        }
        return true;
    });
    return least;
}

std::size_t TriangleOctree::bytes() const {
    return nodes_.capacity() * sizeof(Node) + order_.capacity() * sizeof(Index) +
           triangles_.capacity() * sizeof(Triangle);
}

}  // namespace hausbench
