// Single pieces of A, areas of triangles and distances of points: bounds from `distribution` against exact numbers.
#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/meshes/distribution/cuts.h"
#include "algorithms/meshes/distribution/dissection.h"
#include "algorithms/meshes/distribution/point_distance.h"
#include "algorithms/meshes/distribution/statistics.h"
#include "algorithms/meshes/distribution/weights.h"
#include "tests/support/exact.h"
#include "tests/support/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using namespace distribution;

TEST(DistributionPieces, MeansOfThePositivePartOfAnAffineFunction) {
    EXPECT_DOUBLE_EQ(PositivePart({-1, 0.5, 0.5}).mean(), 4.0 / 27);  // not 1/3, as with corners clamped to 0
    EXPECT_DOUBLE_EQ(PositivePart({-1, -1, 1}).share(), 0.25);
    EXPECT_DOUBLE_EQ(PositivePart({-1, -1, 1}).mean(), 0.25 / 3);
    EXPECT_DOUBLE_EQ(PositivePart({1, 2, 3}).mean_square(), 25.0 / 6);
    EXPECT_DOUBLE_EQ(PositivePart({0, 0, 3}).mean(), 1);
    EXPECT_EQ(PositivePart({-1, -2, 0}).count, 0);
    EXPECT_EQ(share_at_most({2, 2, 2}, 2), 1);
    EXPECT_EQ(share_above({2, 2, 2}, 2), 0);
    EXPECT_DOUBLE_EQ(share_at_most({0, 1, 1}, 0.5), 0.25);
    EXPECT_DOUBLE_EQ(share_above({0, 1, 1}, 0.5), 0.75);
}

TEST(DistributionPieces, AreasOfNeedlesAreCertain) {
    const Area needle = area_of({{0, 0, 0}, {1, 0, 0}, {0.5, 0x1p-60, 0}});
    EXPECT_NEAR(needle.value, 0x1p-61, 0x1p-61 * area_error);
    EXPECT_LE(needle.extra, 0x1p-61 * area_error);
    const Area segment = area_of({{0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}, {0.4, 0.8, 0.9}});
    EXPECT_GT(segment.value, 0);
    const Area nothing = area_of({{0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}, {0.4, 0.8, 0.9}});
    EXPECT_EQ(nothing.value, 0);
    EXPECT_GT(nothing.extra, 0);
}

// Triangles between a needle and a fat one: products of doubles alone lose most digits of an area that is a small part of
// the product of two edges.
TEST(DistributionPieces, AreasOfThinTrianglesAreCertain) {
    using exact::Rational;
    Random random(23);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 a = random.vector(0.25), x = random.vector(0.5);
        const Triangle t{a, a + x, a + random.real(0.5, 1) * x + random.vector(std::ldexp(0.25, -(i % 45)))};
        const Area area = area_of(t);
        const exact::RVec3 from = exact::vector(t.a), e = exact::operator-(exact::vector(t.b), from),
                           f = exact::operator-(exact::vector(t.c), from);
        const Rational ef = exact::dot(e, f), squared = (exact::dot(e, e) * exact::dot(f, f) - ef * ef) / Rational(4);
        const Rational error(area_error), value(area.value);
        const Rational low = value * (Rational(1) - error), high = value * (Rational(1) + error) + Rational(area.extra);
        ASSERT_LE(low * low, squared) << "case " << i;
        ASSERT_GE(high * high, squared) << "case " << i;
    }
}

using Real = long double;
using RealVec3 = Eigen::Matrix<Real, 3, 1>;

