// Each term that threshold cover adds to its bounds, for rounding or for halved pieces, has a test here that fails
// without it, if necessary by calling one part of the search. All comparisons are exact.
#include "algorithms/kernel/rounding.h"
#include "algorithms/meshes/cover/batch.h"
#include "algorithms/meshes/cover/groups.h"
#include "algorithms/meshes/cover/offset_cover.h"
#include "algorithms/meshes/cover/work.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/exact.h"
#include "tests/support/scenes.h"
#include "tests/support/tree_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using namespace cover;

using exact::Rational;

constexpr double u = unit_roundoff;

Rational squared_to_triangle(const exact::RVec3& p, const Triangle& t) {
    return exact::squared_distance_to_triangle(p, exact::vector(t.a), exact::vector(t.b), exact::vector(t.c));
}

// Returns the exact squared distance of a point to a mesh. Requires coordinates of about 1 or a single triangle,
// because computed distances select the candidates.
Rational squared_to_mesh(const Vec3& p, const TriangleMesh& mesh) {
    Counters counters;
    const double seems = closest_by_scan(mesh, p, {}, counters).squared_distance;
    Rational least = -1;
    for (Index i = 0; i < mesh.triangles.rows(); ++i) {
        if (closest_point(p, triangle_of(mesh, i)).squared_distance > seems * (1 + 1e-6) + 1e-20) continue;
        const Rational squared = squared_to_triangle(exact::vector(p), triangle_of(mesh, i));
        if (least < 0 || squared < least) least = squared;
    }
    return least;
}

bool is_at_least(double bound, const Rational& squared) { return Rational(bound) * Rational(bound) >= squared; }

Query with_tolerance(double tolerance) {
    Query query;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    return query;
}

Result answer(const TriangleMesh& a, const TriangleMesh& b, double tolerance) {
    Trace trace;
    return Session(find_solver("cover"), Options("cover", {}, {}), Scene{a, b}, {})
        .solve(with_tolerance(tolerance), trace);
}

// --- whole searches -------------------------------------------------------------------------------------------------

// Neighbouring triangles of A share a landmark (a point with a known distance to B). One of them reaches much farther
// than the others.
TEST(Cover, APieceThatReachesFarIsNotSettledByItsNeighbours) {
    TriangleMesh b = sheet(20, 0);
    b.vertices *= 1.0 / 19;
    for (Index spike = 0; spike < 8; ++spike) {
        Points vertices(24, 3);
        for (Index i = 0; i < 8; ++i) {
            const double x = 0.1 + 0.1 * static_cast<double>(i);
            vertices.row(3 * i) = Vec3(x, 0.5, 0);
            vertices.row(3 * i + 1) = Vec3(x + 0.01, 0.5, 0);
            vertices.row(3 * i + 2) = i == spike ? Vec3(x, 0.5, 1) : Vec3(x, 0.51, 0);
        }
        const Result result = answer(soup(vertices), b, 0.5);
        EXPECT_GE(result.bounds.upper, 1) << spike;
        EXPECT_LE(result.bounds.lower, 1) << spike;
    }
}

// A is a single point, so its upper bound comes from one computed distance.
TEST(Cover, TheRoundingOfAMeasuredDistanceIsCounted) {
    Random random(51);
    int below = 0;  // computed distances that are smaller than the exact ones
    for (int i = 0; i < 200; ++i) {
        const TriangleMesh b = triangle_soup(random, 1, 0.6);
        const Vec3 p = random.vector(0.9);
        const Result result = answer(soup(rows({p, p, p})), b, 1e-3);
        const Rational squared = squared_to_mesh(p, b);
        EXPECT_TRUE(is_at_least(result.bounds.upper, squared)) << i;
        below += !is_at_least(std::sqrt(closest_point(p, triangle_of(b, 0)).squared_distance), squared);
    }
    EXPECT_GE(below, 20);
}

