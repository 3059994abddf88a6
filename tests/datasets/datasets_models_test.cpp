// Models: generated shapes, which must be the same bit for bit everywhere, operations on shapes, and the manifest.
#include "algorithms/error.h"
#include "datasets/catalogue.h"
#include "datasets/corpus.h"
#include "datasets/derive.h"
#include "datasets/hash.h"
#include "datasets/shape_file.h"
#include "tests/support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <set>
#include <vector>

namespace hausbench {
namespace {

double area(const TriangleMesh& mesh) {
    double sum = 0;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        const auto corner = [&](int k) -> Vec3 { return mesh.vertices.row(mesh.triangles(t, k)).transpose(); };
        sum += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
    }
    return sum;
}

// Returns the volume enclosed by a closed mesh with outward faces.
double volume(const TriangleMesh& mesh) {
    double sum = 0;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        const auto corner = [&](int k) -> Vec3 { return mesh.vertices.row(mesh.triangles(t, k)).transpose(); };
        sum += corner(0).dot(corner(1).cross(corner(2))) / 6;
    }
    return sum;
}

// Returns whether every edge has two triangles, which traverse it in opposite directions.
bool closed(const TriangleMesh& mesh) {
    std::map<std::pair<Index, Index>, int> edges;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k) ++edges[{mesh.triangles(t, k), mesh.triangles(t, (k + 1) % 3)}];
    for (const auto& [edge, count] : edges)
        if (count != 1 || edges.count({edge.second, edge.first}) != 1) return false;
    return true;
}

Shape sphere(int level, double radius = 1) {
    return generate("icosphere", {{"level", static_cast<double>(level)}, {"radius", radius}});
}

LoadedShape derived(const std::string& operation, const Numbers& numbers, const Shape& origin) {
    const LoadedShape made = derive(operation, numbers, {origin, {}});
    EXPECT_EQ(shape_problem(made.shape), "") << operation;
    EXPECT_EQ(content_hash(made.shape), content_hash(derive(operation, numbers, {origin, {}}).shape))
        << operation << " changes its mind";
    return made;
}

TEST(Generate, BitsArePinned) {
    struct Pinned {
        std::string recipe;
        Numbers numbers;
        std::string hash;
    };
    const std::vector<Pinned> all = {
        {"icosphere",
         {{"level", 3}, {"radius", 1.25}},
         "7e449d2d680301a72fde348a43c2e3ad0027278c6ef48ad3dd3656e4e738abc8"},
        {"cube", {{"subdivisions", 7}}, "fee5fb891cc5a452f044e4d7594302eda1011fd1cd4fe4917c149887b245fef6"},
        {"torus",
         {{"rings", 37}, {"sides", 11}, {"major", 1}, {"minor", 0.4}},
         "ff64326f10031412468b2ac859726a0ad66909e0310c6753a02777f45e11a377"},
        {"gear",
         {{"teeth", 7},
          {"steps", 5},
          {"rings", 3},
          {"layers", 2},
          {"outer", 1.5},
          {"root", 1},
          {"bore", 0.4},
          {"height", 0.3}},
         "ace81462312066e0ab24a6e8956747ede67f20439dca6280487c19a010174d65"},
        {"plane", {{"n", 5}, {"z", 0.25}}, "9c6d752bba1721a7d7c23ab4a361c9b6e75015577d12a0ca7e23529b0bfa529b"},
        {"needle", {{"ratio", 1e6}}, "62ef48f8c30bae8ee0220ed80eb61a48e8e725108b4d064a14179d027859c169"},
        {"gaussian_points",
         {{"count", 1000}, {"seed", 7}, {"sigma", 1.5}, {"x", 1}, {"y", 2}, {"z", 3}},
         "872538c9e23cc346ce866ff544bac770446f1865ca3b355bbe17bcb7b8b4da66"},
        {"uniform_points",
         {{"count", 1000}, {"seed", 7}},
         "591e11844960276c2de20cdf70a23c573a82908403f981f0df863fff9ca2a080"},
        {"box_points",
         {{"count", 1000}, {"seed", 7}, {"x", 1}, {"y", 1e-3}, {"z", 0}},
         "fb68b71d48013e551b008660a7d45c21042c6756e7d02cd6d5f0c2ac031a21e3"},
        {"curve_points",
         {{"count", 1000}, {"seed", 7}},
         "256b8dc66603388987390238f6867ac9f21e5d26ef6e803139a1661b7d3a8b7d"},
        {"shell_points",
         {{"count", 1000}, {"seed", 7}, {"radius", 2}, {"x", 1}, {"y", 0}, {"z", -1}},
         "a54c61972542efadc1d068140f7caa10beb4faa9fd0fa127b250b07949733391"},
        {"cluster_points",
         {{"count", 1000}, {"seed", 7}, {"clusters", 9}, {"layout", 5}, {"spread", 10}, {"sigma", 1}, {"shrink", 0.1}},
         "5d9bb3175a827b3472c5f2f3df2440d26b84fbad8085c8dcbf88899350066ac9"},
    };
    for (const Pinned& pinned : all)
        EXPECT_EQ(content_hash(generate(pinned.recipe, pinned.numbers)), pinned.hash) << pinned.recipe;
}

