// The solvers kang, zheng and sacht: each of their bounds under rounding, and their intervals against a slow reference.
#include "algorithms/kernel/closest.h"
#include "algorithms/registry.h"
#include "algorithms/search/piece_bounds.h"
#include "algorithms/session/session.h"
#include "tests/support/exact_points.h"
#include "tests/support/scenes.h"
#include "tests/support/small_scenes.h"

#include <functional>
#include <numbers>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using exact::Rational;
using exact::root;

constexpr double u = unit_roundoff;

Result solve(const std::string& name, const Scene& scene, const Query& query, const ParameterMap& given = {}) {
    const SolverEntry& entry = find_solver(name);
    const Session session(entry, Options(name, entry.info.parameters, given), scene, {});
    Trace trace;
    return session.solve(query, trace);
}

Query asking(double tolerance) {
    Query query;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    return query;
}

// --- rounding --------------------------------------------------------------------------------------------------------

TEST(SurfaceSum, HasAllOfWhatIsDerivedForIt) {
    Random random(1);
    for (int i = 0; i < 20000; ++i) {
        const double sum = random.unit() * std::ldexp(1, -i % 60), magnitude = std::ldexp(1, -static_cast<int>(i % 7));
        const int level = i % 50;
        const Rational bound = surface_sum_at_most(sum, magnitude, level);
        EXPECT_TRUE(bound >=
                    Rational(sum) * (1 + 5 * Rational(u)) + (8 + 2 * level) * Rational(u) * Rational(magnitude));
        EXPECT_TRUE(bound <=
                    Rational(sum) * (1 + 12 * Rational(u)) + (9 + 2 * level) * Rational(u) * Rational(magnitude));
    }
    EXPECT_EQ(surface_sum_at_most(0, 0, 3), 0);
}

// A computed barycentre is off the exact triangle by at most 2 * level_of_inner_point * u.
TEST(InnerPoints, AreWithinTheirLevelOfThePiece) {
    Random random(2);
    for (int i = 0; i < 3000; ++i) {
        const auto any_point = [&] { return Vec3(Vec3::Ones() - random.real(0, 0.3) * random.vector().cwiseAbs()); };
        const PieceCorners v{MeasuredPoint{any_point()}, {any_point()}, {any_point()}};
        const Vec3 centre = barycentre(v);
        const Rational most = 2 * level_of_inner_point * Rational(u);
        EXPECT_TRUE(exact::squared_distance_to_triangle(exact::vector(centre), exact::vector(v[0].point),
                                                        exact::vector(v[1].point),
                                                        exact::vector(v[2].point)) <= most * most);
    }
}

// Returns the squared radius with which balls around the corners cover the triangle: the circumradius if the triangle
// is acute, otherwise half of the longest edge.
Rational exact_squared_circumradius(const std::array<Vec3, 3>& v, bool& acute) {
    using exact::operator-;
    std::array<Rational, 3> edge;
    for (std::size_t k = 0; k < 3; ++k)
        edge[k] = exact::squared_distance(exact::vector(v[(k + 1) % 3]), exact::vector(v[(k + 2) % 3]));
    std::sort(edge.begin(), edge.end());
    acute = edge[0] + edge[1] > edge[2];
    if (!acute) return edge[2] / 4;
    const Rational sum = edge[0] + edge[1] + edge[2];
    const Rational area16 = sum * sum - 2 * (edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2]);  // 16 * area^2
    return edge[0] * edge[1] * edge[2] / area16;
}

std::array<Vec3, 3> any_shape(Random& random, int i) {
    const Vec3 a = random.vector(), b = random.vector(), c = random.vector();
    const double tiny = std::pow(10, random.real(-16, 0));
    const Vec3 e = b - a, n = e.cross(c - a).normalized() * std::sqrt(squared_length(e));
    switch (i % 6) {
        case 0:
            return {a, b, c};
        case 1:
            return {a, b, Vec3(a + tiny * c)};  // a needle
        case 2:
            return {a, b, Vec3(a + tiny * n)};  // roughly a right angle at a
        case 3:
            return {a, b, Vec3(0.5 * (a + b) + std::sqrt(0.75) * n)};  // roughly equilateral
        case 4:
            return {a, b, Vec3(0.5 * (a + b) + (0.5 + tiny * random.real(-1, 1)) * n)};  // roughly a right angle at c
        default:
            return {a, b, Vec3(a + random.unit() * e + tiny * n)};  // a cap
    }
}