// A's triangles are two points above B, four at each, which share one computed distance. The bound must include its
// rounding.
TEST(Cover, TheRoundingOfASharedDistanceIsCounted) {
    Random random(57);
    TriangleMesh b = sheet(18, 0, 0.3);
    b.vertices *= 1.0 / 17;
    int below = 0;
    for (int i = 0; i < 40; ++i) {
        Points vertices(24, 3);
        const Vec3 places[2] = {Vec3(0.2, 0.3, 0.4) + random.vector(0.1), Vec3(0.8, 0.7, 0.4) + random.vector(0.1)};
        for (Index v = 0; v < 24; ++v) vertices.row(v) = places[v / 12];
        const Result result = answer(soup(vertices), b, 0.5);
        Rational farthest = 0;
        double computed = 0;
        for (const Vec3& p : places) {
            farthest = std::max(farthest, squared_to_mesh(p, b));
            Counters counters;
            computed = std::max(computed, std::sqrt(closest_by_scan(b, p, {}, counters).squared_distance));
        }
        EXPECT_TRUE(is_at_least(result.bounds.upper, farthest)) << i;
        below += !is_at_least(computed, farthest);
    }
    EXPECT_GE(below, 5);
}

// --- boxes of groups ------------------------------------------------------------------------------------------------

TEST(GroupBoxes, HoldAllTheirTriangles) {
    Random random(52);
    for (const Index count : {1, 40, 1100, 4200}) {
        const TriangleMesh mesh = triangle_soup(random, count, 0.1);
        const TriangleOrder order(mesh);
        const GroupBoxes boxes(mesh.triangles, mesh.vertices, order.order);
        EXPECT_EQ(boxes.levels(), count <= 1024 ? 1U : count <= 4096 ? 2U : 3U);
        for (std::size_t level = 0; level < boxes.levels(); ++level) {
            for (std::size_t i = 0; i < order.order.size(); ++i) {
                const Box& box = boxes.box(level, i / GroupBoxes::triangles_of_group(level));
                for (const Index v : mesh.triangles.row(order.order[i])) {
                    const Vec3 p = mesh.vertices.row(v);
                    ASSERT_TRUE((p.array() >= box.low.array()).all() && (p.array() <= box.high.array()).all())
                        << count << ", level " << level;
                }
            }
        }
    }
}

// A triangle of A whose longest edge runs diagonally through the cube [-2, 2]^3, and a small triangle of B beyond each
// of its corners.
struct AcrossThePlace {
    Triangle a;
    TriangleMesh b;

    explicit AcrossThePlace(std::uint64_t seed) {
        Random random(seed);
        for (int i = 0; i < 4; ++i) random.bits();
        const auto end = [&](Vec3& corner, std::initializer_list<int> signs) {
            Index k = 0;
            for (const int sign : signs) corner[k++] = sign * random.real(1.8, 2);
        };
        end(a.a, {-1, -1, -1});
        end(a.b, {1, 1, 1});
        end(a.c, {1, -1});
        a.c[2] = random.real(-1, 1);
        const double away[3] = {random.real(0, 0.5), random.real(0, 0.5), random.real(0, 0.5)};
        Points vertices(9, 3);
        for (Index v = 0; v < 9; ++v) {
            const Vec3 moved = (v < 3 ? a.a : v < 6 ? a.b : a.c) * (1 + away[v / 3]);
            vertices.row(v) = moved + random.vector(0.01);
        }
        b = soup(vertices);
    }
};

// --- pieces of a level ----------------------------------------------------------------------------------------------
//
// A corner of a piece of level k may be 2 * k * u * M off the point of A that it represents (kernel/rounding.h). Real
// searches rarely reach half of that, so these tests make pieces by hand.

// A cover::Work with a single triangle of A. A `magnitude` above all coordinates makes the rounding terms as large as if
// something were far away.
class Alone {
public:
    Alone(const Triangle& a, TriangleMesh b, double tolerance, double magnitude = 0)
        : a_(soup(rows({a.a, a.b, a.c}))),
          b_(std::move(b)),
          query_(with_tolerance(tolerance)),
          magnitude_(magnitude > 0 ? magnitude : std::max(largest(a_), largest(b_))),
          work_({a_, a_.vertices, target_, blocks_, order_, query_, magnitude_, 64 * u * magnitude_, nullptr, nullptr,
                 nullptr}) {
        begin({});
    }