TEST(Generate, MeshesAreWhatTheySay) {
    const Shape ball = sphere(4, 2.0);
    EXPECT_EQ(element_count(ball), 20 * 256);
    EXPECT_TRUE(closed(mesh_of(ball)));
    for (Eigen::Index v = 0; v < mesh_of(ball).vertices.rows(); ++v)
        EXPECT_NEAR(mesh_of(ball).vertices.row(v).norm(), 2, 1e-15);
    EXPECT_NEAR(volume(mesh_of(ball)), 4.0 / 3 * M_PI * 8, 0.3);

    const Shape cube = generate("cube", {{"subdivisions", 3}});
    EXPECT_EQ(element_count(cube), 12 * 9);
    EXPECT_EQ(mesh_of(cube).vertices.rows(), 56);
    EXPECT_TRUE(closed(mesh_of(cube)));
    EXPECT_NEAR(volume(mesh_of(cube)), 1, 1e-13);
    EXPECT_NEAR(area(mesh_of(cube)), 6, 1e-13);

    const Shape torus = generate("torus", {{"rings", 50}, {"sides", 12}, {"major", 2}, {"minor", 0.5}});
    EXPECT_EQ(element_count(torus), 2 * 50 * 12);
    EXPECT_TRUE(closed(mesh_of(torus)));
    EXPECT_GT(volume(mesh_of(torus)), 0);
    for (int i = 0; i < 50; ++i) {  // compared with libm, which the recipe may not use
        const double angle = 2 * M_PI * i / 50;
        EXPECT_NEAR(mesh_of(torus).vertices(12 * i, 0), 2.5 * std::cos(angle), 4e-15);
        EXPECT_NEAR(mesh_of(torus).vertices(12 * i, 1), 2.5 * std::sin(angle), 4e-15);
    }

    const Shape needle = generate("needle", {{"ratio", 8}});
    EXPECT_EQ(points_of(needle), (Points(3, 3) << -0.5, 0, 0, 0.5, 0, 0, 0, 0.125, 0).finished());
    EXPECT_EQ(element_count(needle), 1);

    const Shape plane = generate("plane", {{"n", 4}, {"z", 0.25}});
    EXPECT_EQ(element_count(plane), 32);
    EXPECT_NEAR(area(mesh_of(plane)), 1, 1e-14);
    EXPECT_TRUE((mesh_of(plane).vertices.col(2).array() == 0.25).all());
    const Shape gear = generate("gear", {{"teeth", 10},
                                         {"steps", 8},
                                         {"rings", 3},
                                         {"layers", 2},
                                         {"outer", 2},
                                         {"root", 1.5},
                                         {"bore", 0.5},
                                         {"height", 0.25}});
    EXPECT_EQ(element_count(gear), 4 * 10 * 8 * (3 + 2));
    EXPECT_TRUE(closed(mesh_of(gear)));
    EXPECT_GT(volume(mesh_of(gear)), 0.25 * 3.1 * (1.5 * 1.5 - 0.5 * 0.5));
    EXPECT_LT(volume(mesh_of(gear)), 0.25 * 3.2 * (2.0 * 2.0 - 0.5 * 0.5));
    for (const Shape& shape : {ball, cube, torus, plane, gear}) EXPECT_EQ(shape_problem(shape), "");
}

TEST(Generate, PointsHaveTheirDistribution) {
    const Points uniform = points_of(generate("uniform_points", {{"count", 20000}, {"seed", 1}}));
    EXPECT_GE(uniform.minCoeff(), 0);
    EXPECT_LT(uniform.maxCoeff(), 1);
    const Points normal = points_of(
        generate("gaussian_points", {{"count", 20000}, {"seed", 1}, {"sigma", 2}, {"x", 5}, {"y", 0}, {"z", -5}}));
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(uniform.col(k).mean(), 0.5, 0.01);
        EXPECT_NEAR((uniform.col(k).array() - 0.5).square().mean(), 1.0 / 12, 0.002);
        EXPECT_NEAR(normal.col(k).mean(), 5 - 5 * k, 0.06);
        EXPECT_NEAR((normal.col(k).array() - normal.col(k).mean()).square().mean(), 4, 0.15);
    }
    EXPECT_NEAR((uniform.col(0).array() * uniform.col(1).array()).mean(), 0.25, 0.01);
    EXPECT_NE(content_hash(generate("uniform_points", {{"count", 10}, {"seed", 1}})),
              content_hash(generate("uniform_points", {{"count", 10}, {"seed", 2}})));
}