TEST(CoveringRadius, IsThatOfTheExactTriangle) {
    Random random(3);
    for (int i = 0; i < 20000; ++i) {
        const auto v = any_shape(random, i);
        bool acute = false;
        const Rational squared = exact_squared_circumradius(v, acute);
        const Rational g = covering_radius_at_most(v);
        EXPECT_TRUE(g * g >= squared) << i;
        // The bound is tight except for thin triangles, whose largest angle may be taken as 60 degrees.
        EXPECT_TRUE(g * g <= squared * Rational(i % 6 == 0 ? 1.0001 : 1.34)) << i;
    }
}

// An obtuse and a right triangle: the radius, half of the longest edge, must be widened by the derived 15u.
TEST(CoveringRadius, IsWidenedByWhatIsDerived) {
    EXPECT_GE(covering_radius_at_most({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 0.1, 0)}), 0.5 * (1 + 15 * u));
    EXPECT_GE(covering_radius_at_most({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 0.5, 0)}), 0.5 * (1 + 15 * u));
    // The angles of so thin a triangle cannot be computed accurately. Assuming 60 degrees gives the radius 1 / sqrt(3).
    const double z = 1e-17;
    EXPECT_GE(covering_radius_at_most({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, z, 0)}), 0.57735);
}

// --- the bounds, one by one ------------------------------------------------------------------------------------------

PieceCorners measured(const std::array<Vec3, 3>& points, const TriangleMesh& b) {
    PieceCorners corners;
    Counters counters;
    for (std::size_t k = 0; k < 3; ++k) {
        const ClosestPoint nearest = closest_by_scan(b, points[k], {}, counters);
        corners[k] = {points[k], nearest.squared_distance, nearest.triangle};
    }
    return corners;
}

struct NamedBound {
    const char* name;
    std::function<double(PieceBounds&, const PieceCorners&, int)> bound;
};

const std::vector<NamedBound>& all_bounds() {
    static const std::vector<NamedBound> list{
        {"same", [](PieceBounds& p, const PieceCorners& v, int level) { return p.same_triangle(v, level); }},
        {"tied", [](PieceBounds& p, const PieceCorners& v, int level) { return p.tied_triangle(v, level); }},
        {"u1", [](PieceBounds& p, const PieceCorners& v, int level) { return p.u1(v, level); }},
        {"u2", [](PieceBounds& p, const PieceCorners& v, int level) { return p.u2(v, level); }},
        {"u3", [](PieceBounds& p, const PieceCorners& v, int level) { return p.u3(v, level); }},
        {"u4", [](PieceBounds& p, const PieceCorners& v, int level) { return p.u4(v, level); }},
        {"three", [](PieceBounds& p, const PieceCorners& v, int level) { return p.nearest_triangles(v, level); }},
        {"fourth", [](PieceBounds& p, const PieceCorners& v, int level) { return p.nearest_triangles(v, level, 0); }},
    };
    return list;
}

// Returns a piece of A and a small mesh B: apart, points near the piece, two triangles with a common edge, the piece
// cut up, or a mesh that contains the piece.
std::pair<std::array<Vec3, 3>, TriangleMesh> piece_and_target(Random& random, int i) {
    std::array<Vec3, 3> piece = any_shape(random, i);
    const auto near = [&](double size) {
        return Vec3(inside({piece[0], piece[1], piece[2]}, random) + random.vector(size));
    };
    switch (i / 6 % 5) {
        case 0:
            return {piece, soup(cloud(random, 3 * (1 + i % 5)))};
        case 1:
            return {piece, points_as_triangles({near(0.3), near(0.3), near(0.3)})};
        case 2: {  // two triangles that share an edge which crosses the piece
            const Vec3 p = near(0.1), q = near(0.1);
            return {piece, soup(rows({p, q, near(0.4), q, p, near(0.4)}))};
        }
        case 3: {  // the piece cut into three and slightly moved
            const Vec3 m = near(0.05);
            return {piece, soup(rows({piece[0], piece[1], m, piece[1], piece[2], m, piece[2], piece[0], m}))};
        }
        default: {
            std::vector<Vec3> p{piece[0], piece[1], piece[2], near(1), near(1), near(1)};
            return {piece, soup(rows({p[3], p[4], p[5], p[0], p[1], p[2], p[0], p[1], p[3]}))};
        }
    }
}