    void begin(const Farthest& farthest) {
        work_.begin(farthest, 0, std::numeric_limits<std::uint64_t>::max(), false, deadline_);
    }
    cover::Piece piece(int level) const { return {corners(), 0, 0, {}, landmark(), level}; }
    std::array<Vec3, 3> corners() const { return {a_.vertices.row(0), a_.vertices.row(1), a_.vertices.row(2)}; }
    Landmark landmark() const {
        Counters counters;
        const ClosestPoint nearest = target_.closest(a_.vertices.row(0), -1, counters);
        return {a_.vertices.row(0), std::sqrt(nearest.squared_distance), nearest.triangle, 0};
    }
    cover::Work& work() { return work_; }
    const TriangleMesh& b() const { return b_; }
    double magnitude() const { return magnitude_; }
    // Returns how far a corner of a piece of this level may be off A.
    double off(int level) const { return 2 * level * u * magnitude_; }

    // Checks that a point is within off(level) of the triangle of A.
    bool is_near(const Vec3& point, int level) const { return is_at_least(off(level), squared_to_mesh(point, a_)); }

private:
    static double largest(const TriangleMesh& mesh) { return mesh.vertices.cwiseAbs().maxCoeff(); }

    TriangleMesh a_, b_;
    TriangleBlocks blocks_{b_};
    Target target_{b_, &blocks_};
    std::vector<Index> order_{0};
    Query query_;
    double magnitude_;
    Deadline deadline_{std::numeric_limits<double>::infinity()};
    cover::Work work_;
};

// Returns two large triangles in the plane z = 0, one on each side of x = 0.
TriangleMesh two_halves() {
    return soup(rows({{-20, 0, 0}, {0, -10, 0}, {0, 10, 0}, {20, 0, 0}, {0, 10, 0}, {0, -10, 0}}));
}
Triangle at_height(double z, double shift) {
    return {{-1 + shift, -0.5, z}, {1 + shift, -0.5, z}, {0.25 + shift, 0.75, z}};
}

constexpr int high_level = 20;
constexpr double far_away = 0x1p40, um = u * far_away;

// Returns the tolerance for which the cover threshold tau is above * u * M above the lower bound.
constexpr double tolerance_of(double above) { return above * um / 0.9; }

// Returns a farthest point at distance 1, so that the lower bound is 1.
Farthest at_one() {
    Farthest farthest;
    farthest.point.squared = 1;
    return farthest;
}

// One triangle of B bounds all corners. The bound and the measured corner must include the error of the piece's level.
TEST(CoverWork, ABoundByCornersHoldsForTheExactPiece) {
    Alone alone(at_height(1, -3), two_halves(), 0.1, far_away);
    alone.work().decide(alone.piece(high_level));
    const cover::Outcome outcome = alone.work().finish();
    EXPECT_GE(outcome.settled, 1 + alone.off(high_level));
    EXPECT_LE(outcome.settled, 1.1);
    EXPECT_GE(outcome.farthest.level, high_level);
}

TEST(CoverWork, ACoverInDoublePrecisionHoldsForTheExactPiece) {
    Alone alone(at_height(1, 0), two_halves(), tolerance_of(70), far_away);
    alone.work().decide(alone.piece(high_level));
    const cover::Outcome outcome = alone.work().finish();
    EXPECT_GE(outcome.settled, 1 + alone.off(high_level));
    EXPECT_LE(outcome.settled, 1 + 71 * um);
}

TEST(CoverWork, ACoverInSinglePrecisionHoldsForTheExactPiece) {
    Alone alone(at_height(1, 0), two_halves(), tolerance_of(70), far_away);
    alone.begin(at_one());
    const cover::Piece piece = alone.piece(high_level);
    alone.work().cover(std::span(&piece, 1), piece.landmark);
    const cover::Outcome outcome = alone.work().finish();
    EXPECT_TRUE(outcome.undecided.empty());
    EXPECT_GE(outcome.settled, 1 + alone.off(high_level));
    EXPECT_LE(outcome.settled, 1 + 71 * um);
}

// A piece counts as covered only if its bound, including all widening, is at most the threshold tau.
TEST(CoverWork, WhatIsCoveredIsWithinTau) {
    constexpr double tau = 1 + 0.9 * 0.1;
    for (const int level : {0, high_level}) {
        int covered = 0;
        for (int below = 0; below <= 120; below += 3) {
            Alone alone(at_height(tau - below * um, 0), two_halves(), 0.1, far_away);
            alone.begin(at_one());
            const cover::Piece piece = alone.piece(level);
            alone.work().cover(std::span(&piece, 1), piece.landmark);
            const cover::Outcome outcome = alone.work().finish();
            EXPECT_LE(outcome.settled, tau) << level << ", " << below;
            covered += outcome.undecided.empty();
        }
        EXPECT_GE(covered, 10);
        EXPECT_LE(covered, 40);
    }
}