TEST(Generate, HardPointSetsAreWhatTheySay) {
    const Points ribbon =
        points_of(generate("box_points", {{"count", 5000}, {"seed", 1}, {"x", 2}, {"y", 1e-3}, {"z", 0}}));
    EXPECT_GE(ribbon.minCoeff(), 0);
    EXPECT_NEAR(ribbon.col(0).maxCoeff(), 2, 0.01);
    EXPECT_NEAR(ribbon.col(1).maxCoeff(), 1e-3, 1e-5);
    EXPECT_EQ(ribbon.col(2).maxCoeff(), 0);
    const Points curve = points_of(generate("curve_points", {{"count", 1000}, {"seed", 1}}));
    EXPECT_TRUE((curve.col(0).array().square() == curve.col(1).array()).all());
    const Points shell = points_of(
        generate("shell_points", {{"count", 5000}, {"seed", 1}, {"radius", 3}, {"x", 1}, {"y", 2}, {"z", 0}}));
    const Points centred = shell.rowwise() - Eigen::RowVector3d(1, 2, 0);
    EXPECT_NEAR(centred.rowwise().norm().minCoeff(), 3, 1e-14);
    EXPECT_NEAR(centred.rowwise().norm().maxCoeff(), 3, 1e-14);
    EXPECT_LT(centred.colwise().mean().norm(), 0.15);
    const Numbers numbers{{"count", 1000}, {"seed", 1},     {"clusters", 4}, {"layout", 5},
                          {"spread", 10},  {"sigma", 1e-3}, {"shrink", 0}};
    const Points clusters = points_of(generate("cluster_points", numbers));
    EXPECT_EQ(clusters.row(1), clusters.row(5));  // both in the second cluster, whose sigma is 0
    EXPECT_NE(clusters.row(0), clusters.row(4));
    EXPECT_LT((clusters.row(0) - clusters.row(4)).norm(), 0.02);
    EXPECT_GT((clusters.row(1) - clusters.row(2)).norm(), 0.1);
}

TEST(Derive, ExactOperationsAreExactForShortCoordinates) {
    const Shape square = generate("plane", {{"n", 1}, {"z", 0.25}});
    const auto points = [](const LoadedShape& made) { return points_of(made.shape); };
    const Points& p = points_of(square);
    EXPECT_EQ(points(derived("move", {{"x", 1e12}, {"y", 0.5}, {"z", 0}}, square)).row(0),
              (Eigen::RowVector3d(1e12 - 0.5, 0, 0.25)));
    EXPECT_EQ(points(derived("stretch", {{"x", 1e-300}, {"y", 1}, {"z", 4}}, square)).row(3),
              (Eigen::RowVector3d(0.5e-300, 0.5, 1)));
    EXPECT_EQ(points(derived("power", {{"exponent", -1070}}, square)), p * 0x1p-1070);
    EXPECT_EQ(points(derived("nudge", {{"ulps", 3}}, square))(3, 0), 0.5 + 3 * 0x1p-53);
    EXPECT_EQ(
        points(derived("float32", {}, derive("stretch", {{"x", 0.2}, {"y", 1}, {"z", 1}}, {square, {}}).shape))(3, 0),
        double(0.1f));
}

TEST(Derive, RepeatCopiesElementsWithOrWithoutTheirVertices) {
    const Shape square = generate("plane", {{"n", 1}, {"z", 0.25}});
    const auto made = [&](double vertices) {
        return derived("repeat", {{"count", 3}, {"vertices", vertices}, {"x", 1}, {"y", 0}, {"z", 0}, {"grow", 1}},
                       square)
            .shape;
    };
    const Shape faces = made(0), all = made(1);
    EXPECT_EQ(element_count(faces), 6);
    EXPECT_EQ(points_of(faces), points_of(square));
    EXPECT_EQ(element_count(all), 6);
    EXPECT_EQ(points_of(all).rows(), 12);
    EXPECT_EQ(points_of(all).row(11),
              (Eigen::RowVector3d(3 * 0.5 + 2, 3 * 0.5, 3 * 0.25)));  // copy 2 is three times as large
    EXPECT_EQ(mesh_of(all).triangles.bottomRows(2), (mesh_of(square).triangles.array() + 8).matrix());
}

TEST(Derive, ShuffleKeepsTheTriangles) {
    const Shape ball = sphere(2);
    const Shape other = derived("shuffle", {{"seed", 5}}, ball).shape;
    EXPECT_NE(content_hash(ball), content_hash(other));
    const auto triangles = [](const Shape& shape) {  // rotated to begin with the least corner
        std::multiset<std::vector<double>> all;
        for (Index t = 0; t < element_count(shape); ++t) {
            std::array<std::array<double, 3>, 3> corners{};
            for (int k = 0; k < 3; ++k)
                for (int c = 0; c < 3; ++c)
                    corners[std::size_t(k)][std::size_t(c)] = points_of(shape)(mesh_of(shape).triangles(t, k), c);
            std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
            std::vector<double> flat;
            for (const auto& corner : corners) flat.insert(flat.end(), corner.begin(), corner.end());
            all.insert(flat);
        }
        return all;
    };
    EXPECT_EQ(triangles(ball), triangles(other));
    EXPECT_NE(mesh_of(ball).triangles, mesh_of(other).triangles);
}

TEST(Generate, FansAreAroundOneVertex) {
    const Shape fan = generate("fan", {{"triangles", 10}, {"height", 0.5}});
    EXPECT_EQ(element_count(fan), 10);
    EXPECT_EQ(points_of(fan).row(10), (Eigen::RowVector3d(0, 0, 0.5)));
    for (Index t = 0; t < 10; ++t) EXPECT_EQ(mesh_of(fan).triangles(t, 2), 10);
}

TEST(Derive, OutlierAddsOnePoint) {
    const Shape cloud = generate("uniform_points", {{"count", 10}, {"seed", 1}});
    const Points more = points_of(derived("outlier", {{"x", 1e4}, {"y", -2}, {"z", 0}}, cloud).shape);
    EXPECT_EQ(more.topRows(10), points_of(cloud));
    EXPECT_EQ(Eigen::RowVector3d(more.row(10)), Eigen::RowVector3d(1e4, -2, 0));
    EXPECT_THROW(derive("outlier", {{"x", 0}, {"y", 0}, {"z", 0}}, {sphere(1), {}}), InputError);
}

