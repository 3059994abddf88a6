// The octree and the R-tree over points, which must lose no point, and bounds of computed distances.
#include "algorithms/kernel/posed_box.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/inc/rtree.h"
#include "algorithms/points/zhang2017/octree_cursor.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

#include <gtest/gtest.h>

#include <set>

namespace hausbench {
namespace {

using namespace inc;
using namespace zhang2017;

std::vector<Points> point_sets() {
    Random random(31);
    std::vector<Points> sets = {rows({{1, 2, 3}}), Points::Constant(40, 3, 0.25), cloud(random, 1), cloud(random, 500),
                                lattice(9, 0)};
    Points pairs(200, 3);  // each point twice, an ulp apart
    for (Index i = 0; i < 100; ++i) {
        pairs.row(2 * i) = random.vector();
        pairs.row(2 * i + 1) = pairs.row(2 * i).unaryExpr([](double x) { return std::nextafter(x, 9.0); });
    }
    Points line = Points::Zero(300, 3), clusters(400, 3);
    for (Index i = 0; i < 300; ++i) line(i, 1) = i * 0.1;
    for (Index i = 0; i < 400; ++i)
        clusters.row(i) = random.vector(std::pow(10.0, -random.below(300))) + random.below(3) * Vec3::Ones();
    for (const Points& more : {pairs, line, clusters}) sets.push_back(more);
    return sets;
}

bool inside(const Vec3& p, const Box& box) {
    return (p.array() >= box.low.array()).all() && (p.array() <= box.high.array()).all();
}

template <class Tree> void expect_all_points(const Tree& tree, const Points& points) {
    ASSERT_EQ(tree.order().size(), static_cast<std::size_t>(points.rows()));
    EXPECT_EQ(std::set<Index>(tree.order().begin(), tree.order().end()).size(), tree.order().size());
    for (Index i = 0; i < points.rows(); ++i) {
        EXPECT_EQ(Vec3(tree.points().row(i)), Vec3(points.row(tree.order()[static_cast<std::size_t>(i)])));
    }
}

TEST(PointOctree, HoldsEachPointInEachOfItsCells) {
    for (const Points& points : point_sets()) {
        const PointOctree tree(points);
        expect_all_points(tree, points);
        EXPECT_LT(tree.nodes().size(), 2 * static_cast<std::size_t>(points.rows()) + 1);
        std::int32_t leaves = 0;
        for (const PointOctree::Node& node : tree.nodes()) {
            for (std::int32_t k = node.first; k < node.first + node.count; ++k)
                EXPECT_TRUE(inside(tree.points().row(k), node.cell));
            std::int32_t sum = 0, next = node.first;
            for (std::int32_t k = node.first_child; k < node.first_child + node.child_count; ++k) {
                const PointOctree::Node& child = tree.nodes()[static_cast<std::size_t>(k)];
                EXPECT_GT(child.depth, node.depth);
                EXPECT_EQ(child.first, next);
                next += child.count;
                sum += child.count;
            }
            if (node.child_count == 0)
                leaves += node.count;
            else
                EXPECT_EQ(sum, node.count);
        }
        EXPECT_EQ(leaves, points.rows());
    }
}

// A tree limited to a depth must be the full tree without the cells below it, so that NOHD sees the same cells.
TEST(PointOctree, EndsAtTheDepthAskedFor) {
    for (const Points& points : point_sets()) {
        const PointOctree full(points);
        for (const int deepest : {0, 1, 4}) {
            const PointOctree tree(points, PointOctree::root_around(points), deepest);
            expect_all_points(tree, points);
            std::size_t above = 0;
            for (const PointOctree::Node& node : full.nodes()) above += node.depth < deepest && node.child_count > 0;
            std::size_t split = 0;
            for (const PointOctree::Node& node : tree.nodes()) {
                split += node.child_count > 0;
                EXPECT_TRUE(node.child_count == 0 || node.depth < deepest);
            }
            EXPECT_EQ(split, above) << "down to " << deepest;
        }
    }
}

TEST(PointOctree, CursorsCoverTheFullOctree) {
    for (const Points& points : point_sets()) {
        const PointOctree tree(points);
        for (const int depth : {0, 1, 4}) {
            std::vector<Cursor> level{root_of(tree)};
            for (int d = 0; d < depth; ++d) {
                std::vector<Cursor> next;
                for (const Cursor& at : level)
                    for_each_part(tree, at, [&](const Cursor& part) { next.push_back(part); });
                level = next;
            }
            std::int32_t held = 0;
            const double side = (tree.root_cell().high - tree.root_cell().low).maxCoeff() / (1 << depth);
            for (const Cursor& at : level) {
                EXPECT_EQ(at.depth, depth);
                EXPECT_NEAR((at.cell.high - at.cell.low).maxCoeff(), side, 1e-9 * side);
                const PointOctree::Node& node = tree.nodes()[static_cast<std::size_t>(at.node)];
                for (std::int32_t k = node.first; k < node.first + node.count; ++k)
                    EXPECT_TRUE(inside(tree.points().row(k), at.cell));
                held += node.count;
            }
            EXPECT_EQ(held, points.rows());
        }
    }
}

TEST(RTree, BoxesAreTightAndFull) {
    for (const Points& points : point_sets()) {
        const RTree tree(points);
        expect_all_points(tree, points);
        std::int32_t held = 0, children = 0;
        for (const RTree::Node& node : tree.nodes()) {
            Box box;
            ASSERT_GT(node.count, 0);
            ASSERT_LE(node.count, RTree::capacity);
            for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
                if (node.leaf)
                    box.add(Vec3(tree.points().row(k)));
                else
                    box.add(tree.nodes()[static_cast<std::size_t>(k)].box);
            }
            (node.leaf ? held : children) += node.count;
            EXPECT_EQ(box.low, node.box.low);
            EXPECT_EQ(box.high, node.box.high);
        }
        EXPECT_EQ(held, points.rows());
        EXPECT_EQ(static_cast<std::size_t>(children) + 1, tree.nodes().size());
    }
}

// The bounds of moved boxes must contain the computed coordinates and distances of the moved points, to the bit.
TEST(PosedBox, BoundsComputedDistances) {
    Random random(32);
    for (int i = 0; i < 2000; ++i) {
        const double size = std::pow(10.0, -random.below(9));
        Points a = cloud(random, 12, size), b = cloud(random, 12, size);
        a.rowwise() += random.vector().transpose();
        Pose pose;
        if (i % 4 != 0) pose = turned(0.6, 0.8, random.vector());
        if (i % 4 == 2) pose.rotation *= random.real(-3, 3);
        const Points moved = posed(a, pose);
        const Box within = box_of(moved), box = posed_box(box_of(a), pose, within), other = box_of(b);
        for (Index k = 0; k < 12; ++k) {
            ASSERT_TRUE(inside(moved.row(k), box));
            for (Index j = 0; j < 12; ++j) {
                const double squared = squared_distance(moved.row(k).data(), b.row(j).data());
                ASSERT_LE(squared_distance_at_least(box, other), squared);
                ASSERT_GE(squared_distance_at_most(box, other), squared);
                ASSERT_GE(squared_distance_at_most(Vec3(b.row(j)), box), squared);
                ASSERT_LE(squared_distance_to_box(b.row(j), box), squared);
            }
        }
    }
    // A corner of the moved box overflows, although no point does; the bounds must stay finite.
    Pose wild;
    wild.rotation.setConstant(1e300);
    const Points far = rows({{-1e10, 1e10, 0}, {1e10, -1e10, 0}});
    const Box box = posed_box(box_of(far), wild, box_of(rows({{0, 0, 0}})));
    EXPECT_EQ(box.low, Vec3::Zero());
    EXPECT_EQ(box.high, Vec3::Zero());
}

}  // namespace
}  // namespace hausbench