// Many triangles of B are near, so a corner of the piece is measured first, at 0.4. Its distance and the way to the other
// corners are more than tau together, but the triangle nearest to it bounds all corners. The farthest is exactly 0.45
// away.
TEST(CoverWork, ABoundByTheTriangleNearestToACornerHolds) {
    TriangleMesh b = soup(rows({{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}}));
    const TriangleMesh below = sheet(20, -0.1);
    Points vertices(3 + 3 * below.triangles.rows(), 3);
    vertices.topRows(3) = b.vertices;
    for (Index i = 0; i < below.triangles.rows(); ++i) {
        for (Index k = 0; k < 3; ++k) {
            const Vec3 p = below.vertices.row(below.triangles(i, k));
            vertices.row(3 + 3 * i + k) = Vec3(p[0] / 19 - 0.5, p[1] / 19 - 0.5, p[2]);
        }
    }
    b = soup(vertices);
    const Triangle t{{-0.3, -0.2, 0.4}, {0.3, -0.2, 0.45}, {0, 0.3, 0.42}};
    for (const bool alone_at_once : {false, true}) {
        Alone alone(t, b, 0.1);
        Farthest begin;
        begin.point.squared = 0.16;
        alone.begin(begin);
        const std::array<cover::Piece, 2> pieces{alone.piece(0), alone.piece(0)};
        if (alone_at_once)
            alone.work().decide(pieces[0]);
        else
            alone.work().cover(pieces, alone.landmark());
        const cover::Outcome outcome = alone.work().finish();
        EXPECT_TRUE(outcome.undecided.empty());
        EXPECT_GT(outcome.counters.closest_point_queries, 0U);
        EXPECT_EQ(outcome.counters.subdivisions, 0U);
        EXPECT_GE(outcome.settled, 0.45) << alone_at_once;
        EXPECT_LE(outcome.settled, 0.45 + 1e-12) << alone_at_once;
    }
}

// The tolerance is 0. Unless the threshold exceeds the lower bound by the rounding errors, nothing can be covered, and
// the piece gets its bound from one triangle of B, here more than 1.4.
TEST(CoverWork, WithoutAToleranceItCoversAllTheSame) {
    for (const int level : {0, high_level}) {
        Alone alone(at_height(1, 0), two_halves(), 0);
        alone.work().decide(alone.piece(level));
        EXPECT_LE(alone.work().finish().settled, 1 + 1e-10) << level;
    }
}

// The tolerance is 0, and coordinates are so large that even the lower bound errs by a fraction of M. B is rotated, so
// that closest points are rounded.
TEST(CoverWork, WithoutAToleranceItCoversAllTheSameFarAway) {
    Random random(58);
    for (int i = 0; i < 20; ++i) {
        const Vec3 e = random.vector().normalized(), g = random.vector(), h = (g - g.dot(e) * e).normalized(),
                   n = e.cross(h);
        const auto moved = [&](const Vec3& p) -> Vec3 {
            return Vec3::Constant(0x1p30) + (p[0] * e + p[1] * h + p[2] * n);
        };
        TriangleMesh halves = two_halves();
        for (Index v = 0; v < halves.vertices.rows(); ++v) halves.vertices.row(v) = moved(halves.vertices.row(v));
        const Triangle t = at_height(1, 0);
        Alone alone({moved(t.a), moved(t.b), moved(t.c)}, halves, 0);
        alone.work().decide(alone.piece(30));
        EXPECT_LE(alone.work().finish().settled, 1 + 200 * u * 0x1p31) << i;
    }
}

// So many triangles of B are near that the piece is halved. Its farthest corner, measured in a half, must keep its
// level.
TEST(CoverWork, ACornerOfAHalfIsOffByItsLevel) {
    TriangleMesh b = sheet(30, 0);
    b.vertices.leftCols(2) *= 2.0 / 29;
    Alone alone({{0.5, 0.5, 0.5}, {1.5, 0.5, 1.5}, {1, 1.5, 0.5}}, b, 1e-6, far_away);
    alone.work().decide(alone.piece(5));
    const cover::Outcome outcome = alone.work().finish();
    EXPECT_GT(outcome.counters.subdivisions, 0U);
    EXPECT_EQ(outcome.farthest.point.point, Vec3(1.5, 0.5, 1.5));
    EXPECT_GE(outcome.farthest.level, 5);
}