// Compares with exact distances of exact points, so no slack is needed.
TEST(PieceBounds, AreNoLessThanTheDistanceOfAnyPoint) {
    Random random(4);
    for (int i = 0; i < 600; ++i) {
        const auto [points, b] = piece_and_target(random, i);
        const PieceCorners v = measured(points, b);
        Counters counters;
        const Target target(b, nullptr);
        PieceBounds pieces(target, std::max(magnitude(rows({points[0], points[1], points[2]})), magnitude(b.vertices)),
                           counters);
        std::vector<double> bounds;
        for (const NamedBound& named : all_bounds()) bounds.push_back(named.bound(pieces, v, 0));
        for (int k = 0; k < 12; ++k) {
            // Corners and edges too, because the largest distances are there.
            Rational s = random.unit(), t = k % 3 == 0 ? Rational(0) : Rational(random.unit()) * (1 - s);
            if (k < 3) s = k == 1, t = k == 2;
            if (k == 3) s = t = Rational(1) / 3;
            using exact::operator-;
            const exact::RVec3 a = exact::vector(points[0]);
            const exact::RVec3 p =
                exact::along(exact::along(a, s, exact::vector(points[1]) - a), t, exact::vector(points[2]) - a);
            Rational squared = -1;
            for (Index j = 0; j < b.triangles.rows(); ++j) {
                const Triangle side = triangle_of(b, j);
                const Rational to = exact::squared_distance_to_triangle(p, exact::vector(side.a), exact::vector(side.b),
                                                                        exact::vector(side.c));
                if (squared < 0 || to < squared) squared = to;
            }
            for (std::size_t n = 0; n < bounds.size(); ++n) {
                if (std::isinf(bounds[n])) continue;
                EXPECT_TRUE(Rational(bounds[n]) * bounds[n] >= squared)
                    << all_bounds()[n].name << ", " << i << ", " << k;
            }
        }
    }
}

// B is two or three points, so the distance of the whole piece is known exactly.
TEST(PieceBounds, HoldExactlyAgainstPoints) {
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
        const auto points = any_shape(random, i);
        std::vector<Vec3> b{random.vector(), random.vector()};
        if (i % 3 == 0) b.push_back(random.vector());
        const TriangleMesh target_mesh = points_as_triangles(b);
        const Rational squared = exact_squared({points[0], points[1], points[2]}, b);
        Counters counters;
        const Target target(target_mesh, nullptr);
        PieceBounds pieces(target, 2, counters);
        const PieceCorners v = measured(points, target_mesh);
        for (const NamedBound& named : all_bounds()) {
            const double bound = named.bound(pieces, v, 0);
            if (std::isinf(bound)) continue;
            EXPECT_TRUE(Rational(bound) * Rational(bound) >= squared) << named.name << ", " << i;
        }
    }
}

// Each bound must be widened by 2 * u * M per level; bounds that cut the piece, also by level_of_inner_point. Other
// tests cannot show this, because roundings never all err in one direction.
TEST(PieceBounds, AreWidenedByTheirLevel) {
    const TriangleMesh two = points_as_triangles({{0, 0, 1}, {1, 0, 1}});
    const PieceCorners v = measured({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 0.25, 0)}, two);
    const Target target(two, nullptr);
    Counters counters;
    PieceBounds pieces(target, 1 << 20, counters);
    for (const NamedBound& named : all_bounds()) {
        const double at_0 = named.bound(pieces, v, 0), at_20 = named.bound(pieces, v, 20);
        if (std::isinf(at_0)) continue;
        EXPECT_GE(at_20 - at_0, 39 * u * (1 << 20)) << named.name;
    }
    // The plane between the two points cuts the piece at x = 1/2, where the distance is
    // sqrt(1.25), or sqrt(1.3125) at the third corner.
    const double cut = std::sqrt(1.3125), inner = 2 * level_of_inner_point * u * (1 << 20);
    EXPECT_GE(pieces.u4(v, 0), cut + 7 * u * (1 << 20) + inner);
}