TEST(Derive, VerticesAndWeld) {
    TriangleMesh soup;  // two triangles that share an edge only by coordinates
    soup.vertices.resize(6, 3);
    soup.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, -0.0, 1, 1, 0, -0.0, 1, 0;
    soup.triangles.resize(2, 3);
    soup.triangles << 0, 1, 2, 3, 4, 5;
    const LoadedShape welded = derived("weld", {}, soup);
    EXPECT_EQ(points_of(welded.shape).rows(), 4);
    EXPECT_EQ(mesh_of(welded.shape).triangles, (Triangles(2, 3) << 0, 1, 2, 1, 3, 2).finished());
    EXPECT_EQ(kind_of(derived("vertices", {}, soup).shape), ShapeKind::points);
    EXPECT_EQ(points_of(derived("weld", {}, derived("vertices", {}, soup).shape).shape).rows(), 4);
}

TEST(Derive, ConnectedParts) {
    TriangleMesh soup;  // the first and the last share a corner only by coordinates (0 = -0); the second is apart
    soup.vertices.resize(9, 3);
    soup.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5, 6, 5, 5, 5, 6, 5, -0.0, 0, -0.0, -1, 0, 0, 0, -1, 0;
    soup.triangles.resize(3, 3);
    soup.triangles << 0, 1, 2, 3, 4, 5, 6, 7, 8;
    EXPECT_EQ(connected_parts(soup), (std::vector<Index>{0, 1, 0}));
    const Shape ball = sphere(3);
    EXPECT_EQ(connected_parts(mesh_of(ball)), std::vector<Index>(std::size_t(element_count(ball)), 0));
    EXPECT_TRUE(connected_parts({}).empty());
}

TEST(Derive, SampleSpreadsByArea) {
    TriangleMesh mesh;  // a large triangle at z = 0, one with a ninth of its area at z = 1, and one without area
    mesh.vertices.resize(6, 3);
    mesh.vertices << 0, 0, 0, 3, 0, 0, 0, 3, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1;
    mesh.triangles.resize(3, 3);
    mesh.triangles << 0, 0, 1, 0, 1, 2, 3, 4, 5;
    const Points points = points_of(derived("sample", {{"count", 10000}, {"seed", 5}}, mesh).shape);
    EXPECT_EQ(points.rows(), 10000);
    EXPECT_NEAR(points.col(2).sum(), 1000, 100);  // a tenth of the points, all at z = 1
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        EXPECT_GE(points.row(i).minCoeff(), 0);
        EXPECT_LE(points(i, 0) + points(i, 1), points(i, 2) == 0 ? 3 + 1e-14 : 1 + 1e-14);
    }
    EXPECT_NEAR(points.col(0).mean(), 0.9 * 1 + 0.1 / 3, 0.03);
    for (const double scale : {0x1p-269, 0x1p-600, 0x1p400}) {  // the squares of areas underflow or overflow
        const TriangleMesh other{scale * mesh.vertices, mesh.triangles};
        EXPECT_EQ(points_of(derived("sample", {{"count", 10000}, {"seed", 5}}, other).shape), Points(scale * points));
    }

    const Shape cloud = generate("uniform_points", {{"count", 100}, {"seed", 1}});
    EXPECT_EQ(element_count(derived("sample", {{"count", 30}, {"seed", 1}}, cloud).shape), 30);
    EXPECT_EQ(points_of(derived("sample", {{"count", 100}, {"seed", 1}}, cloud).shape), points_of(cloud));
    EXPECT_THROW(derive("sample", {{"count", 101}, {"seed", 1}}, {cloud, {}}), InputError);
    mesh.triangles.conservativeResize(1, 3);
    EXPECT_THROW(derive("sample", {{"count", 1}, {"seed", 1}}, {mesh, {}}), InputError);
}

TEST(Derive, SubdivideKeepsTheSurface) {
    const Shape ball = sphere(1);
    const LoadedShape fine = derived("subdivide", {{"levels", 2}}, ball);
    EXPECT_EQ(element_count(fine.shape), 16 * 80);
    EXPECT_TRUE(closed(mesh_of(fine.shape)));
    EXPECT_NEAR(area(mesh_of(fine.shape)), area(mesh_of(ball)), 1e-12);
    EXPECT_EQ(points_of(fine.shape).topRows(42), points_of(ball));
    EXPECT_EQ(content_hash(derived("subdivide", {{"levels", 0}}, ball).shape), content_hash(ball));
}

