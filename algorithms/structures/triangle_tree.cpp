#include "algorithms/structures/triangle_tree.h"

#include "algorithms/kernel/pages.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/textbook.h"

#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/structures/triangle_tree.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include "algorithms/structures/nearest-inl.h"
#include "algorithms/structures/wide_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {

// Computes the distances to the triangles of leaf i whose boxes are within best.squared_distance, and updates `best`.
// The choice of triangles depends only on `best` before the call, so the counters are the same for every vector width.
//
// Each triangle keeps its lane, even if others in the vector are skipped, so the corners can be loaded before the
// distances to the boxes are known. Not inlined, so that the calling loop keeps its registers.
static HWY_NOINLINE void offer_leaf(const Vec3& point, const TriangleLeaves& leaves, std::size_t i, ClosestPoint& best,
                                    Counters& counters) {
    const Doubles d;
    const TriangleLeaf& leaf = leaves.leaf[i];
    const double* vertices = leaves.vertices + 3 * std::size_t{leaf.first_vertex};
    for (int line = 0; line < 4; ++line) hwy::Prefetch(vertices + 8 * line);  // most leaves have up to 10 vertices
    unsigned mask = (1U << leaf.count) - 1;
    if (best.squared_distance < std::numeric_limits<double>::infinity()) {
        BoxDistances distances;
        mask = near_boxes(leaf.boxes, leaf.count, point, best.squared_distance, distances);
    }
    counters.point_triangle_distances += static_cast<std::uint64_t>(std::popcount(mask));
    const V3 p = set(point);
    for (std::size_t lane = 0; lane < leaf_capacity; lane += hn::Lanes(d)) {
        const unsigned near = mask >> lane & ((1U << hn::Lanes(d)) - 1);
        if (near == 0) continue;
        const double* place[3][4];
        for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
            for (int v = 0; v < 3; ++v) place[v][k] = vertices + leaf.corner[v][lane + k];
        }
        const V3 a = gather(place[0]), b = gather(place[1]), c = gather(place[2]);
        const VFoot foot = closest_point(p, a, b, c, box_of(a, b, c));
        offer_nearest(foot, near, leaves.order + leaf.first + lane, best);
    }
}

unsigned tree_leaf_distances(const TriangleLeaves& leaves, std::size_t i, const std::array<Vec3, 3>& points,
                             const Vec3& centre, double squared_radius, double (&squared)[3][leaf_capacity]) {
    const Doubles d;
    const TriangleLeaf& leaf = leaves.leaf[i];
    const double* vertices = leaves.vertices + 3 * std::size_t{leaf.first_vertex};
    BoxDistances distances;
    const unsigned mask = near_boxes(leaf.boxes, leaf.count, centre, squared_radius, distances);
    for (std::size_t lane = 0; lane < leaf_capacity; lane += hn::Lanes(d)) {
        if ((mask >> lane & ((1U << hn::Lanes(d)) - 1)) == 0) continue;
        const double* place[3][4];
        for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
            for (int v = 0; v < 3; ++v) place[v][k] = vertices + leaf.corner[v][lane + k];
        }
        const V3 a = gather(place[0]), b = gather(place[1]), c = gather(place[2]);
        for (std::size_t k = 0; k < 3; ++k)
            hn::StoreU(closest_point(set(points[k]), a, b, c, box_of(a, b, c)).squared, d, squared[k] + lane);
    }
    return mask;
}

