// Checks the relations of metamorphic.h for every certified solver. They need no reference, so they also find errors
// that a reference might share. A deliberately wrong solver shows that each relation can fail.
#include "tests/support/metamorphic.h"

#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/quick_options.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

namespace hausbench::metamorphic {
namespace {

// --- scenes ---------------------------------------------------------------------------------------------------------

double on_grid(double x, double step) { return step * std::round(x / step); }

Points grid_cloud(Random& random, Index count, double step) {
    return cloud(random, count, 0.9).unaryExpr([&](double x) { return on_grid(x, step); });
}

// Returns a soup, a soup with coincident vertices and flat triangles, thin triangles, or a bumpy sheet.
Shape some_mesh(Random& random, int kind) {
    const Index count = 5 + random.below(12);
    if (kind == 0) return soup(grid_cloud(random, 3 * count, 0x1p-16));
    if (kind == 1) return soup(grid_cloud(random, 3 * count, 0x1p-1));
    if (kind == 2) {
        Points corners = grid_cloud(random, 3 * count, 0x1p-16);
        for (Index i = 0; i < count; ++i)
            corners.row(3 * i + 2) = corners.row(3 * i) + Vec3(0x1p-16, 0, 0x1p-15).transpose() * double(i % 3);
        return soup(corners);
    }
    TriangleMesh mesh = sheet(3 + random.below(4), 0, 0.5);  // 8 to 50 triangles
    mesh.vertices = (0.25 * mesh.vertices).unaryExpr([](double x) { return on_grid(x, 0x1p-16); });
    return mesh;
}

constexpr int many = 12;

std::vector<Instance> mesh_instances() {
    Random random(31);
    std::vector<Instance> all;
    for (int i = 0; i < many; ++i) {
        const Shape a = some_mesh(random, i % 4), b = some_mesh(random, (i + i / 4) % 4);
        all.push_back({fmt::format("meshes {}", i), a, b, some_mesh(random, (i + 2) % 4)});
    }
    return all;
}

std::vector<Instance> point_instances() {
    Random random(32);
    std::vector<Instance> all;
    for (int i = 0; i < many; ++i) {
        const double step = i % 2 ? 0x1p-2 : 0x1p-16;  // coarse: ties and coincident points
        const auto some = [&] { return Shape(PointSet{grid_cloud(random, 5 + random.below(60), step)}); };
        Instance instance{fmt::format("points {}", i), some(), some(), some()};
        all.push_back(instance);
    }
    return all;
}

// --- the solvers ----------------------------------------------------------------------------------------------------

Ask ask_of(const SolverEntry& entry) {
    return [&entry](const Scene& scene, double tolerance, Quantity quantity) {
        QuerySet queries;
        queries.symmetric = quantity == Quantity::symmetric;
        const Session session(entry, quick_options(entry), scene, queries);
        Query query;
        query.quantity = quantity;
        query.tolerance = {Tolerance::Of::absolute, tolerance};
        query.budget = most;
        Trace trace;
        return session.solve(query, trace).bounds;
    };
}

template <class R>
std::vector<std::string> violations(const Ask& ask, const Instance& instance, double tolerance, bool tight,
                                    bool exact = false) {
    R relation(ask, instance, tolerance, tight, exact);
    relation.check();
    return relation.violations;
}

template <class R> void expect_of_every_solver() {
    std::map<std::string, int> tried;
    for (const auto& instances : {point_instances(), mesh_instances()}) {
        for (const SolverEntry& entry : solvers()) {
            const SolverInfo& info = entry.info;
            if (!info.certified || !info.offers(Quantity::directed)) continue;
            for (const Instance& instance : instances) {
                if (!refusal(info, kind_of(instance.a), kind_of(instance.b)).empty()) continue;
                ++tried[info.name];
                for (const double tolerance : {coarse, fine}) {
                    const bool tight = tolerance == coarse && reaches_the_tolerance(info);
                    for (const std::string& violation :
                         violations<R>(ask_of(entry), instance, tolerance, tight, !info.source.mesh))
                        ADD_FAILURE() << info.name << ", " << violation;
                }
            }
        }
    }
    EXPECT_GE(tried.size(), 13u);
}

// --- planted wrong solvers ------------------------------------------------------------------------------------------

using Wrong = std::function<Bounds(const Scene&, Quantity)>;

Bounds right(const Scene& scene, Quantity quantity) {
    const bool points = kind_of(scene.source) == ShapeKind::points;
    return ask_of(find_solver(points ? "naive" : "guthe"))(scene, coarse, quantity);
}

// Returns bounds so wide that only a wrong `value` can violate a relation.
Bounds around(double value) { return {value - 2 * coarse, value + 2 * coarse}; }

// Returns h between the vertices of `a` and of `b`.
double of_vertices(const Shape& a, const Shape& b) {
    return right({PointSet{points_of(a)}, PointSet{points_of(b)}}, Quantity::directed).lower;
}

double mean_of_vertices(const Shape& a, const Shape& b) {
    double sum = 0;
    for (Index i = 0; i < points_of(a).rows(); ++i) sum += of_vertices(PointSet{points_of(a).row(i)}, b);
    return sum / double(points_of(a).rows());
}

template <class R> void expect_refuted(const Wrong& wrong) {
    const std::vector<Instance> instances = mesh_instances();
    const Ask planted = [&](const Scene& scene, double, Quantity quantity) { return wrong(scene, quantity); };
    EXPECT_TRUE(std::any_of(instances.begin(), instances.end(), [&](const Instance& instance) {
        return !violations<R>(planted, instance, coarse, false).empty();
    }));
}

TEST(Metamorphic, ScalesWithPowersOfTwo) {
    expect_of_every_solver<ScalesWithPowersOfTwo>();
    expect_refuted<ScalesWithPowersOfTwo>([](const Scene& scene, Quantity quantity) {  // widens by an absolute length
        return Bounds{right(scene, quantity).lower, right(scene, quantity).upper + 0x1p-40};
    });
}

TEST(Metamorphic, ForgetsTheOrder) {
    expect_of_every_solver<ForgetsTheOrder>();
    expect_refuted<ForgetsTheOrder>([](const Scene& scene, Quantity) {  // only the first vertex of A
        return around(of_vertices(PointSet{points_of(scene.source).row(0)}, scene.target));
    });
}

TEST(Metamorphic, MovesAlong) {
    expect_of_every_solver<MovesAlong>();
    expect_refuted<MovesAlong>([](const Scene& scene, Quantity) {  // coordinates in single precision
        const auto single = [](const Vec3& p) { return Vec3(p.cast<float>().cast<double>()); };
        return around(of_vertices(moved(scene.source, single), moved(scene.target, single)));
    });
}

TEST(Metamorphic, TurnsAlong) {
    expect_of_every_solver<TurnsAlong>();
    expect_refuted<TurnsAlong>([](const Scene& scene, Quantity) {  // z is ignored
        const auto flat = [](const Vec3& p) { return Vec3(p[0], p[1], 0); };
        return around(of_vertices(moved(scene.source, flat), moved(scene.target, flat)));
    });
}

TEST(Metamorphic, GrowsWithA) {
    expect_of_every_solver<GrowsWithA>();
    expect_refuted<GrowsWithA>([](const Scene& scene, Quantity) {  // the mean over A instead of the maximum
        return around(mean_of_vertices(scene.source, scene.target));
    });
}

TEST(Metamorphic, ForgetsTheCuts) {
    expect_of_every_solver<ForgetsTheCuts>();
    expect_refuted<ForgetsTheCuts>([](const Scene& scene, Quantity) {  // only the vertices of the meshes
        return around(of_vertices(scene.source, scene.target));
    });
}

TEST(Metamorphic, ObeysTheTriangleInequality) {
    expect_of_every_solver<ObeysTheTriangleInequality>();
    expect_refuted<ObeysTheTriangleInequality>([](const Scene& scene, Quantity quantity) {  // squared distances
        return around(std::pow(right(scene, quantity).lower, 2));
    });
}

TEST(Metamorphic, IsSymmetric) {
    expect_of_every_solver<IsSymmetric>();
    expect_refuted<IsSymmetric>([](const Scene& scene, Quantity) {  // h instead of H
        return around(right(scene, Quantity::directed).lower);
    });
}

TEST(Metamorphic, IsZeroOfItself) {
    expect_of_every_solver<IsZeroOfItself>();
    expect_refuted<IsZeroOfItself>([](const Scene& scene, Quantity quantity) {  // the upper bound as the lower one
        return Bounds{right(scene, quantity).upper, right(scene, quantity).upper};
    });
}

TEST(Metamorphic, ForgetsCopies) {
    expect_of_every_solver<ForgetsCopies>();
    expect_refuted<ForgetsCopies>([](const Scene& scene, Quantity) {  // vertices without a face count
        return around(of_vertices(scene.source, cube(1)));
    });
}

// --- surfaces -------------------------------------------------------------------------------------------------------

AlgebraicSurface ball(const std::string& x, const std::string& squared_radius, double size = 2) {
    const std::string polynomial = fmt::format("({})^2 + y^2 + z^2 - {}", x, squared_radius);
    AlgebraicSurface s{polynomial, Points(2, 3)};
    s.box.row(0).setConstant(-size);
    s.box.row(1).setConstant(size);
    return s;
}

// Surfaces have no faces to reorder. Not every solver reaches the tolerance within its budget, so only bounds are
// compared.
TEST(Metamorphic, SurfacesObeyThem) {
    const AlgebraicSurface a = ball("x", "1"), b = ball("x - 1/4", "1"), c = ball("x + 1/4", "9/16");
    AlgebraicSurface turned = b;
    turned.polynomial = "x^2 + (y - 1/4)^2 + z^2 - 1";
    int tried = 0;
    for (const SolverEntry& entry : solvers()) {
        const SolverInfo& info = entry.info;
        if (!info.certified || !info.source.surface) continue;
        ++tried;
        const Ask ask = ask_of(entry);
        const auto h = [&](const AlgebraicSurface& s, const AlgebraicSurface& t) {
            return ask({s, t}, 0x1p-5, Quantity::directed);
        };
        const auto overlap = [](const Bounds& x, const Bounds& y) { return x.lower <= y.upper && y.lower <= x.upper; };
        const Bounds ab = h(a, b), bc = h(b, c), ac = h(a, c);
        EXPECT_EQ(h(a, a).lower, 0) << info.name;
        EXPECT_LE(ac.lower, std::nextafter(ab.upper + bc.upper, 9)) << info.name;
        EXPECT_TRUE(overlap(ab, h(a, turned))) << info.name << ": a quarter turn";
        const Bounds large = h(ball("x", "4", 4), ball("x - 1/2", "4", 4));
        EXPECT_TRUE(overlap({2 * ab.lower, 2 * ab.upper}, large)) << info.name << ": twice as large";
        const Bounds forth = ask({a, c}, 0x1p-5, Quantity::symmetric), back = ask({c, a}, 0x1p-5, Quantity::symmetric);
        EXPECT_TRUE(overlap(forth, back)) << info.name << ": H";
        EXPECT_GE(forth.upper, ac.lower) << info.name;
    }
    EXPECT_GE(tried, 2);
}

}  // namespace
}  // namespace hausbench::metamorphic