// Nodes and weights of Gauss and Legendre for n points on [0, 1].
std::vector<std::pair<Real, Real>> gauss(int n) {
    std::vector<std::pair<Real, Real>> rule;
    for (int i = 0; i < n; ++i) {
        Real x = std::cos(std::numbers::pi_v<Real> * (i + 0.75L) / (n + 0.5L)), slope = 0;
        for (int step = 0; step < 50; ++step) {
            Real before = 1, value = x;
            for (int k = 2; k <= n; ++k)
                before = std::exchange(value, ((2 * k - 1) * x * value - (k - 1) * before) / k);
            slope = n * (x * value - before) / (x * x - 1);
            x -= value / slope;
        }
        rule.emplace_back((1 + x) / 2, 1 / ((1 - x * x) * slope * slope));
    }
    return rule;
}

Real squared_distance(const RealVec3& p, const std::array<RealVec3, 3>& t) {
    const RealVec3 e = t[1] - t[0], f = t[2] - t[0], r = p - t[0];
    const Real ee = e.dot(e), ef = e.dot(f), ff = f.dot(f), re = r.dot(e), rf = r.dot(f), det = ee * ff - ef * ef;
    const Real x = (re * ff - rf * ef) / det, y = (rf * ee - re * ef) / det;
    if (x >= 0 && y >= 0 && x + y <= 1) return (r - x * e - y * f).squaredNorm();
    Real least = std::numeric_limits<Real>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const RealVec3 side = t[(k + 1) % 3] - t[k], from = p - t[k];
        const Real at = std::clamp(from.dot(side) / side.dot(side), Real(0), Real(1));
        least = std::min(least, (from - at * side).squaredNorm());
    }
    return least;
}

// The means of d and d^2 over a piece, from 16 parts of it.
std::array<Real, 2> means_of(const std::array<RealVec3, 3>& piece, const std::vector<std::array<RealVec3, 3>>& target) {
    static const std::vector<std::pair<Real, Real>> rule = gauss(12);
    std::array<Real, 2> sums{};
    const auto add = [&](int i, int j, int way) {  // a triangle of the grid with the corner (i, j)
        for (const auto& [x, weight_x] : rule) {
            for (const auto& [y, weight_y] : rule) {
                const Real u = (i + way * x * (1 - y)) / 4, v = (j + way * x * y) / 4;
                const RealVec3 p = (1 - u - v) * piece[0] + u * piece[1] + v * piece[2];
                Real d = std::numeric_limits<Real>::infinity();
                for (const std::array<RealVec3, 3>& t : target) d = std::min(d, squared_distance(p, t));
                const Real weight = 2 * x * weight_x * weight_y / 16;
                sums[0] += weight * std::sqrt(d);
                sums[1] += weight * d;
            }
        }
    };
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; i + j < 4; ++j) {
            add(i, j, 1);
            if (i + j < 3) add(i + 1, j + 1, -1);
        }
    }
    return sums;
}