// Finds the closest triangle. Starts with `first_leaf`, the leaf of ClosestHints::warm_triangle, if it is near
// (negative: there is none), else with the leaf that a descent from the root finds. "Near" is relative to the length of
// the longest edge of the leaf's first triangle:
//   - If a corner of this triangle is farther from the point than twice this length, the leaf is not tried.
//   - If the nearest triangle of the leaf is farther than this length, the descent follows, because searching with so
//     large a radius takes longer than finding a better leaf.
void tree_closest(const WideTree& tree, const TriangleLeaves& leaves, const Vec3& point, double early_out_squared,
                  std::int32_t first_leaf, ClosestPoint& best, Counters& counters) {
    const auto early_out = [&] { return best.triangle >= 0 && best.squared_distance <= early_out_squared; };
    auto first = static_cast<std::size_t>(first_leaf);
    bool searched = false;
    if (first_leaf >= 0) {
        const Triangle triangle = leaves.leaf[first_leaf].at(0, leaves.vertices);
        const double squared_size = squared_length(triangle.b - triangle.a);
        if (squared_length(point - triangle.a) <= 4 * squared_size) {
            offer_leaf(point, leaves, first, best, counters);
            if (early_out()) return;
            searched = best.squared_distance <= squared_size;
        }
    }
    Walk walk(tree, leaves.leaf, point, counters.node_visits);
    if (!searched) {
        first = walk.greedy_descent();
        offer_leaf(point, leaves, first, best, counters);
        if (early_out()) return;
    }
    walk.visit_leaves(best.squared_distance, [&](std::size_t leaf, double& squared) HWY_ATTR {
        if (leaf == first) return true;
        offer_leaf(point, leaves, leaf, best, counters);
        squared = best.squared_distance;
        return !early_out();
    });
}

void tree_textbook(const WideTree& tree, const TriangleLeaves& leaves, const Vec3& point, double early_out_squared,
                   ClosestPoint& best, Counters& counters) {
    Walk(tree, leaves.leaf, point, counters.node_visits)
        .visit_leaves(best.squared_distance, [&](std::size_t number, double& squared) HWY_ATTR {
            const TriangleLeaf& leaf = leaves.leaf[number];
            for (int i = 0; i < leaf.count; ++i) {
                ++counters.point_triangle_distances;
                const TrianglePoint foot = textbook_closest_point(point, leaf.at(i, leaves.vertices));
                if (foot.squared_distance <= best.squared_distance) offer(best, foot, leaves.order[leaf.first + i]);
            }
            squared = best.squared_distance;
            return best.triangle < 0 || best.squared_distance > early_out_squared;
        });
}