// The farthest point is inside a piece, above a gap in B. Its level must be higher than the piece's, for its own
// rounding.
TEST(CoverWork, APointInsideAPieceIsOffByItsLevel) {
    TriangleMesh b = two_halves();
    for (Index v = 0; v < b.vertices.rows(); ++v) b.vertices(v, 0) += v < 3 ? -0.75 : 0.75;
    Alone alone(at_height(0.125, 0), b, 1e-3, 0x1p20);
    alone.work().decide(alone.piece(high_level));
    const cover::Outcome outcome = alone.work().finish();
    EXPECT_GT(outcome.farthest.point.squared, 0.5);
    EXPECT_GE(outcome.farthest.level, high_level + 1);
}

// B is a bowl with many triangles under the triangle of A, which is therefore halved. The farthest point is the
// midpoint of its longest edge, which is rounded.
TEST(CoverWork, PointsOfHalvesAreAsNearToAAsTheirLevelSays) {
    Random random(53);
    int off_a = 0, off_a_undecided = 0;
    for (int i = 0; i < 20; ++i) {
        TriangleMesh bowl = sheet(30, 0);
        for (Index v = 0; v < bowl.vertices.rows(); ++v) {
            const double x = bowl.vertices(v, 0) / 14.5 - 1, y = bowl.vertices(v, 1) / 14.5 - 1;
            bowl.vertices.row(v) = Vec3(x, y, 0.5 * (x * x + y * y) - 1);
        }
        const Triangle t{Vec3(-0.9, 0, 0) + random.vector(0.05), Vec3(0.9, 0, 0) + random.vector(0.05),
                         Vec3(0.3, 0.6, 0) + random.vector(0.05)};
        Alone alone(t, bowl, 1e-12);
        Farthest begin;  // so far away that the whole bowl counts as near
        begin.point = {t.a, 0.25, 0};
        begin.source = 0;
        alone.begin(begin);
        Cluster cluster;
        cluster.count = 1;
        cluster.landmark = alone.landmark();
        alone.work().cover(cluster);
        const cover::Outcome outcome = alone.work().finish();
        ASSERT_GT(outcome.counters.subdivisions, 0U);
        const MeasuredPoint& farthest = outcome.farthest.point;
        EXPECT_TRUE(alone.is_near(farthest.point, outcome.farthest.level)) << i;
        off_a += !alone.is_near(farthest.point, 0);
        for (const cover::Piece& piece : outcome.undecided) {
            for (const Vec3& corner : piece.corners) {
                EXPECT_TRUE(alone.is_near(corner, piece.level)) << i;
                off_a_undecided += !alone.is_near(corner, 0);
            }
        }
    }
    EXPECT_GE(off_a, 5);
    EXPECT_GE(off_a_undecided, 5);
}

// Points inside a piece are rounded when they are moved back from local coordinates, most of all far from the origin.
TEST(CoverWork, PointsInsideAPieceAreAsNearToAAsTheirLevelSays) {
    Random random(54);
    int off_a = 0;
    for (int i = 0; i < 60; ++i) {
        const Vec3 away = i % 3 == 0 ? Vec3(Vec3::Zero()) : Vec3(1000, 1000, 1000);
        TriangleMesh rim = triangle_soup(random, 6, 0.3);
        for (Index v = 0; v < rim.vertices.rows(); ++v) {
            const Vec3 p = rim.vertices.row(v);
            rim.vertices.row(v) = away + 2 * p;
        }
        Alone alone({away + random.vector(), away + random.vector(), away + random.vector()}, rim, 1e-9);
        alone.work().decide(alone.piece(0));
        const cover::Outcome outcome = alone.work().finish();
        EXPECT_TRUE(alone.is_near(outcome.farthest.point.point, outcome.farthest.level)) << i;
        off_a += !alone.is_near(outcome.farthest.point.point, 0);
    }
    EXPECT_GE(off_a, 10);
}