TEST(Derive, MovesAndScales) {
    const Shape ball = sphere(2, 3);
    const Points& before = points_of(ball);
    const double length = diagonal(before);
    EXPECT_EQ(points_of(derived("scale", {{"factor", 2}}, ball).shape), 2 * before);
    const Points moved = points_of(derived("translate", {{"x", 1}, {"y", 0}, {"z", -0.5}}, ball).shape);
    EXPECT_NEAR((moved.rowwise() - Eigen::RowVector3d(length, 0, -0.5 * length) - before).cwiseAbs().maxCoeff(), 0,
                1e-14);
    const Points unit =
        points_of(derived("normalise", {}, derived("translate", {{"x", 7}, {"y", 8}, {"z", 9}}, ball).shape).shape);
    EXPECT_NEAR(diagonal(unit), 1, 1e-15);
    EXPECT_NEAR((unit.colwise().maxCoeff() + unit.colwise().minCoeff()).cwiseAbs().maxCoeff(), 0, 1e-15);
    const double half = std::tan(0.35);
    const Points turned = points_of(derived("rotate", {{"x", 0}, {"y", 0}, {"z", 2}, {"t", half}}, ball).shape);
    EXPECT_NEAR((turned.col(0) - (std::cos(0.7) * before.col(0) - std::sin(0.7) * before.col(1))).cwiseAbs().maxCoeff(),
                0, 1e-14);
    EXPECT_NEAR((turned.col(1) - (std::sin(0.7) * before.col(0) + std::cos(0.7) * before.col(1))).cwiseAbs().maxCoeff(),
                0, 1e-14);
    for (const double z : {0x1p-536, 0x1p-1074, 0x1p1000})
        EXPECT_EQ(points_of(derived("rotate", {{"x", 0}, {"y", 0}, {"z", z}, {"t", half}}, ball).shape), turned) << z;
    const Points noisy = points_of(derived("noise", {{"amplitude", 0.01}, {"seed", 3}}, ball).shape);
    const double most = (noisy - before).cwiseAbs().maxCoeff();
    EXPECT_LE(most, 0.01 * length);
    EXPECT_GT(most, 0.0095 * length);
    const Points gridded = points_of(derived("quantise", {{"cells", 5}}, ball).shape);
    EXPECT_LE((gridded - before).cwiseAbs().maxCoeff(), 0.1 + 1e-15);
    EXPECT_EQ(gridded, points_of(derived("quantise", {{"cells", 5}}, PointSet{gridded}).shape));
    EXPECT_EQ(gridded, Points(Points((5 * gridded).array().round()).array() / 5));
    EXPECT_THROW(derive("rotate", {{"x", 0}, {"y", 0}, {"z", 0}, {"t", 1}}, {ball, {}}), InputError);
    EXPECT_THROW(derive("normalise", {}, {PointSet{Points::Ones(2, 3)}, {}}), InputError);
    EXPECT_THROW(derive("subdivide", {{"levels", 1}}, {PointSet{Points::Ones(2, 3)}, {}}), InputError);
    EXPECT_THROW(derive("fold", {}, {ball, {}}), InputError);
}

TEST(Derive, StrayElementsAndSecondClusters) {
    const Shape ball = sphere(1);
    const Shape cloud = generate("uniform_points", {{"count", 20}, {"seed", 1}});
    const Eigen::RowVector3d shift = 300 * Eigen::RowVector3d(2, 1, 2) / 3;
    for (const Shape& before : {ball, cloud}) {
        const Points& old = points_of(before);
        const Shape stray = derived("stray", {{"distance", 300}}, before).shape;
        const Shape two = derived("two_clusters", {{"distance", 300}}, before).shape;
        EXPECT_EQ(element_count(stray), element_count(before) + 1);
        EXPECT_EQ(element_count(two), 2 * element_count(before));
        EXPECT_EQ(points_of(stray).topRows(old.rows()), old);
        EXPECT_EQ(points_of(two).topRows(old.rows()), old);
        EXPECT_EQ(points_of(two).bottomRows(old.rows()), old.rowwise() + shift);
    }
    const Shape stray = derived("stray", {{"distance", 300}}, ball).shape,
                two = derived("two_clusters", {{"distance", 300}}, ball).shape;
    EXPECT_EQ(points_of(derived("stray", {{"distance", 300}}, cloud).shape).bottomRows(1),
              points_of(cloud).bottomRows(1).rowwise() + shift);
    const Triangles& triangles = mesh_of(ball).triangles;
    EXPECT_EQ(mesh_of(stray).triangles.bottomRows(1), (Triangles(1, 3) << 42, 43, 44).finished());
    for (int k = 0; k < 3; ++k)
        EXPECT_EQ(mesh_of(stray).vertices.row(42 + k), points_of(ball).row(triangles(triangles.rows() - 1, k)) + shift);
    EXPECT_EQ(mesh_of(two).triangles.bottomRows(80), Triangles(triangles.array() + 42));
    EXPECT_EQ(content_hash(stray), "6c7e89ba46e64f9e533be1878c6471dadd68b4cb890937a08c7a7dd568bede55");
    EXPECT_EQ(content_hash(two), "77eebe278be45b4171dad617061551a452332c68c02f485aa4cad7290cc5db7b");
}

bool built_with_cgal_gpl() {
    try {
        simplify(mesh_of(sphere(1)), 40);
    } catch (const InputError& error) {
        return std::string(error.what()).find("built without") == std::string::npos;
    }
    return true;
}