// One piece and one triangle of B, of which the inside, an edge or a corner is nearest, or two of these. The bounds must
// also hold for corners that are off as far as their level says: here towards B or away from it.
TEST(DistributionPieces, BoundsOfAPieceHoldUnderRounding) {
    enum Nearest { inside, edge, corner, edge_and_corner, inside_and_edge };
    Random random(21);
    double closest = infinity;
    for (int i = 0; i < 5000; ++i) {
        const auto nearest = static_cast<Nearest>(i % 5);
        const int level = i % 2 == 0 ? 0 : 1000;
        const Vec3 v = random.vector();
        const Vec3 e(random.real(-0.1, 0.1), random.real(0.9, 1.1), random.real(-0.1, 0.1)),
            g(random.real(-1.1, -0.9), random.real(-0.1, 0.1), random.real(-0.1, 0.1));
        const Triangle t{v, v + e, v + g};
        const double h = random.real(0.02, 0.2);
        const Vec3 at = nearest == inside            ? 0.25 * (e + g) + Vec3(0, 0, h)
                        : nearest == edge            ? 0.5 * e + Vec3(h, 0, random.real(-h, h))
                        : nearest == corner          ? Vec3(h, -h, random.real(-h, h))
                        : nearest == edge_and_corner ? Vec3(h, 0, random.real(-h, h))
                                                     : 0.5 * e + Vec3(0, 0, h);
        Piece piece{{}, 1, 0, -1, level, 0};
        for (Vec3& p : piece.corners) p = v + at + random.vector(0.15 * h);
        double magnitude = 0;
        for (const Vec3& p : {piece.corners[0], piece.corners[1], piece.corners[2], t.a, t.b, t.c})
            magnitude = std::max(magnitude, p.cwiseAbs().maxCoeff());
        const NearbyTriangle near{t, 0};
        const std::uint16_t first = 0;
        const AffineBounds bounds = MeanBounder(magnitude).bounds(piece, {&near, 1}, {&first, 1});

        const double off = (i % 4 < 2 ? 1 : -1) * 2 * level * unit_roundoff * magnitude * (1 - 0x1p-20);
        std::array<RealVec3, 3> moved, of_t{t.a.cast<Real>(), t.b.cast<Real>(), t.c.cast<Real>()};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 away = (piece.corners[k] - closest_point(piece.corners[k], t).point).normalized();
            const exact::RVec3 p = exact::along(exact::vector(piece.corners[k]), off, exact::vector(away));
            const exact::Rational squared =
                exact::squared_distance_to_triangle(p, exact::vector(t.a), exact::vector(t.b), exact::vector(t.c));
            const exact::Rational low = std::max(bounds.lower[k], 0.0), high = bounds.upper[k];
            ASSERT_LE(low * low, squared) << "case " << i;
            ASSERT_GE(high * high, squared) << "case " << i;
            moved[k] = piece.corners[k].cast<Real>() + Real(off) * away.cast<Real>();
        }
        const auto [mean, mean_of_squares] = means_of(moved, {of_t});
        const Real error = nearest > corner ? 1e-5L * h : 0x1p-60L;  // the sums converge slowly for two features
        ASSERT_LE(bounds.mean_lower, mean + error) << "case " << i;
        ASSERT_GE(bounds.mean_upper, mean - error) << "case " << i;
        ASSERT_LE(bounds.square_lower, mean_of_squares + error * h) << "case " << i;
        ASSERT_GE(bounds.square_upper, mean_of_squares - error * h) << "case " << i;
        if (level == 0 && nearest == corner) closest = std::min(closest, bounds.mean_upper - bounds.mean_lower);
    }
    EXPECT_LT(closest, 1e-6);
}

std::array<RealVec3, 3> real(const Triangle& t) { return {t.a.cast<Real>(), t.b.cast<Real>(), t.c.cast<Real>()}; }

// A corner of one triangle is nearest to the centre, and the inside of another one to a part of the piece.
TEST(DistributionPieces, ATriangleThatIsNearerToAPartCounts) {
    const Triangle s{{0, 0, 0}, {-1, 0.5, -0.3}, {-0.5, -1, -0.3}}, t{{1.85, -2, -2}, {1.85, 2, -2}, {1.85, 0, 2}};
    const Piece piece{{{{0.75, -0.1, 0}, {0.85, 0.15, 0.1}, {1.08, 0, 0}}}, 1, 0, -1, 0, 0};
    const std::array<NearbyTriangle, 2> near{{{s, 0}, {t, 1}}};
    const std::array<std::uint16_t, 2> among{0, 1};
    MeanBounder bounder(2);
    const AffineBounds bounds = bounder.bounds(piece, near, among);
    ASSERT_EQ(bounder.kept(), (std::vector<std::uint16_t>{0, 1}));
    const auto [mean, mean_of_squares] =
        means_of(real({piece.corners[0], piece.corners[1], piece.corners[2]}), {real(s), real(t)});
    const Real error = 1e-4L;  // of the sums
    EXPECT_LE(bounds.mean_lower, mean + error);
    EXPECT_GE(bounds.mean_upper, mean - error);
    EXPECT_LE(bounds.square_lower, mean_of_squares + error);
    EXPECT_GE(bounds.square_upper, mean_of_squares - error);
}