// The worst of 20,000 scenes: after many cuts, the farthest point is more than 3 * u * M off A. Conversion from local
// coordinates explains less than 2 * u * M.
TEST(CoverWork, APointAfterManyCutsIsAsNearToAAsItsLevelSays) {
    for (const std::uint64_t seed : {107216, 117211, 118560}) {
        const AcrossThePlace scene(seed);
        Alone alone(scene.a, scene.b, 1e-9, 2);
        alone.work().decide(alone.piece(0));
        const Farthest farthest = alone.work().finish().farthest;
        EXPECT_TRUE(alone.is_near(farthest.point.point, farthest.level)) << seed;
        EXPECT_FALSE(alone.is_near(farthest.point.point, 1)) << seed;
    }
}

// --- covers ---------------------------------------------------------------------------------------------------------

LocalUnits unit_place() {
    LocalUnits units;
    Box box;
    box.add(Vec3(-1, -1, -1));
    box.add(Vec3(1, 1, 1));
    units.set(box, 0x1p-100);
    return units;
}

cover::Polygon<double> polygon_of(const Triangle& t, const LocalUnits& place, float slack = 0) {
    cover::Polygon<double> polygon;
    for (const Vec3* corner : {&t.a, &t.b, &t.c}) {
        const Vec3 local = *corner * place.inverse;
        polygon.add(local[0], local[1], local[2], slack);
    }
    return polygon;
}

// Measures points by trying all triangles of B, and checks that each point is within its slack of the exact piece.
class CheckingHost final : public cover::Host {
public:
    // The exact corners are the corners of the piece, moved along z by their slack.
    CheckingHost(const TriangleMesh& mesh, const LocalUnits& units, const cover::Polygon<double>& piece,
                 double tolerance)
        : mesh_(mesh), units_(units), tolerance_(tolerance) {
        for (std::size_t i = 0; i < 3; ++i)
            corner_[i] = {Rational(piece.x[i]), Rational(piece.y[i]),
                          Rational(piece.z[i]) + Rational(u) * Rational(piece.slack[i])};
    }

    Index measure(const double (&point)[3], double slack, Index) override {
        const exact::RVec3 p{Rational(point[0]), Rational(point[1]), Rational(point[2])};
        const Rational squared = exact::squared_distance_to_triangle(p, corner_[0], corner_[1], corner_[2]);
        EXPECT_TRUE(is_at_least(slack * u, squared)) << slack << ", but off by " << exact::root(squared) / u << " u";
        ++measured;
        off += squared > 0;
        farthest_off = std::max(farthest_off, static_cast<double>(exact::root(squared)) / u);
        Counters counters;
        const Vec3 global(units_.unit * point[0], units_.unit * point[1], units_.unit * point[2]);
        const ClosestPoint nearest = closest_by_scan(mesh_, global, {}, counters);
        lower = std::max(lower, std::sqrt(nearest.squared_distance));
        return nearest.triangle;
    }
    double threshold() const override { return (lower + tolerance_) * units_.inverse; }
    bool promising(double distance) const override { return distance * units_.unit > lower + 0.2 * tolerance_; }
    bool go_on() override { return ++work < 2000; }

    double lower = 0;
    double farthest_off = 0;  // in units of u
    int measured = 0, off = 0, work = 0;

private:
    const TriangleMesh& mesh_;
    const LocalUnits& units_;
    double tolerance_;
    std::array<exact::RVec3, 3> corner_;
};

OffsetCover<double> cover_of(const TriangleMesh& mesh, const LocalUnits& place) {
    OffsetCover<double> cover;
    std::vector<Index> all(static_cast<std::size_t>(mesh.triangles.rows()));
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<Index>(k);
    cover.near.clear(place);
    set_frames(mesh, all, cover.near);
    return cover;
}