TEST(Derive, SimplifyAndRemesh) {
    if (!built_with_cgal_gpl()) GTEST_SKIP() << "built without CGAL's GPL parts";
    const Shape ball = sphere(4);
    const LoadedShape half = derived("simplify", {{"ratio", 0.5}}, ball);
    EXPECT_NEAR(element_count(half.shape), 2560, 2);
    EXPECT_LE(element_count(half.shape), 2560);
    EXPECT_TRUE(closed(mesh_of(half.shape)));
    EXPECT_NEAR(volume(mesh_of(half.shape)), volume(mesh_of(ball)), 0.01);
    EXPECT_LE(element_count(derived("simplify", {{"triangles", 101}}, ball).shape), 101);

    const LoadedShape even = derived("remesh", {{"edge", 0.03}}, ball);
    EXPECT_TRUE(closed(mesh_of(even.shape)));
    EXPECT_NEAR(volume(mesh_of(even.shape)), volume(mesh_of(ball)), 0.05);
    EXPECT_NEAR(diagonal(points_of(even.shape)), diagonal(points_of(ball)), 0.1);

    // Triangles that share no vertices; then a duplicate, one attached along an edge, and one without area.
    const TriangleMesh& shared = mesh_of(ball);
    TriangleMesh soup;
    soup.vertices.resize(3 * shared.triangles.rows() + 1, 3);
    soup.triangles.resize(shared.triangles.rows() + 3, 3);
    for (Eigen::Index t = 0; t < shared.triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k) {
            soup.vertices.row(3 * t + k) = shared.vertices.row(shared.triangles(t, k));
            soup.triangles(t, k) = static_cast<Index>(3 * t + k);
        }
    const auto last = static_cast<Index>(soup.vertices.rows() - 1);
    soup.vertices.row(last) << 0, 0, 3;
    soup.triangles.bottomRows(3) << 0, 1, 2, 0, 1, last, 4, 4, 5;
    EXPECT_LE(element_count(derived("simplify", {{"ratio", 0.25}}, soup).shape), 1.1 * 0.25 * 5123);
    derived("remesh", {{"edge", 0.05}}, soup);
}

class Manifest : public ::testing::Test {
protected:
    Catalogue catalogue(const std::string& text, const std::string& program = "") const {
        std::ofstream(folder_.path() / "manifest.toml") << text;
        return Catalogue(folder_.path() / "manifest.toml", folder_.path() / "cache", program);
    }
    std::string error(const std::string& text) const {
        try {
            catalogue(text);
        } catch (const InputError& problem) {
            const std::string message = problem.what();
            EXPECT_TRUE(message.starts_with((folder_.path() / "manifest.toml").string())) << message;
            return message;
        }
        return "no error";
    }
    void expect(const std::string& text, const std::vector<std::string>& parts) const {
        const std::string message = error(text);
        for (const std::string& part : parts)
            EXPECT_NE(message.find(part), std::string::npos) << message << " lacks " << part;
    }
    std::string fetch(const std::string& name, const std::string& bytes, const std::string& as_hash = "") const {
        const std::string hash = as_hash.empty() ? Sha256().add(bytes.data(), bytes.size()).hex() : as_hash;
        std::filesystem::create_directories(folder_.path() / "cache" / "raw" / hash);
        std::ofstream(folder_.path() / "cache" / "raw" / hash / name, std::ios::binary) << bytes;
        return hash;
    }
    // Makes a script in place of the program that reads model files. It logs each call, and writes the
    // same shape to the file in its last argument.
    std::string reader() const {
        write_shape(folder_.path() / "read.h5", {sphere(0), {}});
        const std::filesystem::path script = folder_.path() / "reader";
        std::ofstream(script) << fmt::format(
            "#!/bin/sh\necho \"$*\" >> {0}/calls\nfor out; do :; done\ncp {0}/read.h5 \"$out\"\n",
            folder_.path().string());
        std::filesystem::permissions(script, std::filesystem::perms::owner_all);
        return script.string();
    }
    std::size_t calls() const {
        std::ifstream in(folder_.path() / "calls");
        std::size_t count = 0;
        for (std::string line; std::getline(in, line);) ++count;
        return count;
    }

    TemporaryFolder folder_;
};

const std::string ball = "[model.ball]\nsource = 'generated'\nrecipe = 'icosphere'\nlevel = 1\nradius = 1.0\n";
const std::string half =
    "[model.half]\nsource = 'derived'\nfrom = 'ball'\noperation = 'scale'\nfactor = 0.5\nnote = 'n'\n";

std::string package(const std::string& hash) {
    return fmt::format(
        "[model.bunny]\nsource = 'debian'\npackage = 'glmark2-data'\nversion = '1'\npath = "
        "'a.tar.gz!models/bunny.obj'\n"
        "sha256 = '{}'\nlicence = 'GPL-3+'\ntriangles = 20\nnote = 'a bunny'\n",
        hash);
}