void tree_certify(const WideTree& tree, const TriangleLeaves& leaves, const Vec3& point, double nearest, double& least,
                  Counters& counters) {
    Walk(tree, leaves.leaf, point, counters.node_visits)
        .visit_leaves(nearest, [&](std::size_t number, double&) HWY_ATTR {
            const TriangleLeaf& leaf = leaves.leaf[number];
            BoxDistances distances;
            for (unsigned mask = near_boxes(leaf.boxes, leaf.count, point, nearest, distances); mask != 0;
                 mask &= mask - 1) {
                certify(point, leaf.at(std::countr_zero(mask), leaves.vertices), nearest, least, counters);
            }
            return true;
        });
}

}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench {

HWY_EXPORT(tree_closest);
HWY_EXPORT(tree_leaf_distances);
HWY_EXPORT(tree_textbook);
HWY_EXPORT(tree_certify);

TriangleTree::TriangleTree(const TriangleMesh& mesh, WideTree&& tree) : mesh_(&mesh), tree_(std::move(tree)) {
    leaf_of_ = filled<std::int32_t>(tree_.order.size());
    for (std::size_t i = 0; i < tree_.leaves(); ++i) {
        for (const Index triangle : tree_.leaf(i))
            leaf_of_[static_cast<std::size_t>(triangle)] = static_cast<std::int32_t>(i);
    }
    fill_leaves();
}

void TriangleTree::fill_leaves() {
    const std::size_t leaves = tree_.leaves();
    leaves_ = std::make_unique_for_overwrite<TriangleLeaf[]>(leaves);  // every byte that is used is written below
    touch_pages(leaves_.get(), leaves * sizeof(TriangleLeaf));
    auto boxes = filled<Box>(leaves);
    std::uint32_t vertices = 0;
    const auto make_room = [&](std::size_t room) {
        auto larger = std::make_unique_for_overwrite<double[]>(3 * room);
        touch_pages(larger.get(), 3 * room * sizeof(double));
        std::copy_n(vertices_.get(), 3 * std::size_t{vertices}, larger.get());
        vertices_ = std::move(larger);
        vertex_room_ = room;
    };
    constexpr std::size_t most = 3 * leaf_capacity;  // a leaf has no more vertices than this
    // Most meshes take up to 1.4 vertices per triangle. If a mesh takes more, the array grows. The new estimate assumes
    // that the remaining leaves have as many vertices, on average, as the leaves so far.
    make_room(tree_.order.size() * 7 / 5 + most);
    for (std::size_t i = 0; i < leaves; ++i) {
        if (vertices + most > vertex_room_) make_room(vertices + (vertices / i + 1) * (leaves - i) + most);
        // The triangles of a leaf may be anywhere in the mesh. So prefetch their vertex indices four leaves ahead, and
        // the vertices themselves two leaves ahead.
        if (i + 4 < leaves) {
            for (const Index next : tree_.leaf(i + 4)) __builtin_prefetch(mesh_->triangles.row(next).data());
            for (const Index next : tree_.leaf(i + 2)) {
                for (const Index corner : mesh_->triangles.row(next))
                    __builtin_prefetch(mesh_->vertices.row(corner).data());
            }
        }
        leaves_[i].first = tree_.leaf_begin[i];
        boxes[i] = leaves_[i].set(*mesh_, tree_.leaf(i), vertices_.get(), vertices);
    }
    if (vertex_room_ > vertices + vertices / 16) make_room(vertices);
    tree_.fit(boxes);
}

ClosestPoint TriangleTree::closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const {
    ++counters.closest_point_queries;
    ClosestPoint best;
    best.squared_distance = hints.squared_radius;
    const std::int32_t first = hints.warm_triangle >= 0 ? leaf_of_[static_cast<std::size_t>(hints.warm_triangle)] : -1;
    HWY_DYNAMIC_DISPATCH(tree_closest)
    (tree_, {leaves_.get(), vertices_.get(), tree_.order.data()}, point, hints.early_out_squared, first, best,
     counters);
    return best;
}

ClosestPoint TriangleTree::textbook_closest(const Vec3& point, const ClosestHints& hints, Counters& counters) const {
    ++counters.closest_point_queries;
    ClosestPoint best;
    best.squared_distance = hints.squared_radius;
    HWY_DYNAMIC_DISPATCH(tree_textbook)
    (tree_, {leaves_.get(), vertices_.get(), tree_.order.data()}, point, hints.early_out_squared, best, counters);
    return best;
}

double TriangleTree::certified_distance(const Vec3& point, Counters& counters) const {
    const double nearest = closest(point, {}, counters).squared_distance;
    double least = distance_at_least(nearest, true);
    HWY_DYNAMIC_DISPATCH(tree_certify)
    (tree_, {leaves_.get(), vertices_.get(), tree_.order.data()}, point, nearest, least, counters);
    return least;
}

unsigned TriangleTree::leaf_distances(std::size_t leaf, const std::array<Vec3, 3>& points, const Vec3& centre,
                                      double squared_radius, double (&squared)[3][leaf_capacity]) const {
    return HWY_DYNAMIC_DISPATCH(tree_leaf_distances)({leaves_.get(), vertices_.get(), tree_.order.data()}, leaf, points,
                                                     centre, squared_radius, squared);
}

std::size_t TriangleTree::bytes() const {
    return tree_.bytes() + tree_.leaves() * sizeof(TriangleLeaf) + 3 * vertex_room_ * sizeof(double) +
           leaf_of_.capacity() * sizeof(std::int32_t);
}

}  // namespace hausbench
#endif