// Along a piece of a high level, an edge of S is 0.1 away. T is nearer by a little less than what counts as rounding, below
// more than half of the piece. The exact piece may be nearer to both by as much as its level says.
TEST(DistributionPieces, ATriangleThatIsNearerByRoundingCounts) {
    constexpr int level = 1000;
    constexpr double magnitude = 0x1p20, um = unit_roundoff * magnitude, h = 0.1, nearer = 6000 * um;
    const Triangle s{{-5, 0, 0}, {5, 0, 0}, {0, 0, -1}}, t{{0, -3, nearer}, {0, 3, nearer}, {-6, 0, nearer}};
    const Piece piece{{{{-1, -0x1p-40, h}, {-1, 0x1p-40, h}, {2.01, 0, h}}}, 1, 0, -1, level, 0};
    const std::array<NearbyTriangle, 2> near{{{s, 0}, {t, 1}}};
    const std::array<std::uint16_t, 2> among{0, 1};
    MeanBounder bounder(magnitude);
    const AffineBounds bounds = bounder.bounds(piece, near, among);
    ASSERT_EQ(bounder.kept(), (std::vector<std::uint16_t>{0, 1}));
    const double beside = (2.01 / 3.01) * (2.01 / 3.01), to_s = h - 2 * level * um, to_t = to_s - nearer;
    EXPECT_LE(bounds.mean_lower, beside * to_s + (1 - beside) * to_t);
    EXPECT_LE(bounds.square_lower, beside * to_s * to_s + (1 - beside) * to_t * to_t);
    EXPECT_GT(bounds.mean_lower, h - 20 * level * um);
}

// Two triangles are nearly folded onto each other, and the piece is between them, on both sides of the plane that halves
// their angle. Rounding tilts this plane, because its normal is a small difference of two directions.
TEST(DistributionPieces, BoundsBetweenFoldedTrianglesHoldUnderRounding) {
    Random random(24);
    int tried = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 e = random.vector().normalized(), g = random.vector();
        const Vec3 x = (g - dot(g, e) * e).normalized(), z = e.cross(x);
        const double angle = std::ldexp(random.real(1, 2), -14);
        const Vec3 v = random.vector(0.2), up = std::cos(angle) * x + std::sin(angle) * z,
                   down = std::cos(angle) * x - std::sin(angle) * z;
        const Triangle s{v, v + e, v + 0.6 * e + 0.5 * up}, t{v, v + e, v + 0.6 * e + 0.5 * down};
        Piece piece{{}, 1, 0, -1, 0, 0};
        const double across = std::ldexp(1.5, static_cast<int>(random.below(12)) - 48);
        for (Vec3& p : piece.corners)
            p = v + random.real(0.55, 0.65) * e + random.real(0.2, 0.3) * x + random.real(-across, across) * z;
        const std::array<NearbyTriangle, 2> near{{{s, 0}, {t, 1}}};
        const std::array<std::uint16_t, 2> among{0, 1};
        const AffineBounds bounds = MeanBounder(1.5).bounds(piece, near, among);
        tried += bisector_of(s, t).has_value();
        for (std::size_t k = 0; k < 3; ++k) {
            exact::Rational squared = -1;
            for (const Triangle& triangle : {s, t}) {
                const exact::Rational d =
                    exact::squared_distance_to_triangle(exact::vector(piece.corners[k]), exact::vector(triangle.a),
                                                        exact::vector(triangle.b), exact::vector(triangle.c));
                if (squared < 0 || d < squared) squared = d;
            }
            const exact::Rational low = std::max(bounds.lower[k], 0.0);
            ASSERT_LE(low * low, squared) << "case " << i;
        }
    }
    EXPECT_GT(tried, 1000);
}

