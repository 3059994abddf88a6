// The point-triangle kernel against exact rational arithmetic, on ordinary and degenerate triangles.
#include "algorithms/kernel/closest.h"
#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/textbook.h"
#include "tests/support/exact.h"
#include "tests/support/searches.h"
#include "tests/support/triangle_samples.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

namespace hausbench {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int samples = 50'000;
#else
constexpr int samples = 1'000'000;
#endif

TEST(PointTriangle, BoundsHoldAgainstExactArithmetic) {
    Random random(1);
    const int samples_per_kind = tries(samples) / static_cast<int>(kinds().size()) + 1;
    for (const Kind& kind : kinds()) {
        long double worst = 0, worst_loss = 0, worst_under = 0;
        for (int i = 0; i < samples_per_kind; ++i) {
            const Sample sample = kind.make(random);
            const auto& [t, p] = sample;
            const TrianglePoint foot = closest_point(p, t);
            const exact::Rational squared = exact::squared_distance_to_triangle(exact::vector(p), exact::vector(t.a),
                                                                                exact::vector(t.b), exact::vector(t.c));
            const double m = magnitude_of(sample);

            const exact::Rational high = surface_distance_at_most(foot.squared_distance, m, 0);
            ASSERT_TRUE(high * high >= squared) << kind.name << " sample " << i;
            const double certain = distance_certainly_at_least(p, t, foot.point);
            const exact::Rational low = certain;
            ASSERT_TRUE(low * low <= squared) << kind.name << " sample " << i;

            const Box box = box_of(t);
            ASSERT_TRUE((foot.point.array() >= box.low.array()).all() &&
                        (foot.point.array() <= box.high.array()).all());
            const Vec3 r = p - foot.point;
            ASSERT_EQ(foot.squared_distance, squared_length(r));
            ASSERT_LE(squared_distance_to_box(p, box), foot.squared_distance) << "the octree relies on this";

            const long double distance = exact::root(squared), unit = static_cast<long double>(unit_roundoff) * m;
            worst = std::max(worst, (std::sqrt(static_cast<long double>(foot.squared_distance)) - distance) / unit);
            worst_under =
                std::max(worst_under, (distance - std::sqrt(static_cast<long double>(foot.squared_distance))) / unit);
            worst_loss = std::max(worst_loss, (distance - certain) / unit);
        }
        fmt::print("{:40} above by {:8.3g}, below by {:8.3g}, certificate short by {:8.3g} (in u M)\n", kind.name,
                   static_cast<double>(worst), static_cast<double>(worst_under), static_cast<double>(worst_loss));
        EXPECT_LE(worst, 10) << kind.name;
        EXPECT_LE(worst_under, 10) << kind.name;
        EXPECT_LE(worst_loss, 100) << kind.name;
    }
}

// All upper bounds of solvers rely on this: a computed closest point is within 7 * u * M of the exact triangle (u: unit
// roundoff, M: largest coordinate).
TEST(PointTriangle, FeetAreWithin7uMOfTheExactTriangle) {
    Random random(4);
    for (const Kind& kind : kinds()) {
        for (int i = 0; i < 200; ++i) {
            const Sample sample = kind.make(random);
            const Triangle& t = sample.triangle;
            const Vec3 q = closest_point(sample.point, t).point;
            const exact::Rational squared = exact::squared_distance_to_triangle(exact::vector(q), exact::vector(t.a),
                                                                                exact::vector(t.b), exact::vector(t.c));
            const exact::Rational allowed = 7 * exact::Rational(unit_roundoff) * exact::Rational(magnitude_of(sample));
            ASSERT_TRUE(squared <= allowed * allowed) << kind.name << " sample " << i;
            const double again = closest_point(q, t).squared_distance;
            const exact::Rational high = surface_distance_at_most(again, magnitude_of(sample), 0);
            ASSERT_TRUE(high * high >= squared) << kind.name << " sample " << i;
        }
    }
}

// Any guess q of the closest point gives a valid lower bound, even if products or squares underflow.
TEST(PointTriangle, AnyGuessGivesALowerBound) {
    Random random(6);
    int told = 0;
    for (int i = 0; i < 20000; ++i) {
        const double size = i % 2 == 0 ? 1 : std::ldexp(1, -440 - static_cast<int>(random.below(200)));
        const double away = i % 2 == 0 ? 1 : std::ldexp(1, -440 - static_cast<int>(random.below(100)));
        const Vec3 at = size * random.vector();
        const Triangle t =
            i % 3 == 0 ? Triangle{at, at, at} : Triangle{at, size * random.vector(), size * random.vector()};
        const Vec3 p = size * random.vector(), q = away * random.vector();
        const exact::Rational squared = exact::squared_distance_to_triangle(exact::vector(p), exact::vector(t.a),
                                                                            exact::vector(t.b), exact::vector(t.c));
        const exact::Rational low = distance_certainly_at_least(p, t, q);
        ASSERT_TRUE(low * low <= squared) << i;
        told += low > 0;
    }
    EXPECT_GT(told, 1000);
}

// The triangle is a point, and the guess q is far beyond it. Rounding the products in dot(p - q, p) to multiples of
// 2^-1074 changes them so much that the quotient may exceed the distance by far more than a rounding error.
TEST(PointTriangle, AnyGuessGivesALowerBoundWhereProductsUnderflow) {
    Random random(7);
    int longer = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 direction = random.vector(), p = random.real(1, 8) * 0x1p-626 * direction, q = -0x1p-447 * direction;
        const Triangle t{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
        const exact::Rational squared = exact::squared_distance(exact::vector(p), exact::vector(Vec3(t.a)));
        const exact::Rational low = distance_certainly_at_least(p, t, q);
        ASSERT_TRUE(low * low <= squared) << i;
        const exact::Rational quotient = dot(p - q, p) / std::sqrt(squared_length(p - q)) * (1 - 0x1p-20);
        longer += quotient * quotient > squared;
    }
    EXPECT_GT(longer, 500) << "the points do not show what they are for";
}

// Coordinates are so large that the computed closest point is off: a second triangle, a point, is nearer than the first
// although its computed distance is larger.
TEST(PointTriangle, CertifiedDistancesHoldForAllTriangles) {
    Random random(5);
    int nearer = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 offset(1e8, -1e8, 1e8);
        const Triangle t{offset + random.vector(), offset + random.vector(), offset + random.vector()};
        const Vec3 p = offset + random.vector(2), q = closest_point(p, t).point;
        Vec3 v = p + (p - q);
        v[i % 3] += 0x1p-26;
        TriangleMesh mesh;
        mesh.vertices.resize(6, 3);
        mesh.triangles.resize(2, 3);
        mesh.triangles << 0, 1, 2, 3, 4, 5;
        const Vec3 corners[6] = {t.a, t.b, t.c, v, v, v};
        for (int k = 0; k < 6; ++k) mesh.vertices.row(k) = corners[k];
        const exact::Rational to_triangle = exact::squared_distance_to_triangle(exact::vector(p), exact::vector(t.a),
                                                                                exact::vector(t.b), exact::vector(t.c));
        const exact::Rational to_point = exact::squared_distance(exact::vector(p), exact::vector(v));
        Counters counters;
        const exact::Rational low = certified_distance_by_scan(mesh, p, counters);
        ASSERT_TRUE(low * low <= std::min(to_triangle, to_point)) << i;
        if (to_point < to_triangle && squared_length(p - v) > squared_length(p - q)) ++nearer;
    }
    EXPECT_GT(nearer, 50) << "the scene does not show what it is for";
}

