// Triangle adjacency, swept sphere volumes and prepared structures.
#include "algorithms/meshes/tang/adjacency.h"
#include "algorithms/meshes/tang/swept_sphere.h"
#include "algorithms/points/zhang2017/point_octree.h"
#include "algorithms/prepared.h"
#include "algorithms/structures/bvh.h"
#include "tests/support/exact.h"
#include "tests/support/tree_meshes.h"

#include <map>
#include <set>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using namespace tang;
using namespace zhang2017;

TEST(Adjacency, AsByAMapOfEdges) {
    for (const auto& [name, mesh] : tree_meshes()) {
        std::map<std::pair<Index, Index>, std::multiset<Index>> expected;
        for (Index i = 0; i < mesh.triangles.rows(); ++i) {
            for (int k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax({mesh.triangles(i, k), mesh.triangles(i, (k + 1) % 3)});
                expected[{low, high}].insert(i);
            }
        }
        const Adjacency adjacency(mesh);
        ASSERT_EQ(static_cast<std::size_t>(adjacency.edges()), expected.size()) << name;
        for (Index i = 0; i < mesh.triangles.rows(); ++i) {
            for (int k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax({mesh.triangles(i, k), mesh.triangles(i, (k + 1) % 3)});
                const auto& wanted = expected.at({low, high});
                const auto triangles = adjacency.triangles(adjacency.edge(i, k));
                ASSERT_TRUE(std::equal(triangles.begin(), triangles.end(), wanted.begin(), wanted.end())) << name;
            }
        }
        EXPECT_GE(adjacency.bytes(), 24u * static_cast<std::size_t>(mesh.triangles.rows()));
    }
}

TEST(Adjacency, GridHasTheEdgesOfEuler) {
    Random random(1);
    const Adjacency adjacency(triangle_grid(random, 10, 0));
    EXPECT_EQ(adjacency.edges(), 100 + 162 - 1);  // vertices + triangles - 1, for a disc
    int borders = 0;
    for (Index i = 0; i < 162; ++i) {
        for (int k = 0; k < 3; ++k) borders += adjacency.triangles(adjacency.edge(i, k)).size() == 1;
    }
    EXPECT_EQ(borders, 36);
}

// Checks in exact arithmetic that the distances from q to the points are within the volume's bounds.
void expect_bounds(const SweptSphere& volume, const Vec3& q, std::span<const Vec3> points, const std::string& where) {
    const exact::Rational least = distance_at_least(volume, q), most = distance_at_most(volume, q);
    for (const Vec3& point : points) {
        const exact::Rational squared = exact::squared_distance(exact::vector(q), exact::vector(point));
        ASSERT_TRUE(squared >= least * least) << where;
        ASSERT_TRUE(squared <= most * most) << where;
    }
}

TEST(SweptSphere, BoundsHoldExactlyAndAreTight) {
    Random random(2);
    for (int i = 0; i < 400; ++i) {
        const Vec3 size(1, std::pow(10, random.real(-18, 0)), std::pow(10, random.real(-18, 0)));
        const Eigen::Quaterniond turn =
            Eigen::Quaterniond(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1), random.unit()).normalized();
        const Vec3 offset = i % 2 == 0 ? random.vector() : 1e8 * random.vector();
        std::vector<Vec3> points;
        const int count = 1 + random.below(40);
        for (int k = 0; k < count; ++k) points.push_back(turn * random.vector().cwiseProduct(size) + offset);
        const SweptSphere volume = swept_sphere_around(points);
        for (int k = 0; k < 20; ++k) {
            const Vec3 q =
                k % 2 == 0 ? points[static_cast<std::size_t>(random.below(count))] : Vec3(random.vector(3) + offset);
            expect_bounds(volume, q, points, "set " + std::to_string(i));
        }
        // The volume must be thin if the set is thin, not just a ball.
        const double thickness = std::max(std::min(size[1], size[2]), 1e-12 * offset.cwiseAbs().maxCoeff());
        if (count > 10 && thickness < 1e-3) {
            EXPECT_LT(volume.radius, 0.5) << i;
        }
    }
    // A flat rectangle is its own volume.
    std::vector<Vec3> flat;
    for (int i = 0; i < 10; ++i) {
        for (int j = 0; j < 10; ++j) flat.emplace_back(0.1 * j, 0.03 * i, 0);
    }
    EXPECT_LT(swept_sphere_around(flat).radius, 1e-10);
    EXPECT_NEAR(distance_at_least(swept_sphere_around(flat), Vec3(0.3, 0.1, 2)), 2, 1e-10);
}