// The parts of a cut piece are within the piece, as far as their levels say, and their shares are its share.
TEST(DistributionPieces, PartsAreWithinTheirLevels) {
    Random random(25);
    double farthest = 0;
    int at_change = 0;
    for (int i = 0; i < 3000; ++i) {
        const double size = i % 2 == 0 ? 1 : 0x1p-6;
        const Vec3 v = i % 2 == 0 ? Vec3(Vec3::Zero()) : random.vector();
        Piece piece{{}, 1, 0, -1, 0, 0};
        for (Vec3& p : piece.corners) p = v + random.vector(size);
        const Triangle s{piece.centre() + random.vector(0.1 * size), v + random.vector(size), v + random.vector(size)},
            t{piece.corners[0], v + random.vector(size), v + random.vector(size)};
        double magnitude = 0;
        for (const Vec3& p : {piece.corners[0], piece.corners[1], piece.corners[2]})
            magnitude = std::max(magnitude, p.cwiseAbs().maxCoeff());
        const std::array<NearbyTriangle, 2> near{{{s, 0}, {t, 1}}};
        const std::array<std::uint16_t, 2> kept{0, 1};
        std::array<CornerValues, 2> squares{};
        for (std::size_t j = 0; j < 2; ++j)
            for (std::size_t k = 0; k < 3; ++k)
                squares[j][k] = closest_point(piece.corners[k], near[j].corners).squared_distance;
        const Parts parts = cut_at_change(piece, near, kept, squares, magnitude);
        const std::array<Piece, 2> half = halves(piece);
        std::vector<Piece> all(parts.begin(), parts.end());
        at_change += !all.empty();
        const auto check = [&](const std::vector<Piece>& made) {
            double share = 0;
            for (const Piece& part : made) {
                share += part.share;
                const exact::Rational off(2 * part.level * unit_roundoff * magnitude);
                for (const Vec3& p : part.corners) {
                    const exact::Rational squared = exact::squared_distance_to_triangle(
                        exact::vector(p), exact::vector(piece.corners[0]), exact::vector(piece.corners[1]),
                        exact::vector(piece.corners[2]));
                    ASSERT_LE(squared, off * off) << "case " << i;
                    farthest = std::max(farthest, static_cast<double>(exact::root(squared)) / magnitude);
                }
            }
            ASSERT_NEAR(share, 1, 1e-15);
        };
        if (!all.empty()) check(all);
        check({half[0], half[1]});
    }
    EXPECT_GT(at_change, 1000);
    EXPECT_GT(farthest, unit_roundoff);
}

// On a line: the centre, one triangle of B at a distance d before it, the farthest corner of the piece as far behind it as
// its level allows, and another triangle of B that is nearest to this corner.
TEST(DistributionPieces, TheTriangleNearestToAnyPointIsWithinReach) {
    using exact::Rational;
    for (const int level : {0, 1, 1000}) {
        constexpr double magnitude = 0x1p20, d = 0.75, half = 0.25;
        const Piece piece{{{{2 * half, 0, 0}, {-half, half, 0}, {-half, -half, 0}}}, 1, 0, -1, level, 0};
        ASSERT_EQ(piece.centre(), Vec3(Vec3::Zero()));
        const Rational way = Rational(2 * half) + Rational(2 * level * unit_roundoff * magnitude);
        const Rational other = way + (Rational(d) + way);  // nearer to the corner than the first, or as near
        EXPECT_GE(Rational(reach_of(piece, d * d, magnitude)), other) << level;
        EXPECT_LE(reach_of(piece, d * d, magnitude), 2 * half + d + 2 * half + 1e-5) << level;
    }
}

