// Frames of triangles: their distances are within the error that kernel/triangle_frames.h derives, on triangles of every hard kind.
#include "exact.h"
#include "kernel/triangle_frames.h"
#include "triangle_samples.h"

#include <gtest/gtest.h>

namespace hausbench {
namespace {

// Of a sample moved and scaled so that its coordinates, which it may lie far away with, are at most 1 or so.
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
            for (std::size_t own = 0; own < points.size(); ++own) {
                const Vec3& point = points[own];
                const T p[3] = {static_cast<T>(point[0]), static_cast<T>(point[1]), static_cast<T>(point[2])};
                T squared[frames_width];
                squared_distances(frames, p, squared);
                for (std::size_t i = own % 4; i < frames_width;
                     i += 4) {  // its own, and others: exact numbers take long
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
        // What is proven is not far from what happens, so that a slip in the kernel shows.
        EXPECT_LE(worst, frame_error<T> / 4) << kind.name;
    }
}

TEST(TriangleFrames, FloatIsWithinItsError) { expect_within_the_error<float>(); }
TEST(TriangleFrames, DoubleIsWithinItsError) { expect_within_the_error<double>(); }

// Where all coordinates are so small that squares underflow.
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

// Which corner the longest edge begins at, and which way round the triangle is, is all the same.
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