// The volume's rectangle in exact arithmetic; a parallelogram if u and v are not orthogonal.
struct ExactRectangle {
    exact::RVec3 corner[4];  // in order around the rectangle

    explicit ExactRectangle(const SweptSphere& volume) {
        const exact::RVec3 centre = exact::vector(volume.centre), u = exact::vector(volume.u),
                           v = exact::vector(volume.v);
        for (int k = 0; k < 4; ++k) {
            corner[k] = exact::along(exact::along(centre, k == 0 || k == 3 ? -1 : 1, u), k < 2 ? -1 : 1, v);
        }
    }
    exact::Rational least_squared(const exact::RVec3& p) const {
        return std::min(exact::squared_distance_to_triangle(p, corner[0], corner[1], corner[2]),
                        exact::squared_distance_to_triangle(p, corner[0], corner[2], corner[3]));
    }
    exact::Rational most_squared(const exact::RVec3& p) const {
        exact::Rational most = 0;
        for (const exact::RVec3& c : corner) most = std::max(most, exact::squared_distance(p, c));
        return most;
    }
};

// The sets are flat or straight, so the radius is little more than the rounding of closest points.
TEST(SweptSphere, ThePointsAreWithinTheRadiusOfTheExactRectangle) {
    Random random(5);
    for (int i = 0; i < 400; ++i) {
        const Vec3 at = random.vector(), u = random.vector(), v = i % 2 == 0 ? Vec3(Vec3::Zero()) : random.vector();
        std::vector<Vec3> points;
        for (int k = 0; k < 3 + i % 5; ++k) points.push_back(at + random.real(-1, 1) * u + random.real(-1, 1) * v);
        const SweptSphere volume = swept_sphere_around(points);
        const exact::Rational radius = volume.radius;
        const ExactRectangle rectangle(volume);
        for (const Vec3& point : points) {
            ASSERT_TRUE(rectangle.least_squared(exact::vector(point)) <= radius * radius) << i;
        }
    }
}

// Tries arbitrary volumes, orthogonal or not, some so small that products underflow, and points at any distance.
TEST(SweptSphere, BoundsHoldForTheExactRectangle) {
    Random random(6);
    int told = 0;
    for (int i = 0; i < 20000; ++i) {
        const double scale = i % 5 == 0 ? std::ldexp(1, -500 - static_cast<int>(random.below(40))) : 1;
        SweptSphere volume;
        volume.centre = scale * random.vector();
        volume.u = scale * std::pow(10, random.real(-3, 0)) * random.vector();
        volume.v = scale * std::pow(10, random.real(-3, 0)) * random.vector();
        if (i % 3 != 0)
            volume.v -= dot(volume.v, volume.u / scale) / squared_length(volume.u / scale) * volume.u / scale;
        if (i % 7 == 0) volume.v = Vec3::Zero();
        volume.radius = i % 2 == 0 ? 0 : scale * random.unit();
        Vec3 off = volume.u.cross(volume.v / scale);
        if (off.isZero()) off = scale * random.vector();
        const Vec3 q = volume.centre + random.real(-1.5, 1.5) * volume.u + random.real(-1.5, 1.5) * volume.v +
                       std::pow(10, random.real(-17, 1)) * off;
        const ExactRectangle rectangle(volume);
        const exact::Rational radius = volume.radius, least = distance_at_least(volume, q),
                              most = distance_at_most(volume, q) - radius;
        const exact::RVec3 p = exact::vector(q);
        if (least > 0) {
            ++told;
            ASSERT_TRUE((least + radius) * (least + radius) <= rectangle.least_squared(p)) << i;
        }
        ASSERT_TRUE(most >= 0 && most * most >= rectangle.most_squared(p)) << i;
    }
    EXPECT_GT(told, 2000);
}

TEST(SweptSphere, EveryChildIsAround) {
    int checked = 0;
    for (const auto& [name, mesh] : tree_meshes()) {
        if (mesh.triangles.rows() > 400) continue;
        const SweptSphereBvh bvh(mesh);
        Random random(3);
        // For each node, the corners of all triangles below it, collected from the leaves up.
        std::vector<std::vector<Vec3>> below(bvh.tree().nodes.size());
        for (std::size_t n = below.size(); n-- > 0;) {
            const WideNode& node = bvh.tree().nodes[n];
            for (int c = 0; c < node.count; ++c) {
                std::vector<Vec3> corners;
                if (node.child[c] >= 0) {
                    corners = below[static_cast<std::size_t>(node.child[c])];
                } else {
                    for (const Index i : bvh.tree().leaf(static_cast<std::size_t>(~node.child[c]))) {
                        const Triangle t = triangle_of(mesh, i);
                        corners.insert(corners.end(), {t.a, t.b, t.c});
                    }
                }
                expect_bounds(bvh.volume(n, c), query_near(mesh, random), corners, name);
                below[n].insert(below[n].end(), corners.begin(), corners.end());
                ++checked;
            }
        }
        EXPECT_GT(bvh.bytes(), below.size() * sizeof(SweptSphere));
    }
    EXPECT_GT(checked, 1000);
}