// The first corner lies between the centre and the vertex of B that is nearest, so the distance falls as fast as the point
// moves; the bounds must hold for corners that are off as far as their level says.
TEST(DistributionPieces, RoughBoundsHoldUnderRounding) {
    Random random(22);
    double widest = 0;
    for (int i = 0; i < 5000; ++i) {
        const int level = i % 2 == 0 ? 0 : 1000;
        const Vec3 v = random.vector(),
                   centre = v + Vec3(random.real(0.1, 1), random.real(-1, -0.1), random.real(-1, 1));
        const Triangle t{v, v + Vec3(-0.1, 1, 0), v + Vec3(-1, 0.1, 0)};
        const double step = 1e-3;
        const Vec3 first = centre + step * (v - centre), side = random.vector(step);
        const Vec3 rest = centre + 0.5 * (centre - first);
        const Piece piece{{first, rest + side, rest - side}, 1, 0, -1, level, 0};
        double magnitude = 0;
        for (const Vec3& p : {first, Vec3(rest + side), Vec3(rest - side), t.a, t.b, t.c})
            magnitude = std::max(magnitude, p.cwiseAbs().maxCoeff());
        const auto squared_at = [&](const exact::RVec3& p) -> exact::Rational {
            return exact::squared_distance_to_triangle(p, exact::vector(t.a), exact::vector(t.b), exact::vector(t.c));
        };
        const exact::Rational at_centre = squared_at(exact::vector(piece.centre()));
        double least = std::sqrt(at_centre.get_d());
        while (exact::Rational(least) * exact::Rational(least) > at_centre) least = next_down(least);
        const AffineBounds bounds = MeanBounder(magnitude).rough(piece, t, least);
        const double off = (i % 4 < 2 ? 1 : -1) * 2 * level * unit_roundoff * magnitude * (1 - 0x1p-20);
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 away = (piece.corners[k] - closest_point(piece.corners[k], t).point).normalized();
            const exact::Rational squared =
                squared_at(exact::along(exact::vector(piece.corners[k]), off, exact::vector(away)));
            const exact::Rational low = std::max(bounds.lower[k], 0.0), high = bounds.upper[k];
            ASSERT_LE(low * low, squared) << "case " << i;
            ASSERT_GE(high * high, squared) << "case " << i;
            widest = std::max(widest, bounds.upper[k] - bounds.lower[k]);
        }
    }
    EXPECT_LT(widest, 10e-3);
}

// The mean of (d - about)^2 for a d that is one of the two bounds, and for one that only the means bound. Both are near
// to `about`, so most digits cancel.
TEST(DistributionPieces, SpreadsHoldUnderRounding) {
    using exact::Rational;
    Random random(4);
    for (int i = 0; i < 3000; ++i) {
        const double about = random.real(1, 2);
        AffineBounds narrow{{}, {}, 0, 2, 0, 4};
        for (std::size_t k = 0; k < 3; ++k) {
            narrow.lower[k] = about + std::ldexp(random.real(-1, 1), -40 - i % 12);
            narrow.upper[k] = narrow.lower[k] + static_cast<double>(random.below(3)) * 0x1p-52;
        }
        const SpreadBounds spread = spread_about(narrow, about);
        for (const CornerValues& d : {narrow.lower, narrow.upper}) {
            std::array<Rational, 3> x;
            for (std::size_t k = 0; k < 3; ++k) x[k] = Rational(d[k]) - Rational(about);
            const Rational mean =
                (x[0] * x[0] + x[1] * x[1] + x[2] * x[2] + x[0] * x[1] + x[1] * x[2] + x[2] * x[0]) / Rational(6);
            ASSERT_LE(Rational(spread.lower), mean) << "case " << i;
            ASSERT_GE(Rational(spread.upper), mean) << "case " << i;
        }
        const double mean = about + std::ldexp(random.real(-1, 1), -30), square = mean * mean * (1 + 0x1p-30);
        const SpreadBounds by_means = spread_about({{0, 0, 0}, {4, 4, 4}, mean, mean, square, square}, about);
        const Rational truth =
            Rational(square) - Rational(2) * Rational(about) * Rational(mean) + Rational(about) * Rational(about);
        ASSERT_LE(Rational(by_means.lower), truth) << "case " << i;
        ASSERT_GE(Rational(by_means.upper), truth) << "case " << i;
        ASSERT_LT(by_means.upper, 1e-8);
    }
}

