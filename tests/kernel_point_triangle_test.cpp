// The point-triangle kernel against exact rational arithmetic, on kind and degenerate triangles.
#include "exact.h"
#include "kernel/point_triangle.h"
#include "kernel/rounding.h"
#include "random.h"

#include <functional>

#include <gtest/gtest.h>

#include <fmt/format.h>

namespace hausbench {
namespace {

struct Sample {
    Triangle triangle;
    Vec3 point;
};

struct Kind {
    std::string name;
    std::function<Sample(Random&)> make;
};

double magnitude_of(const Sample& s) {
    double m = 0;
    for (const Vec3& v : {s.triangle.a, s.triangle.b, s.triangle.c, s.point}) m = std::max(m, v.cwiseAbs().maxCoeff());
    return m;
}

Vec3 inside(const Triangle& t, Random& random) {
    double s = random.unit(), r = random.unit();
    if (s + r > 1) s = 1 - s, r = 1 - r;
    return t.a + s * (t.b - t.a) + r * (t.c - t.a);
}

Triangle any(Random& random) {
    const Vec3 a = random.vector(), b = random.vector(), c = random.vector();
    return {a, b, c};
}

// A triangle with one vertex `height` off the line through the two others, at `place` along it.
Triangle thin(Random& random, double height, double place) {
    const Vec3 a = random.vector(), b = random.vector();
    return {a, b, Vec3(a + place * (b - a) + height * random.vector())};
}

std::vector<Kind> kinds() {
    std::vector<Kind> all;
    all.push_back({"random", [](Random& r) { const Triangle t = any(r); return Sample{t, r.vector(2)}; }});
    all.push_back({"random, point above the inside", [](Random& r) {
        const Triangle t = any(r);
        const Vec3 n = (t.b - t.a).cross(t.c - t.a);
        return Sample{t, Vec3(inside(t, r) + r.real(-1, 1) * n)};
    }});
    for (const double height : {1e-4, 1e-8, 1e-12, 1e-14, 1e-16, 1e-30}) {
        all.push_back({fmt::format("needle {}", height), [=](Random& r) { return Sample{thin(r, height, 0), r.vector(2)}; }});
        all.push_back({fmt::format("cap {}", height),
                       [=](Random& r) { return Sample{thin(r, height, r.real(0.1, 0.9)), r.vector(2)}; }});
        all.push_back({fmt::format("cap {}, point close", height), [=](Random& r) {
            const Triangle t = thin(r, height, r.real(0.1, 0.9));
            return Sample{t, Vec3(inside(t, r) + 1e-9 * r.vector())};
        }});
    }
    all.push_back({"rounded collinear", [](Random& r) { const Triangle t = thin(r, 0, r.real(-1, 2)); return Sample{t, r.vector(2)}; }});
    all.push_back({"two equal vertices", [](Random& r) {
        Triangle t = any(r);
        (r.below(2) ? t.c : t.b) = t.a;
        return Sample{t, r.vector(2)};
    }});
    all.push_back({"three equal vertices", [](Random& r) {
        const Vec3 a = r.vector();
        return Sample{{a, a, a}, r.vector(2)};
    }});
    for (const double distance : {1e-6, 1e-9, 1e-12, 1e-15, 0.0}) {
        all.push_back({fmt::format("distance about {}", distance), [=](Random& r) {
            const Triangle t = any(r);
            return Sample{t, Vec3(inside(t, r) + distance * r.vector())};
        }});
        all.push_back({fmt::format("distance about {} from an edge", distance), [=](Random& r) {
            const Triangle t = any(r);
            return Sample{t, Vec3(t.a + r.unit() * (t.b - t.a) + distance * r.vector())};
        }});
        all.push_back({fmt::format("distance about {} from a vertex", distance),
                       [=](Random& r) { const Triangle t = any(r); return Sample{t, Vec3(t.b + distance * r.vector())}; }});
    }
    all.push_back({"offset 1e8", [](Random& r) {
        const Vec3 offset(1e8, -1e8, 1e8);
        const Triangle t = any(r);
        return Sample{{t.a + offset, t.b + offset, t.c + offset}, Vec3(r.vector(2) + offset)};
    }});
    all.push_back({"tiny triangle 1e-80", [](Random& r) {
        const Triangle t = any(r);
        return Sample{{1e-80 * t.a, 1e-80 * t.b, 1e-80 * t.c}, r.vector()};
    }});
    return all;
}

TEST(PointTriangle, BoundsHoldAgainstExactArithmetic) {
    Random random(1);
    for (const Kind& kind : kinds()) {
        long double worst = 0, worst_loss = 0, worst_under = 0;
        for (int i = 0; i < 1500; ++i) {
            const Sample sample = kind.make(random);
            const auto& [t, p] = sample;
            const TrianglePoint found = closest_point(p, t);
            const exact::Rational squared = exact::squared_distance_to_triangle(
                exact::vector(p), exact::vector(t.a), exact::vector(t.b), exact::vector(t.c));
            const double m = magnitude_of(sample);

            const exact::Rational high = surface_distance_at_most(found.squared_distance, m, 0);
            ASSERT_TRUE(high * high >= squared) << kind.name << " sample " << i;
            const double certain = distance_certainly_at_least(p, t, found.point);
            const exact::Rational low = certain;
            ASSERT_TRUE(low * low <= squared) << kind.name << " sample " << i;

            const Box box = box_of(t);
            ASSERT_TRUE((found.point.array() >= box.low.array()).all() && (found.point.array() <= box.high.array()).all());
            const Vec3 r = p - found.point;
            ASSERT_EQ(found.squared_distance, squared_length(r));
            ASSERT_LE(squared_distance_to_box(p, box), found.squared_distance) << "the octree relies on this";

            const long double distance = exact::root(squared), unit = static_cast<long double>(unit_roundoff) * m;
            worst = std::max(worst, (std::sqrt(static_cast<long double>(found.squared_distance)) - distance) / unit);
            worst_under = std::max(worst_under, (distance - std::sqrt(static_cast<long double>(found.squared_distance))) / unit);
            worst_loss = std::max(worst_loss, (distance - certain) / unit);
        }
        fmt::print("{:40} above by {:8.3g}, below by {:8.3g}, certificate short by {:8.3g} (in u M)\n", kind.name,
                   static_cast<double>(worst), static_cast<double>(worst_under), static_cast<double>(worst_loss));
        EXPECT_LE(worst, 10) << kind.name;
        EXPECT_LE(worst_under, 16) << kind.name << ": more than was proven";
        EXPECT_LE(worst_loss, 100) << kind.name;
    }
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

}  // namespace
}  // namespace hausbench
