// Distances from triangle frames must be within the error that kernel/triangle_frames.h derives, even for degenerate
// triangles.
#include "algorithms/kernel/triangle_frames.h"
#include "tests/support/exact.h"
#include "tests/support/triangle_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace hausbench {
namespace {

// Moves and scales a sample, which may lie far away, so that its coordinates are about 1 at most.
Sample local(const Sample& sample) {
    const Vec3 origin = sample.triangle.a;
    Sample moved{{Vec3::Zero(), sample.triangle.b - origin, sample.triangle.c - origin}, sample.point - origin};
    const double size = magnitude_of(moved);
    const double scale = size > 0 ? std::ldexp(1.0, -std::ilogb(size)) : 1;
    for (Vec3* v : {&moved.triangle.a, &moved.triangle.b, &moved.triangle.c, &moved.point}) *v *= scale;
    return moved;
}

double largest_corner(const Triangle& t) { return std::max({t.a.norm(), t.b.norm(), t.c.norm()}); }

template <class T> void expect_within_the_error() {
    Random random(31);
    for (const Kind& kind : kinds()) {
        double worst = 0;
        for (int turn = 0; turn < 4; ++turn) {
            CornerRows corners;
            std::array<Triangle, frames_width> triangles;
            std::vector<Vec3> points;
            const Vec3 away =
                turn % 2 == 0 ? Vec3(Vec3::Zero()) : Vec3(random.vector(std::ldexp(1.0, random.below(12))));
            for (std::size_t i = 0; i < frames_width; ++i) {
                const Sample sample = local(kind.make(random));
                triangles[i] = {sample.triangle.a + away, sample.triangle.b + away, sample.triangle.c + away};
                corners.set(i, triangles[i]);
                points.push_back(sample.point + away);
            }
            TriangleFrames<T> frames;
            make_frames(corners, frames);
            for (std::size_t j = 0; j < points.size(); ++j) {
                const Vec3& point = points[j];
                const T p[3] = {static_cast<T>(point[0]), static_cast<T>(point[1]), static_cast<T>(point[2])};
                T squared[frames_width];
                squared_distances(frames, p, squared);
                for (std::size_t i = j % 4; i < frames_width;
                     i += 4) {  // the point's own triangle and some others; exact arithmetic is slow
                    const auto& [a, b, c] = triangles[i];
                    const long double exactly = exact::root(exact::squared_distance_to_triangle(
                        exact::vector(point), exact::vector(a), exact::vector(b), exact::vector(c)));
                    const long double error = std::abs(std::sqrt(static_cast<long double>(squared[i])) - exactly);
                    const double unit = frame_roundoff<T> * (point.norm() + largest_corner(triangles[i]));
                    ASSERT_LE(error, frame_error<T> * unit + frame_underflow<T>) << kind.name;
                    worst = std::max(worst, static_cast<double>(error) / unit);
                }
            }
        }
        // Errors stay below a quarter of the proven bound, so a small slip in the kernel shows.
        EXPECT_LE(worst, frame_error<T> / 4) << kind.name;
    }
}

TEST(TriangleFrames, FloatIsWithinItsError) { expect_within_the_error<float>(); }
TEST(TriangleFrames, DoubleIsWithinItsError) { expect_within_the_error<double>(); }

// All coordinates are so small that squares underflow.
template <class T> void expect_underflow_is_counted(double scale) {
    Random random(33);
    for (int turn = 0; turn < 20; ++turn) {
        Sample sample = local({any(random), random.vector()});
        for (Vec3* v : {&sample.triangle.a, &sample.triangle.b, &sample.triangle.c, &sample.point}) *v *= scale;
        CornerRows corners;
        for (std::size_t i = 0; i < frames_width; ++i) corners.set(i, sample.triangle);
        TriangleFrames<T> frames;
        make_frames(corners, frames);
        const T p[3] = {static_cast<T>(sample.point[0]), static_cast<T>(sample.point[1]),
                        static_cast<T>(sample.point[2])};
        T squared[frames_width];
        squared_distances(frames, p, squared);
        const auto& [a, b, c] = sample.triangle;
        const long double exactly = exact::root(exact::squared_distance_to_triangle(
            exact::vector(sample.point), exact::vector(a), exact::vector(b), exact::vector(c)));
        const double unit = frame_roundoff<T> * (sample.point.norm() + largest_corner(sample.triangle));
        EXPECT_LE(std::abs(std::sqrt(static_cast<long double>(squared[0])) - exactly),
                  frame_error<T> * unit + frame_underflow<T>);
    }
}

TEST(TriangleFrames, UnderflowIsCounted) {
    expect_underflow_is_counted<float>(0x1p-68);
    expect_underflow_is_counted<double>(0x1p-560);
}

// Returns a triangle of size about 2^-exponent: ordinary, with a short edge, thin, flat, a segment or a point (the last
// form is not tiny). Any corner may come first.
Triangle tiny_triangle(Random& random, int exponent, std::size_t form) {
    const auto tiny = [&](int smaller) -> Vec3 {
        Vec3 v = random.vector();
        for (double& x : v) x = std::ldexp(x, -exponent - smaller);
        return v;
    };
    const int smaller = static_cast<int>(random.below(60));
    const Vec3 a = form % 2 == 0 ? Vec3(Vec3::Zero()) : random.vector(0.5), b = a + tiny(0);
    Triangle t{a, b, a + tiny(0)};
    switch (form / 2) {
        case 0:
            break;
        case 1:
            t.c = a + tiny(smaller);  // one short edge
            break;
        case 2:
            t.c = b + tiny(smaller);
            break;
        case 3:
            t.c = a + random.unit() * (b - a) + tiny(smaller);
            break;
        case 4:
            t.c = a + random.real(-1, 2) * (b - a);
            break;
        case 5:
            t.c = b;
            break;
        case 6:
            t.b = t.c = a;
            break;
        default:
            t = any(random);  // not tiny
    }
    for (std::int64_t turn = random.below(3); turn > 0; --turn) t = {t.b, t.c, t.a};
    return t;
}

// Tries triangles of every size down to the smallest double: an edge's direction must have length 1, however short the
// edge is.
template <class T> void expect_tiny_triangles_are_within_the_error() {
    Random random(34);
    for (int exponent = 0; exponent <= 1074; ++exponent) {
        CornerRows corners;
        std::array<Triangle, frames_width> triangles;
        for (std::size_t i = 0; i < frames_width; ++i) {
            triangles[i] = tiny_triangle(random, exponent, i);
            corners.set(i, triangles[i]);
        }
        TriangleFrames<T> frames;
        make_frames(corners, frames);
        const int nearness = exponent % 3 == 0 ? static_cast<int>(random.below(1075)) : 0;
        Vec3 point = random.vector();
        for (double& x : point) x = std::ldexp(x, -nearness);
        const T p[3] = {static_cast<T>(point[0]), static_cast<T>(point[1]), static_cast<T>(point[2])};
        T squared[frames_width];
        squared_distances(frames, p, squared);
        for (std::size_t i = 0; i < frames_width; ++i) {
            const auto& [a, b, c] = triangles[i];
            const long double exactly = exact::root(exact::squared_distance_to_triangle(
                exact::vector(point), exact::vector(a), exact::vector(b), exact::vector(c)));
            const double unit = frame_roundoff<T> * (point.norm() + largest_corner(triangles[i]));
            ASSERT_LE(std::abs(std::sqrt(static_cast<long double>(squared[i])) - exactly),
                      frame_error<T> / 4 * unit + frame_underflow<T>)
                << "2^-" << exponent << ", form " << i << ", point of 2^-" << nearness;
        }
    }
}

TEST(TriangleFrames, FloatHoldsForTrianglesOfAnySize) { expect_tiny_triangles_are_within_the_error<float>(); }
TEST(TriangleFrames, DoubleHoldsForTrianglesOfAnySize) { expect_tiny_triangles_are_within_the_error<double>(); }

// Collinear corners, and points on their line: no edge separates inside from outside, so only the position along the
// line decides.
template <class T> void expect_within_the_error_beyond_the_ends_of_a_segment() {
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = [&](double x) -> Vec3 { return x * Vec3::Unit(axis); };
        for (const auto& [a, b, c] :
             {std::array{0.0, 1.0, 0.25}, {1.0, 0.0, 1.0}, {-0.5, 0.25, 0.5}, {0.5, 0.5, 0.5}}) {
            CornerRows corners;
            for (std::size_t i = 0; i < frames_width; ++i) corners.set(i, {at(a), at(b), at(c)});
            TriangleFrames<T> frames;
            make_frames(corners, frames);
            for (int eighths = -24; eighths <= 24; ++eighths) {
                const Vec3 point = at(eighths / 8.0);
                const T p[3] = {static_cast<T>(point[0]), static_cast<T>(point[1]), static_cast<T>(point[2])};
                T squared[frames_width];
                squared_distances(frames, p, squared);
                const double distance =
                    std::max({std::min({a, b, c}) - eighths / 8.0, 0.0, eighths / 8.0 - std::max({a, b, c})});
                for (const T s : squared)
                    EXPECT_NEAR(std::sqrt(s), distance, frame_error<T> * frame_roundoff<T> * 4)
                        << axis << ", " << eighths;
            }
        }
    }
}

