// Small scenes, tame and hostile, that every solver must answer.
#pragma once

#include "algorithms/scene.h"
#include "tests/support/random.h"

#include <string>
#include <vector>

namespace hausbench {

struct TestScene {
    std::string name;
    Scene scene;
    std::vector<Pose> poses;  // the identity comes first
};

inline Points rows(std::initializer_list<Vec3> list) {
    Points points(static_cast<Index>(list.size()), 3);
    Index i = 0;
    for (const Vec3& v : list) points.row(i++) = v;
    return points;
}

// Returns the surface in the cube [-2, 2]^3.
inline AlgebraicSurface surface_in_cube(const std::string& polynomial) {
    AlgebraicSurface s{polynomial, Points(2, 3)};
    s.box.row(0).setConstant(-2);
    s.box.row(1).setConstant(2);
    return s;
}

inline Points cloud(Random& random, Index count, double size = 1) {
    Points points(count, 3);
    for (Index i = 0; i < count; ++i) points.row(i) = random.vector(size);
    return points;
}

inline Points lattice(Index n, double z) {
    Points points(n * n, 3);
    for (Index i = 0; i < n * n; ++i) points.row(i) = Vec3(i % n, i / n, z);
    return points;
}

// Returns a triangulated n x n grid at height z, changed by up to `bump` at random.
inline TriangleMesh sheet(Index n, double z, double bump = 0) {
    TriangleMesh mesh;
    mesh.vertices = lattice(n, z);
    mesh.triangles.resize(2 * (n - 1) * (n - 1), 3);
    Index t = 0;
    for (Index y = 0; y + 1 < n; ++y) {
        for (Index x = 0; x + 1 < n; ++x) {
            const Index v = n * y + x;
            mesh.triangles.row(t++) << v, v + 1, v + n;
            mesh.triangles.row(t++) << v + 1, v + n + 1, v + n;
        }
    }
    Random random(99);
    for (Index v = 0; v < n * n; ++v) mesh.vertices(v, 2) += bump * random.real(-1, 1);
    return mesh;
}

inline TriangleMesh soup(Points vertices) {  // every three rows form a triangle
    TriangleMesh mesh{std::move(vertices), {}};
    mesh.triangles.resize(mesh.vertices.rows() / 3, 3);
    for (Index i = 0; i < mesh.triangles.rows(); ++i) mesh.triangles.row(i) << 3 * i, 3 * i + 1, 3 * i + 2;
    return mesh;
}

inline TriangleMesh cube(double half) {
    TriangleMesh mesh;
    mesh.vertices.resize(8, 3);
    for (Index i = 0; i < 8; ++i) mesh.vertices.row(i) = half * Vec3((i & 1) * 2 - 1, (i & 2) - 1, (i & 4) / 2 - 1);
    mesh.triangles.resize(12, 3);
    mesh.triangles << 0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 3, 7,
        1, 7, 5;
    return mesh;
}

inline void transform(Shape& shape, double scale, const Vec3& offset) {
    Points& points = points_of(shape);
    points = (points * scale).eval();
    points.rowwise() += offset.transpose();
}

inline void transform(SharedShape& shape, double scale, const Vec3& offset) {
    Shape copy = shape;
    transform(copy, scale, offset);
    shape = std::move(copy);
}

inline Pose turned(double c, double s, const Vec3& translation) {  // a turn about z, then a permutation of the axes
    Pose pose;
    pose.rotation << c, -s, 0, 0, 0, 1, s, c, 0;
    pose.translation = translation;
    return pose;
}

inline TestScene test_scene(std::string name, Shape a, Shape b) {
    return {std::move(name), {std::move(a), std::move(b)}, {Pose{}}};
}

// Adds scaled, shifted and posed variants of the scene at `from`.
inline void add_variants(std::vector<TestScene>& all, std::size_t from) {
    const TestScene base = all[from];
    for (const double scale : {1e-160, 1e-80, 1e78, 1e150}) {
        TestScene scene = base;
        scene.name += ", scale " + std::to_string(static_cast<int>(std::round(std::log10(scale))));
        transform(scene.scene.source, scale, Vec3::Zero());
        transform(scene.scene.target, scale, Vec3::Zero());
        scene.poses.push_back(turned(0.6, 0.8, Vec3(0.1 * scale, 0, 0)));
        all.push_back(scene);
    }
    TestScene offset = base;
    offset.name += ", offset 1e8";
    transform(offset.scene.source, 1, Vec3(1e8, -1e8, 1e8));
    transform(offset.scene.target, 1, Vec3(1e8, -1e8, 1e8));
    all.push_back(offset);
    TestScene far = base;
    far.name += ", far apart";
    transform(far.scene.source, 1, Vec3(1e6, 0, 0));
    all.push_back(far);
    TestScene posed = base;
    posed.name += ", posed";
    posed.poses.push_back(turned(0.6, 0.8, {0.25, 0, -0.5}));
    posed.poses.push_back(turned(1, 1e-9, {1e-9, 0, 0}));
    posed.poses.push_back(turned(0.28, 0.96, {1e3, 0, 0}));
    all.push_back(posed);
}

inline std::vector<TestScene> point_scenes() {
    Random random(11);
    std::vector<TestScene> all;
    all.push_back(test_scene("random", PointSet{cloud(random, 40)}, PointSet{cloud(random, 30)}));
    add_variants(all, 0);
    const auto add = [&](const char* name, Points a, Points b) {
        all.push_back(test_scene(name, PointSet{std::move(a)}, PointSet{std::move(b)}));
    };
    const Points some = cloud(random, 25);
    add("single points", rows({{1, 2, 3}}), rows({{-1, 0.5, 2}}));
    add("one and the same point", rows({{1, 2, 3}}), rows({{1, 2, 3}}));
    add("all at the origin", rows({{0, 0, 0}, {-0.0, 0, 0}}), rows({{0, 0, -0.0}}));
    add("identical", some, some);
    add("permuted", some, some.colwise().reverse());
    add("one ulp apart", some, some.unaryExpr([](double x) { return std::nextafter(x, 9.0); }));
    Points line = Points::Zero(20, 3), other = line;
    for (Index i = 0; i < 20; ++i)
        line.row(i) = 0.1 * i * Vec3(1, 2, -1), other.row(i) = (0.1 * i + 0.03) * Vec3(1, 2, -1);
    add("collinear", line, other);
    Points twice(50, 3);
    twice << some, some;
    add("duplicates", twice, cloud(random, 10));
    add("ties", lattice(5, 0), rows({{0, 0, 1}, {4, 0, 1}, {0, 4, 1}, {4, 4, 1}}));
    add("parallel planes", lattice(6, 0), lattice(6, 0.125));
    add("signed zeros", rows({{0.0, -0.0, 1}, {1, 0, 0}}), rows({{-0.0, 0.0, 1}, {1, -0.0, 0}}));
    add("denormal differences", rows({{1e-310, 0, 0}, {3e-310, 0, 5e-324}}), rows({{2e-310, 1e-320, 0}}));
    add("tiny beside large", rows({{1, 0, 0}, {1e-300, 0, 0}}), rows({{1, 1e-300, 0}, {0, 0, 1e-200}}));
    add("huge", rows({{1.7e308, 0, 0}, {1, -1.7e308, 0}}), rows({{-1.7e308, 1e-300, 0}, {0, 1.7e308, 1.7e308}}));
    add("sizes 1 : 1e9", cloud(random, 20, 1e-9), cloud(random, 20));
    return all;
}

inline std::vector<TestScene> mesh_scenes() {
    Random random(12);
    std::vector<TestScene> all;
    all.push_back(test_scene("random soups", soup(cloud(random, 12)), soup(cloud(random, 15))));
    add_variants(all, 0);
    const std::size_t bumpy = all.size();
    all.push_back(
        test_scene("bumpy sheets", sheet(4, 0.1, 0.2), sheet(6, 0, 0.3)));  // a target large enough for a tree
    add_variants(all, bumpy);
    const auto add = [&](const char* name, TriangleMesh a, TriangleMesh b) {
        all.push_back(test_scene(name, std::move(a), std::move(b)));
    };
    const TriangleMesh triangle = soup(rows({{0, 0, 0}, {2, 0, 0}, {0, 1, 0}}));
    add("two triangles", triangle, soup(rows({{0, 0, 1}, {1, 3, 1}, {-1, 1, 2}})));
    add("one triangle, itself", triangle, triangle);
    add("identical", cube(1), cube(1));
    TriangleMesh permuted = cube(1);
    permuted.triangles = permuted.triangles.colwise().reverse().eval();
    permuted.triangles.col(0).swap(permuted.triangles.col(2));
    add("permuted", cube(1), permuted);
    add("identical sheets", sheet(6, 0, 0.3), sheet(6, 0, 0.3));
    add("nested cubes", cube(1), cube(2));
    add("parallel planes", sheet(3, 0), sheet(6, 0.125));
    add("sheet and its refinement", sheet(3, 0), [] {
        TriangleMesh m = sheet(5, 0);
        m.vertices *= 0.5;
        return m;
    }());
    add("zero area: segments", soup(rows({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}})),
        soup(rows({{0, 1, 0}, {0.1, 1.1, 0}, {0.2, 1.2, 0}})));
    add("zero area: points", soup(rows({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}})), triangle);
    add("a point as target", triangle, soup(rows({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}})));
    add("all at the origin", soup(rows({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}})),
        soup(rows({{0, 0, 0}, {0, 0, 0}, {0, 0, -0.0}})));
    TriangleMesh doubled = cube(1);
    doubled.triangles.conservativeResize(24, 3);
    doubled.triangles.bottomRows(12) = doubled.triangles.topRows(12).eval();
    add("duplicate faces", doubled, cube(0.75));
    add("needles",
        soup(rows({{0, 0, 0}, {1, 1, 1}, {1, 1, 1 + 1e-12}, {0, 1, 0}, {1, 0, 0.5}, {0.5, 0.5, 0.25 + 1e-14}})),
        soup(rows({{0, 0, 0.5}, {1, 1, 0.5}, {0.5, 0.5 + 1e-13, 0.5}, {0, 0, 0}, {1, 0, 0}, {1, 1e-9, 0}})));
    add("one ulp apart", cube(1), [] {
        TriangleMesh m = cube(1);
        m.vertices.row(7)[0] = std::nextafter(1.0, 2.0);
        return m;
    }());
    add("sizes 1 : 1e9", soup(cloud(random, 9, 1e-9)), soup(cloud(random, 9)));
    add("tree of duplicates", triangle, [&] {
        TriangleMesh m = soup(rows({{0, 0, 1}, {1, 3, 1}, {-1, 1, 2}}));
        m.triangles = m.triangles.replicate(40, 1).eval();
        return m;
    }());
    return all;
}

}  // namespace hausbench