TEST(PieceBounds, TwoTrianglesWithACommonEdgeAreExactForThePieceOverIt) {
    // A flat piece over the ridge of a roof: the plane through the ridge cuts the piece where the
    // two sides of the roof meet.
    const TriangleMesh roof = soup(rows({{0, -9, 1}, {0, 9, 1}, {-9, 0, 0}, {0, 9, 1}, {0, -9, 1}, {9, 0, 0}}));
    const PieceCorners v = measured({Vec3(-1, 0, 2), Vec3(2, -0.5, 2), Vec3(1.5, 0.5, 2)}, roof);
    ASSERT_NE(v[0].triangle, v[1].triangle);
    ASSERT_EQ(v[1].triangle, v[2].triangle);
    const Target target(roof, nullptr);
    Counters counters;
    PieceBounds pieces(target, 16, counters);
    const double most = std::sqrt(std::max({v[0].squared, v[1].squared, v[2].squared}));
    EXPECT_NEAR(pieces.u3(v, 0), most, 1e-12);
    EXPECT_GT(pieces.nearest_triangles(v, 0), most + 0.01);
}

TEST(PieceBounds, TheFourthSettlesAThinPieceThatTheThirdDoesNot) {
    // A thin piece between two far parts of B (Fig. 9 of the paper).
    const TriangleMesh ends = soup(rows({{0, 0, 0}, {-1, 0, 0}, {-1, 1, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}}));
    const PieceCorners v = measured({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 0.01, 0)}, ends);
    const Target target(ends, nullptr);
    Counters counters;
    PieceBounds pieces(target, 2, counters);
    EXPECT_LT(pieces.u4(v, 0), 0.501);
    EXPECT_GT(pieces.u3(v, 0), 0.6);
    EXPECT_GT(pieces.u1(v, 0), 0.9);
    EXPECT_GT(pieces.nearest_triangles(v, 0), 0.9);
}

// Both triangles of B lie on the same side of their common edge, so no plane separates them. The piece is cut at
// midpoints, and each cut counts with its larger distance: from (1, 1, 0), sqrt(1/2).
TEST(PieceBounds, TheThirdCountsEachCutAgainstBothTriangles) {
    const TriangleMesh folded = soup(rows({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {2, 1, 0}}));
    const Target target(folded, nullptr);
    Counters counters;
    PieceBounds pieces(target, 1 << 20, counters);
    const double most = std::sqrt(0.5), off = (7 + 2 * level_of_inner_point) * u * (1 << 20);
    const Vec3 one(0, 1, 0), below_one(0, 0.9, 0), two(2, 1, 0), below_two(2, 0.9, 0);
    for (const auto& piece :
         {std::array{one, two, below_two}, {one, below_two, two}, {two, one, below_one}, {two, below_one, one}}) {
        const PieceCorners v = measured(piece, folded);
        EXPECT_GE(pieces.u3(v, 0), most + off);
        EXPECT_LE(pieces.u3(v, 0), most + off + 2 * u * (1 << 20));
        EXPECT_TRUE(std::isinf(pieces.tied_triangle(v, 0)));
    }
}

// B consists of the piece's corners, so the barycentre is farthest, and the bound must include its rounding.
TEST(PieceBounds, TheThirdIsWidenedByWhatItsBarycentreIsOff) {
    const std::array<Vec3, 3> piece{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 0.75, 0)};
    const TriangleMesh points = points_as_triangles({piece[0], piece[1], piece[2]});
    const Target target(points, nullptr);
    Counters counters;
    PieceBounds pieces(target, 1 << 20, counters);
    const double most = std::sqrt(0.3125), off = (7 + 2 * level_of_inner_point) * u * (1 << 20);
    EXPECT_GE(pieces.u3(measured(piece, points), 0), most + off);
    EXPECT_LE(pieces.u3(measured(piece, points), 0), most + off + 2 * u * (1 << 20));
}