TEST_F(Manifest, MistakesAreNamedWithTheirLine) {
    expect("[model.x\n", {"line 1"});
    expect("[modle.x]\nsource = 'file'\n", {"line 1", "modle"});
    expect("[model.ball]\nsource = 'generatd'\n", {"line 2", "'ball'", "did you mean 'generated'"});
    expect(ball + "raduis = 2\n", {"line 6", "unknown key 'raduis'", "did you mean 'radius'"});
    expect("[model.ball]\nsource = 'generated'\nrecipe = 'icosfere'\n", {"line 3", "did you mean 'icosphere'"});
    expect("[model.ball]\nsource = 'generated'\nrecipe = 'icosphere'\nradius = 1\n", {"needs the number 'level'"});
    expect("[model.ball]\nsource = 'generated'\nrecipe = 'icosphere'\nlevel = 1.5\nradius = 1\n", {"an integer"});
    expect("[model.ball]\nsource = 'generated'\nrecipe = 'icosphere'\nlevel = 99\nradius = 1\n", {"level is 99"});
    expect("[model.ball]\nsource = 'generated'\nrecipe = 'icosphere'\nlevel = '1'\nradius = 1\n",
           {"line 4", "must be a number"});
    expect("[model.ball]\nsource = 'generated'\nrecipe = 'icosphere'\nlevel = 1\nradius = 9007199254740993\n",
           {"line 5", "radius", "which is not a double"});
    expect("[model.'a b']\nsource = 'generated'\n", {"letters"});
    expect(package("12"), {"line 6", "64 digits"});
    expect("[model.bunny]\nsource = 'debian'\npackage = 'x'\n", {"has no 'version'"});
    expect("[model.bunny]\nsource = 3\n", {"line 2", "must be a text"});
    expect(ball + "[model.half]\nsource = 'derived'\nfrom = 'bal'\noperation = 'weld'\n",
           {"'half'", "'bal'", "did you mean 'ball'"});
    expect(ball + "[model.half]\nsource = 'derived'\nfrom = 'ball'\noperation = \"we\\nld\"\n",
           {"unknown operation 'we ld'", "did you mean 'weld'?"});  // the message is one line
    expect(ball + "[model.half]\nsource = 'derived'\nfrom = 'ball'\noperation = 'simplify'\n",
           {"one of 'ratio' and 'triangles'"});
    expect(
        "[model.a]\nsource = 'derived'\nfrom = 'b'\noperation = 'weld'\n[model.b]\nsource = 'derived'\nfrom = "
        "'a'\noperation = 'weld'\n",
        {"derived from itself"});
    EXPECT_THROW(Catalogue(folder_.path() / "absent.toml", "", ""), InputError);
    const Catalogue good = catalogue(ball + half);
    EXPECT_EQ(good.models().size(), 2u);
    EXPECT_EQ(good.find("half").recipe, "scale");
    EXPECT_EQ(good.find("half").note, "n");
    EXPECT_THROW(good.find("bal"), InputError);
}

TEST_F(Manifest, GeneratedAndDerivedShapesAreCachedByContent) {
    const Catalogue all = catalogue(ball + half);
    const auto resolved = std::get<ResolvedModel>(all.resolve("half"));
    EXPECT_EQ(resolved.elements, 80);
    EXPECT_EQ(resolved.vertices, 42);
    EXPECT_EQ(resolved.kind, ShapeKind::mesh);
    const LoadedShape shape = read_shape(resolved.shape_file);
    EXPECT_EQ(points_of(shape.shape), 0.5 * points_of(sphere(1)));
    EXPECT_EQ(resolved.content_hash, content_hash(shape.shape));
    EXPECT_EQ(resolved.diagonal, diagonal(points_of(shape.shape)));
    EXPECT_EQ(resolved.longest_side, 1);

    const auto written = std::filesystem::last_write_time(resolved.shape_file);
    EXPECT_EQ(std::get<ResolvedModel>(all.resolve("half")).shape_file, resolved.shape_file);
    EXPECT_EQ(std::filesystem::last_write_time(resolved.shape_file), written);

    std::string edited = ball;  // a changed origin must not give the cached shape
    edited.replace(edited.find("1.0"), 3, "4.0");
    const auto anew = std::get<ResolvedModel>(catalogue(edited + half).resolve("half"));
    EXPECT_NE(anew.shape_file, resolved.shape_file);
    EXPECT_NEAR(anew.diagonal, 4 * resolved.diagonal, 1e-12);
}

TEST_F(Manifest, FetchedFilesAreCheckedAndReadOnce) {
    const std::string hash = fetch("bunny.obj", "what the reader is given");
    const Catalogue all = catalogue(
        package(hash) + "[model.points]\nsource = 'derived'\nfrom = 'bunny'\noperation = 'vertices'\n", reader());
    EXPECT_EQ(std::get<ResolvedModel>(all.resolve("bunny")).elements, 20);
    EXPECT_EQ(std::get<ResolvedModel>(all.resolve("points")).kind, ShapeKind::points);
    EXPECT_EQ(calls(), 1u);

    fetch("bunny.obj", "other bytes", hash);
    try {
        all.resolve("points");
        FAIL();
    } catch (const InputError& problem) {
        const std::string message = problem.what();
        EXPECT_NE(message.find("'bunny'"), std::string::npos) << message;
        EXPECT_NE(message.find(hash), std::string::npos) << message;
        EXPECT_NE(message.find(Sha256().add("other bytes", 11).hex()), std::string::npos) << message;
    }
}

TEST_F(Manifest, WhatIsNotThereIsMissingWithItsReason) {
    const Catalogue all = catalogue(package(std::string(64, 'a')) +
                                        "[model.half]\nsource = 'derived'\nfrom = 'bunny'\noperation = 'weld'\n"
                                        "[model.mine]\nsource = 'file'\npath = 'mine.obj'\n",
                                    reader());
    EXPECT_EQ(std::get<MissingModel>(all.resolve("bunny")).reason,
              "package glmark2-data was not fetched: run `hausbench fetch`");
    EXPECT_NE(std::get<MissingModel>(all.resolve("half")).reason.find("glmark2-data"), std::string::npos);
    EXPECT_NE(std::get<MissingModel>(all.resolve("mine")).reason.find("mine.obj"), std::string::npos);
    std::ofstream(folder_.path() / "mine.obj") << "beside the manifest";
    EXPECT_EQ(std::get<ResolvedModel>(all.resolve("mine")).elements, 20);
}