TEST(OffsetCover, EveryPointIsWithinItsSlack) {
    Random random(55);
    const LocalUnits place = unit_place();
    const auto end = [&] { return (random.below(2) == 0 ? -1 : 1) * random.real(1.8, 2); };
    int measured = 0, off = 0;
    for (int i = 0; i < 2000; ++i) {
        Triangle t{random.vector(), random.vector(), random.vector()};
        if (i % 2 == 0) t = {{end(), end(), end()}, {end(), end(), end()}, {end(), end(), end()}};  // long edges
        TriangleMesh mesh = triangle_soup(random, 2 + random.below(12), 0.6);
        if (i % 4 == 1) {  // only corners are near B, so the centre is measured first
            const auto beside = [&](const Vec3& corner) -> Vec3 { return corner + random.vector(0.01); };
            mesh = soup(
                rows({t.a, beside(t.a), beside(t.a), t.b, beside(t.b), beside(t.b), t.c, beside(t.c), beside(t.c)}));
        }
        const cover::Polygon<double> polygon = polygon_of(t, place, i % 8 == 7 ? 200 : 0);
        CheckingHost host(mesh, place, polygon, 1e-9);
        OffsetCover<double> cover = cover_of(mesh, place);
        cover.set_threshold(host.threshold());
        ASSERT_TRUE(cover_surely(cover, polygon, host, mesh).covered);
        measured += host.measured, off += host.off;
    }
    EXPECT_GE(measured, 1000);
    EXPECT_GE(off, 500);
}

// The worst of 30,000 scenes: one cut near the end of a long edge puts a corner more than 2u off the piece's plane.
TEST(OffsetCover, ACutFarAlongALongEdgeIsWithinItsSlack) {
    const LocalUnits place = unit_place();
    for (const std::uint64_t seed : {107891, 112503, 117661, 120264, 125699}) {
        const AcrossThePlace scene(seed);
        const cover::Polygon<double> polygon = polygon_of(scene.a, place);
        CheckingHost host(scene.b, place, polygon, 1e-9);
        OffsetCover<double> cover = cover_of(scene.b, place);
        cover.set_threshold(host.threshold());
        EXPECT_TRUE(cover_surely(cover, polygon, host, scene.b).covered);
        EXPECT_GT(host.farthest_off, 2) << seed;
    }
}

// B is one triangle, far larger than the local box. Its distance errs by a fraction of its own size, which the bound
// must include.
TEST(OffsetCover, TheSizeOfATriangleIsInItsError) {
    Random random(56);
    const LocalUnits place = unit_place();
    int below = 0;
    for (int i = 0; i < 200; ++i) {
        const TriangleMesh mesh = soup(rows({random.vector(0x1p24), random.vector(0x1p24), random.vector(0x1p24)}));
        const Triangle t{random.vector(), random.vector(), random.vector()};
        const cover::Polygon<double> polygon = polygon_of(t, place);
        CheckingHost host(mesh, place, polygon, 0x1p30);
        OffsetCover<double> cover = cover_of(mesh, place);
        cover.set_threshold(host.threshold());
        const CoverResult result = cover_surely(cover, polygon, host, mesh);
        ASSERT_TRUE(result.covered);
        Rational farthest = 0;
        for (const Vec3* corner : {&t.a, &t.b, &t.c})
            farthest = std::max(farthest, squared_to_triangle(exact::vector(*corner), triangle_of(mesh, 0)));
        EXPECT_TRUE(is_at_least(result.upper * place.unit, farthest)) << i;
        const double without = u * (near_error<double> * 1.75 + 4096) * place.unit;
        const double error =
            u * (near_error<double> * (1.75 + cover.near.row(frame_row::count)[0]) + 4096) * place.unit;
        below += !is_at_least(result.upper * place.unit - error + without, farthest);
    }
    EXPECT_GE(below, 10);
}

// The exact distance at a limit, with the error of a computed one, is at most the threshold.
template <class T> void limits_are_within_the_threshold(OffsetCover<T>& cover) {
    Random random(59);
    const double error = cover.error(cover.near, 0);
    for (int i = 0; i < 2000; ++i) {
        const double tau = error + random.real(0.01, 2);
        cover.set_threshold(tau);
        const Rational allowed = Rational(tau) - Rational(error), limit = Rational(cover.limit[0]);
        ASSERT_LE(limit, allowed * allowed) << tau;
        ASSERT_GE(limit, allowed * allowed * Rational(1 - 64 * frame_roundoff<T>)) << tau;
    }
}

TEST(OffsetCover, LimitsAreWithinTheThreshold) {
    const TriangleMesh mesh = soup(rows({{-3, -3, 0}, {3, -3, 0}, {0, 3, 0}}));
    OffsetCover<double> exact = cover_of(mesh, unit_place());
    limits_are_within_the_threshold(exact);
    OffsetCover<float> rough;
    rough.near.clear(unit_place());
    Counters counters;
    TriangleBlocks(mesh).gather(Vec3::Zero(), 10, rough.near, counters);
    ASSERT_EQ(rough.near.count(), 1U);
    limits_are_within_the_threshold(rough);
}