TEST(Prepared, BuildsWhatIsDeclaredAndNamesIt) {
    Random random(4);
    const Scene scene{triangle_soup(random, 50, 0.1), triangle_soup(random, 90, 0.1)};
    const Prepared prepared(scene, {need<TriangleBvh>(Side::target), need<SweptSphereBvh>(Side::source),
                                    need<PointOctree>(Side::target), need<Adjacency>(Side::source)});
    EXPECT_EQ(prepared.get<TriangleBvh>(Side::target).tree().order.size(), 90u);
    EXPECT_EQ(prepared.get<SweptSphereBvh>(Side::source).tree().order.size(), 50u);
    EXPECT_EQ(prepared.get<PointOctree>(Side::target).order().size(), 270u);
    EXPECT_EQ(prepared.get<Adjacency>(Side::source).edges(), 150);
    EXPECT_THROW((void)prepared.get<TriangleBvh>(Side::source), std::logic_error);
    ASSERT_EQ(prepared.times().size(), 4u);
    EXPECT_EQ(prepared.times()[0].name, "target BVH");
    for (const PreparationTime& time : prepared.times()) EXPECT_GT(time.bytes, 0u) << time.name;
    EXPECT_EQ(prepared.uses().at("target BVH"), 1);
    EXPECT_TRUE(structure_kind<PointOctree>().fits(ShapeKind::points));
    EXPECT_TRUE(structure_kind<PointOctree>().fits(ShapeKind::mesh));
    EXPECT_FALSE(structure_kind<PointOctree>().fits(ShapeKind::surface));
    EXPECT_TRUE(structure_kind<TriangleBvh>().fits(ShapeKind::points));
    EXPECT_FALSE(structure_kind<Adjacency>().fits(ShapeKind::points));
}

// A structure defined outside the library, with parameters.
struct EveryNth {
    static constexpr std::string_view structure_name = "every n-th point";
    static constexpr int structure_layout = 1;
    struct Parameters {
        Index n = 2;
        std::string text() const { return "n = " + std::to_string(n); }
    };
    EveryNth(const Points& points, const Parameters& parameters) {
        for (Index i = 0; i < points.rows(); i += parameters.n) chosen.push_back(i);
        ++built;
    }
    std::size_t bytes() const { return chosen.size() * sizeof(Index); }
    std::vector<Index> chosen;
    static int built;
};
int EveryNth::built = 0;

TEST(Prepared, StructuresBelongToShapesAndToTheirParameters) {
    Random random(5);
    const Shape small = triangle_soup(random, 10, 0.1), large = triangle_soup(random, 20, 0.1);
    const auto first = std::make_shared<PreparedShape>(small), second = std::make_shared<PreparedShape>(large);
    const Prepared there(first, second, {need<EveryNth>(Side::source), need<EveryNth>(Side::target, {3})});
    EXPECT_EQ(EveryNth::built, 2);
    EXPECT_EQ(there.get<EveryNth>(Side::source).chosen.size(), 15u);
    EXPECT_EQ(there.get<EveryNth>(Side::target, {3}).chosen.size(), 20u);
    EXPECT_THROW((void)there.get<EveryNth>(Side::target), std::logic_error);
    // With the shapes swapped, one of the two structures exists already and is shared.
    const Prepared back(second, first, {need<EveryNth>(Side::target), need<EveryNth>(Side::source)});
    EXPECT_EQ(EveryNth::built, 3);
    EXPECT_EQ(&back.get<EveryNth>(Side::target), &there.get<EveryNth>(Side::source));
    EXPECT_EQ(back.times()[0].seconds, there.times()[0].seconds);
    EXPECT_EQ(back.times()[0].bytes, 15 * sizeof(Index));
    EXPECT_EQ(back.times()[0].name, "target every n-th point (n = 2)");
}

}  // namespace
}  // namespace hausbench