// A triangle that counts as tied may be farther because of rounding, here by 5e-4; the bound must include that.
TEST(PieceBounds, ATieCountsItsOwnDistances) {
    const TriangleMesh points = points_as_triangles({{0, 0, 0}, {3, 0, 2.9995}});
    const PieceCorners v = measured({Vec3(0, 0, 1), Vec3(3, 0, 0), Vec3(3, 0, 0)}, points);
    ASSERT_EQ(v[0].triangle, 0);
    ASSERT_EQ(v[1].triangle, 1);
    const Target target(points, nullptr);
    Counters counters;
    const double magnitude = 0x1p40;
    PieceBounds pieces(target, magnitude, counters);
    EXPECT_GE(pieces.tied_triangle(v, 0), 3 + 7 * u * magnitude);
    EXPECT_LE(pieces.tied_triangle(v, 0), 3 + 9 * u * magnitude);
}

TEST(PieceBounds, TheFourthDividesNothingByZero) {
    const TriangleMesh point = points_as_triangles({{0, 0, 1}});
    const PieceCorners v = measured({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, point);
    const Target target(point, nullptr);
    Counters counters;
    PieceBounds pieces(target, 1, counters);
    EXPECT_NEAR(pieces.u4(v, 0), std::numbers::sqrt2, 1e-14);
}

// --- the solvers -----------------------------------------------------------------------------------------------------

// Returns every order of every subset of the bounds 1 to 4, such as "31".
std::vector<std::string> orders() {
    std::vector<std::string> all{""};
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (const char digit : {'1', '2', '3', '4'}) {
            if (all[i].find(digit) == std::string::npos) all.push_back(all[i] + digit);
        }
    }
    all.erase(all.begin());
    return all;
}

TEST(Cascade, IntervalsHoldTheAnswerOfTheReference) {
    Random random(6);
    int converged = 0, count = 0;
    for (int i = 0; i < 300; ++i) {
        const Scene scene = small_scene(random, i);
        const auto truth = truth_of(scene);
        for (const char* name : {"kang", "zheng", "sacht"}) {
            for (const char* split : {"midpoint", "longest_edge"}) {
                Query query = asking(1e-5);
                query.budget = 20000;
                const Result result = solve(name, scene, query, {{"split", std::string(split)}});
                const std::string where = std::string(name) + " " + split + ", scene " + std::to_string(i);
                expect_sound(result, truth, 1e-5, where);
                converged += result.status == Status::converged, ++count;
                EXPECT_TRUE(result.status == Status::converged || result.status == Status::budget) << where;
            }
        }
    }
    EXPECT_GE(converged, 0.95 * count);
}

TEST(Cascade, AllOrdersAgree) {
    Random random(7);
    ASSERT_EQ(orders().size(), 64u);
    for (int i = 0; i < 20; ++i) {
        const Scene scene = small_scene(random, i);
        const auto truth = truth_of(scene);
        for (const std::string& order : orders()) {
            Query query = asking(1e-3);
            query.budget = 3000;
            expect_sound(solve("sacht", scene, query, {{"order", order}}), truth, 1e-3,
                         order + ", scene " + std::to_string(i));
        }
    }
}

// Each corner of one mesh lies in several triangles of the other; which of them is reported is arbitrary.
TEST(Cascade, IdenticalMeshesAreDoneAfterFewSplits) {
    const Scene scene{sheet(8, 0, 0.3), sheet(8, 0, 0.3)};
    Query query = asking(1e-9);
    query.budget = 1000;
    for (const char* name : {"kang", "zheng", "sacht"}) {
        const Result result = solve(name, scene, query);
        EXPECT_EQ(to_string(result.status), "converged") << name;
        EXPECT_EQ(result.bounds.lower, 0) << name;
    }
    for (const std::string& order : orders())
        EXPECT_EQ(to_string(solve("sacht", scene, query, {{"order", order}}).status), "converged") << order;
}