TEST(PointTriangle, CornersAndEdgesAreExact) {
    const Triangle t{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    EXPECT_EQ(closest_point({-1, -1, 2}, t).point, t.a);
    EXPECT_EQ(closest_point({6, -1, 0}, t).point, t.b);
    EXPECT_EQ(closest_point({0, 7, 1}, t).point, t.c);
    EXPECT_EQ(closest_point({1, -3, 0}, t).squared_distance, 9);
    EXPECT_EQ(closest_point({1, 1, 3}, t).squared_distance, 9);
    EXPECT_EQ(closest_point({3, 3, 0}, t).squared_distance, 2);
}

TEST(PointTriangle, VerticesAreAtDistanceZero) {
    Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const Triangle t = any(random);
        for (const Vec3& v : {t.a, t.b, t.c}) EXPECT_EQ(closest_point(v, t).squared_distance, 0);
    }
}

// The textbook kernel is kept only to show that it errs by far more than rounding.
TEST(PointTriangle, TheTextbookErrsByTheSizeOfTheTriangle) {
    Random random(3);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const Sample sample{thin(random, 1e-14, random.real(0.1, 0.9)), random.vector(2)};
        const double robust = std::sqrt(closest_point(sample.point, sample.triangle).squared_distance);
        const double textbook = std::sqrt(textbook_closest_point(sample.point, sample.triangle).squared_distance);
        if (std::isfinite(textbook)) worst = std::max(worst, std::abs(textbook - robust));
    }
    EXPECT_GT(worst, 1e-3);
    for (int i = 0; i < 1000; ++i) {
        const Sample sample{any(random), random.vector(2)};
        const double robust = std::sqrt(closest_point(sample.point, sample.triangle).squared_distance);
        EXPECT_NEAR(std::sqrt(textbook_closest_point(sample.point, sample.triangle).squared_distance), robust, 1e-9);
    }
}

}  // namespace
}  // namespace hausbench