TEST(TriangleFrames, FloatHoldsBeyondTheEndsOfASegment) {
    expect_within_the_error_beyond_the_ends_of_a_segment<float>();
}
TEST(TriangleFrames, DoubleHoldsBeyondTheEndsOfASegment) {
    expect_within_the_error_beyond_the_ends_of_a_segment<double>();
}

// The distance must not depend on which corner comes first or on the orientation.
TEST(TriangleFrames, TakeCornersInAnyOrder) {
    Random random(32);
    for (int i = 0; i < 100; ++i) {
        const Triangle t = any(random);
        CornerRows corners;
        const Triangle orders[6] = {{t.a, t.b, t.c}, {t.b, t.c, t.a}, {t.c, t.a, t.b},
                                    {t.a, t.c, t.b}, {t.c, t.b, t.a}, {t.b, t.a, t.c}};
        for (std::size_t k = 0; k < frames_width; ++k) corners.set(k, orders[k % 6]);
        TriangleFrames<double> frames;
        make_frames(corners, frames);
        const Vec3 point = random.vector(2);
        const double p[3] = {point[0], point[1], point[2]};
        double squared[frames_width];
        squared_distances(frames, p, squared);
        const double expected = std::sqrt(closest_point(point, t).squared_distance);
        for (const double s : squared) EXPECT_NEAR(std::sqrt(s), expected, 1e-13);
    }
}

}  // namespace
}  // namespace hausbench