TEST_F(Manifest, TheCorpusAddsItsMeshesAndWhatItsRulesDerive) {
    std::ofstream(folder_.path() / "corpus.toml")
        << "manifest = ['ball']\n[model.cube]\nsource = 'generated'\nrecipe = 'cube'\nsubdivisions = 4\n";
    const std::string mine = "[model.ball_half]\nsource = 'derived'\nfrom = 'ball'\noperation = 'weld'\n";
    Catalogue all = catalogue(ball + mine);
    EXPECT_EQ(all.corpus(), (std::vector<std::string>{"ball", "cube"}));
    EXPECT_EQ(all.models().size(), 2u + 1 + 3);  // the manifest's own ball_half replaces the rule's
    EXPECT_EQ(all.find("ball_half").recipe, "weld");
    EXPECT_FALSE(all.find("ball").of_corpus);
    EXPECT_TRUE(all.find("cube").of_corpus && !all.find("cube").by_rule() && all.find("cube_half").by_rule());
    const auto halved = std::get<ResolvedModel>(all.resolve("cube_half"));
    EXPECT_EQ(halved.elements, 96);
    EXPECT_GT(std::get<ResolvedModel>(all.resolve("cube_remeshed")).elements, 10'000);  // edges of length 0.017
    // A model defined by hand with the same steps shares the cached file.
    const std::string by_hand =
        "[model.c]\nsource = 'generated'\nrecipe = 'cube'\nsubdivisions = 4\n"
        "[model.h]\nsource = 'derived'\nfrom = 'c'\noperation = 'simplify'\nratio = 0.5\n";
    EXPECT_EQ(std::get<ResolvedModel>(catalogue(ball + by_hand).resolve("h")).shape_file, halved.shape_file);
    // An experiment's own model may only replace a model made by a rule.
    ModelInfo replacement = all.find("ball");
    replacement.name = "cube_half";
    all.add("s.toml", {replacement});
    EXPECT_FALSE(all.find("cube_half").of_corpus);
    replacement.name = "cube";
    EXPECT_THROW(all.add("s.toml", {replacement}), InputError);
}

TEST_F(Manifest, MistakesInTheCorpusAreNamedWithTheirLine) {
    const auto expect_of = [&](const std::string& text, const std::vector<std::string>& parts) {
        std::ofstream(folder_.path() / "corpus.toml") << text;
        try {
            catalogue(ball);
            FAIL() << text;
        } catch (const InputError& problem) {
            for (const std::string& part : parts)
                EXPECT_NE(std::string(problem.what()).find(part), std::string::npos) << problem.what();
        }
    };
    expect_of("manifest = ['ball', 'bal']\n", {"corpus.toml: line 1", "'bal'", "did you mean 'ball'"});
    expect_of("manifest = 'ball'\n", {"corpus.toml: line 1", "list of names"});
    expect_of("\nmanifset = ['ball']\n", {"corpus.toml: line 2", "did you mean 'manifest'"});
    expect_of("manifest = ['ball', 'ball']\n", {"'ball' is listed twice"});
    expect_of(ball, {"corpus.toml", "'ball' is also in datasets/manifest.toml"});
    expect_of("[model.a]\nsource = 'debian'\n", {"corpus.toml: line 1", "'package'"});
    expect_of("[model.a\n", {"corpus.toml: line 1"});
}

TEST_F(Manifest, ACrashOfCgalIsToldWithTheModel) {
    const std::filesystem::path script = folder_.path() / "broken";
    std::ofstream(script) << fmt::format("#!/bin/sh\necho \"$*\" >> {}/calls\nkill -SEGV $$\n",
                                         folder_.path().string());
    std::filesystem::permissions(script, std::filesystem::perms::owner_all);
    const std::string quarter =
        "[model.quarter]\nsource = 'derived'\nfrom = 'ball'\noperation = 'simplify'\nratio = 0.25\n";
    try {
        catalogue(ball + half + quarter, script.string()).resolve("quarter");
        FAIL();
    } catch (const InputError& problem) {
        for (const char* part : {"model 'quarter'", "simplify", "CGAL was killed by signal 11"})
            EXPECT_NE(std::string(problem.what()).find(part), std::string::npos) << problem.what();
    }
    std::ifstream in(folder_.path() / "calls");
    std::string line;
    std::getline(in, line);
    EXPECT_TRUE(line.starts_with("derive --set ratio=0x1p-2 -- simplify /")) << line;
    // `half` does not use CGAL, so the broken program does not matter.
    EXPECT_EQ(std::get<ResolvedModel>(catalogue(ball + half, script.string()).resolve("half")).elements, 80);
}

TEST_F(Manifest, AReaderThatFailsIsToldWithTheModel) {
    const std::string hash = fetch("bunny.obj", "x");
    const std::filesystem::path script = folder_.path() / "broken";
    std::ofstream(script) << "#!/bin/sh\nkill -ABRT $$\n";
    std::filesystem::permissions(script, std::filesystem::perms::owner_all);
    try {
        catalogue(package(hash), script.string()).resolve("bunny");
        FAIL();
    } catch (const InputError& problem) {
        EXPECT_NE(std::string(problem.what()).find("model 'bunny'"), std::string::npos);
        EXPECT_NE(std::string(problem.what()).find("signal 6"), std::string::npos);
    }
}

}  // namespace
}  // namespace hausbench