TEST(Cascade, VerticesOfNoTriangleDoNotCount) {
    TriangleMesh a = sheet(3, 0.5), b = sheet(4, 0);
    a.vertices.conservativeResize(10, 3);
    a.vertices.row(9) << 1, 1, 9;
    b.vertices.conservativeResize(17, 3);
    b.vertices.row(16) << 1, 1, 0.5;
    for (const char* name : {"kang", "zheng", "sacht"}) {
        const Result result = solve(name, {a, b}, asking(1e-9));
        EXPECT_EQ(to_string(result.status), "converged") << name;
        EXPECT_NEAR(result.bounds.upper, 0.5, 1e-9) << name;
    }
}

// The farthest point is a barycentre, which rounding may put up to 6 * u * M off A. The lower bound must allow for
// that.
TEST(Zheng, ABarycentreThatIsFarthestIsWidened) {
    const TriangleMesh a = soup(rows({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
    const TriangleMesh b = points_as_triangles({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    Query query = asking(1e-9);
    query.budget = 0;
    const Result result = solve("zheng", {a, b}, query);
    Counters counters;
    const double far = certified_distance_by_scan(b, result.witness.source_point, counters);
    EXPECT_NEAR(far, std::sqrt(2.0 / 3), 1e-9);
    EXPECT_LE(result.bounds.lower, far - 2 * level_of_inner_point * u);
    EXPECT_GE(result.bounds.lower, far - 1e-14);
}

TEST(Sacht, MaxFactorEndsAsABudget) {
    Random random(8);
    const Scene scene{soup(cloud(random, 30)), soup(cloud(random, 300))};  // 10 triangles
    const auto spent = [&](double factor, const char* split) {
        const Result result =
            solve("sacht", scene, asking(1e-12), {{"max_factor", factor}, {"split", std::string(split)}});
        EXPECT_EQ(to_string(result.status), "budget");
        EXPECT_EQ(result.note, "max_factor was spent");
        return result.counters.subdivisions;
    };
    EXPECT_EQ(spent(1, "midpoint"), 0u);
    EXPECT_EQ(spent(9, "midpoint"), 20u);
    EXPECT_EQ(spent(9, "longest_edge"), 40u);
    Query query = asking(1e-12);
    query.budget = 7;
    const Result result = solve("sacht", scene, query, {{"max_factor", 9.0}});
    EXPECT_EQ(result.counters.subdivisions, 7u);
    EXPECT_EQ(result.note, "");
}

TEST(Sacht, OrderIsCheckedAndUsed) {
    Random random(9);
    const Scene scene{soup(cloud(random, 60)), soup(cloud(random, 300))};
    for (const char* wrong : {"", "5", "11", "12 3", "u1"})
        EXPECT_ANY_THROW(solve("sacht", scene, asking(1), {{"order", std::string(wrong)}})) << wrong;
    Query query = asking(1e-3);
    query.budget = 100;
    const auto counts = [&](const char* order) {
        return solve("sacht", scene, query, {{"order", std::string(order)}}).counters;
    };
    EXPECT_NE(counts("1"), counts("2"));
    EXPECT_NE(counts("1234"), counts("4321"));
    EXPECT_EQ(solve("sacht", scene, query, {{"order", std::string("3")}}).counters,
              solve("kang", scene, query, {{"closest", std::string("bvh")}}).counters);
}

TEST(Sacht, TellsTheBoundThatWasComputedLast) {
    Query query = asking(1e-6);
    query.wanted.fields = true;
    const Scene scene{sheet(5, 0.1, 0.2), sheet(7, 0, 0.3)};
    for (const auto& [order, most] : {std::pair{"1234", 4.0}, {"21", 2.0}, {"3", 3.0}}) {
        const Result result = solve("sacht", scene, query, {{"order", std::string(order)}});
        const Field& field = result.fields->back();
        EXPECT_EQ(field.name, "bound");
        ASSERT_EQ(field.values.size(), 32u);
        EXPECT_LE(*std::max_element(field.values.begin(), field.values.end()), most);
        EXPECT_GT(*std::max_element(field.values.begin(), field.values.end()), 0);
    }
}

}  // namespace
}  // namespace hausbench