// Local coordinates have at most length 1. A batch rounds them to float; they must stay within its extent.
TEST(OffsetCover, TheExtentIsTheLengthOfEveryPoint) {
    EXPECT_GE(OffsetCover<double>().extent * OffsetCover<double>().extent, 3);
    Random random(60);
    double nearest = 0;
    for (int i = 0; i < 500; ++i) {
        const Vec3 at = random.vector();
        const double size = std::ldexp(1.0, -static_cast<int>(random.below(20)));
        std::vector<cover::Piece> pieces(static_cast<std::size_t>(1 + random.below(8)));
        for (cover::Piece& piece : pieces)
            for (Vec3& corner : piece.corners) corner = at + random.vector(size);
        const cover::Batch batch(pieces, 1);
        for (std::size_t k = 0; k < batch.points.count; ++k) {
            const exact::RVec3 p{Rational(batch.points.x[k]), Rational(batch.points.y[k]), Rational(batch.points.z[k])};
            ASSERT_TRUE(is_at_least(batch.extent(), exact::dot(p, p))) << i;
            nearest = std::max(nearest, static_cast<double>(exact::root(exact::dot(p, p))) / batch.extent());
        }
    }
    EXPECT_GT(nearest, 0.99);
}

// All corners have the largest slack, so the exact corners may be farther from B by that much.
TEST(OffsetCover, TheMostSlackIsInItsError) {
    const LocalUnits place = unit_place();
    const TriangleMesh mesh = soup(rows({{-3, -3, 0}, {3, -3, 0}, {0, 3, 0}}));
    const cover::Polygon<double> polygon = polygon_of(at_height(1, 0), place, OffsetCover<double>::most_slack);
    CheckingHost host(mesh, place, polygon, 8);
    OffsetCover<double> cover = cover_of(mesh, place);
    cover.set_threshold(host.threshold());
    const CoverResult result = cover_surely(cover, polygon, host, mesh);
    ASSERT_TRUE(result.covered);
    EXPECT_GE(result.upper, 1 * place.inverse + u * OffsetCover<double>::most_slack);
    EXPECT_LE(result.upper, 1 * place.inverse + 1e-10);
}

// A piece whose corners have the largest slack is not cut, because new corners would have more. Without slack, cuts let
// two or three triangles of B cover the piece together.
TEST(OffsetCover, NoCutGoesBeyondTheMostSlack) {
    const TriangleMesh three = soup(rows({{-20, 0, 0},
                                          {-0.3, -10, 0},
                                          {-0.3, 10, 0},
                                          {20, 0, 0},
                                          {0.3, 10, 0},
                                          {0.3, -10, 0},
                                          {-0.5, -3, 0},
                                          {0.5, -3, 0},
                                          {0, 30, 0}}));
    for (const TriangleMesh& mesh : {two_halves(), three}) {
        const TriangleBlocks blocks(mesh);
        const LocalUnits place = unit_place();
        const Triangle t = at_height(0.5, 0);
        for (const bool at_most : {false, true}) {
            OffsetCover<float> cover;
            cover.near.clear(place);
            Counters counters;
            blocks.gather(Vec3::Zero(), 10, cover.near, counters);
            ASSERT_EQ(cover.near.count(), static_cast<std::size_t>(mesh.triangles.rows()));
            cover.make_rows(most_shared_points + most_polygon_corners + 4);
            cover.set_threshold(0.51 * place.inverse);
            cover::LocalPoints<float> points;
            cover::Polygon<float> piece;
            for (const Vec3* corner : {&t.a, &t.b, &t.c}) {
                const Vec3 local = *corner * place.inverse;
                const auto x = static_cast<float>(local[0]), y = static_cast<float>(local[1]),
                           z = static_cast<float>(local[2]);
                points.x[points.count] = x, points.y[points.count] = y, points.z[points.count++] = z;
                piece.add(x, y, z, at_most ? OffsetCover<float>::most_slack : 0);
            }
            measure_shared(cover, points);
            const CoverResult result = cover_shared(cover, piece, {0, 1, 2}, 48);
            EXPECT_EQ(result.covered, !at_most);
            EXPECT_EQ(cover.cuts > 0, !at_most);
        }
    }
}

}  // namespace
}  // namespace hausbench