// The lower values are below 0, and d may be 0: then the spread about a length is its square.
TEST(DistributionPieces, SpreadsOfPiecesNearContactHoldUnderRounding) {
    Random random(26);
    for (int i = 0; i < 1000; ++i) {
        const double about = random.real(1, 2);
        const SpreadBounds spread = spread_about({{-1, -1, -1}, {about, about, about}, 0, 2, 0, 4}, about);
        ASSERT_EQ(spread.lower, 0);
        ASSERT_GE(exact::Rational(spread.upper), exact::Rational(about) * exact::Rational(about)) << about;
    }
}

// Distances 1 and 5, on parts of equal weight. The mean is 3 and the deviation 2, but bounds on the mean of the first part
// are wide, so the spread is taken about a length that is not the mean.
TEST(DistributionPieces, ADeviationAboutALengthBesideTheMeanHolds) {
    const auto leaf = [](double d, double mean_upper) {
        return Leaf{{}, {{d, d, d}, {d, d, d}, d, mean_upper, d * d, d * d}, 1, false};
    };
    const std::vector<Leaf> leaves{leaf(1, 3), leaf(5, 5)};
    const Statistics statistics({std::span(leaves)}, 0, false);
    EXPECT_NEAR(statistics.about(), 3.5, 1e-9);
    Statistic deviation;
    deviation.kind = Statistic::Kind::deviation;
    const Bounds bounds = statistics.of(deviation);
    EXPECT_LE(bounds.lower, 2);
    EXPECT_GE(bounds.upper, 2);
    EXPECT_GT(bounds.lower, 1.9);
}

// Some of these distances are doubles, and some squares, differences or sums round.
TEST(DistributionPieces, DistancesOfPointsHoldAndAreOftenExact) {
    Random random(3);
    int equal = 0, next = 0, wider = 0;
    for (int i = 0; i < 20000; ++i) {
        const int digits = i % 4 == 0 ? 0 : i % 4 == 1 ? 20 : i % 4 == 2 ? 28 : 52;
        const auto rounded = [&](double x) { return std::ldexp(std::round(std::ldexp(x, digits)), -digits); };
        const Vec3 a(rounded(random.real(4, 5)), 0.5 * static_cast<double>(random.below(13) - 6),
                     i % 8 < 4 ? 0 : 0x1p-30 * static_cast<double>(random.below(10)));
        const Vec3 b(0, i % 64 < 32 ? 0 : 0x1p-70, i % 16 < 8 ? 0 : i % 32 < 16 ? -0x1p-60 : 0x1p-600);
        const Bounds d = point_distance(a, b);
        CGAL::Exact_rational squared = 0;
        for (int k = 0; k < 3; ++k) {
            const CGAL::Exact_rational x = CGAL::Exact_rational(a[k]) - CGAL::Exact_rational(b[k]);
            squared += x * x;
        }
        ASSERT_LE(CGAL::Exact_rational(d.lower) * CGAL::Exact_rational(d.lower), squared) << a << " and " << b;
        ASSERT_GE(CGAL::Exact_rational(d.upper) * CGAL::Exact_rational(d.upper), squared) << a << " and " << b;
        ++(d.lower == d.upper ? equal : next_up(d.lower) == d.upper ? next : wider);
        AffineBounds means{{d.lower, d.lower, d.lower}, {d.upper, d.upper, d.upper}, 0, 0, 0, 0};
        bound_means(means);
        ASSERT_LE(means.mean_lower, d.lower);
        ASSERT_GE(means.mean_upper, d.upper);
    }
    EXPECT_GT(equal, 100);
    EXPECT_GT(next, 1000);
    EXPECT_GT(wider, 1000);
    EXPECT_EQ(point_distance({1e-300, 0, 0}, {1e-300, 0, 0}).upper, 0);
    EXPECT_GT(point_distance({1e-300, 0, 0}, {0, 0, 0}).upper, 1e-300);
}

}  // namespace
}  // namespace hausbench
