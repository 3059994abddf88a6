// Checks the promises of kernel/point_triangle.h and kernel/box.h for a point and a triangle against
// the exact distance in rationals; the kernels for eight triangles at a time must return the same bits.
#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/triangle_block.h"
#include "tests/fuzz/coordinates.h"
#include "tests/support/exact.h"
#include "tests/support/scenes.h"

#include <algorithm>
#include <array>

namespace hausbench::fuzz {
namespace {

using exact::Rational;

Rational squared_to(const Vec3& p, const Triangle& t) {
    return exact::squared_distance_to_triangle(exact::vector(p), exact::vector(t.a), exact::vector(t.b),
                                               exact::vector(t.c));
}

bool at_most(const Rational& squared, const Rational& length) { return squared <= length * length; }

void check_one(const Vec3& p, const Triangle& t, const Vec3& guess) {
    double m = 0;
    for (const Vec3& v : {t.a, t.b, t.c, p}) m = std::max(m, v.cwiseAbs().maxCoeff());
    const TrianglePoint foot = closest_point(p, t);
    const Rational squared = squared_to(p, t);
    const Box box = box_of(t);
    expect((foot.point.array() >= box.low.array()).all() && (foot.point.array() <= box.high.array()).all(),
           "the foot is outside the triangle's box");
    expect(foot.squared_distance == squared_length(p - foot.point), "a squared distance that is not that of the foot");
    expect(squared_distance_to_box(p, box) <= foot.squared_distance, "the box is farther than the triangle");
    if (m < smallest_safe_magnitude || m > largest_safe_magnitude) return;
    expect(at_most(squared, surface_distance_at_most(foot.squared_distance, m, 0)), "the upper bound does not hold");
    expect(at_most(squared_to(foot.point, t), 7 * Rational(unit_roundoff) * Rational(m)),
           "the foot is off the triangle");
    for (const Vec3& q : {foot.point, guess}) {
        const Rational low = distance_certainly_at_least(p, t, q);
        expect(low <= 0 || low * low <= squared, "the lower bound does not hold");
    }
    // |p - foot| <= d + 10uM was found by tests, not proven (u = 2^-53; M: the largest |coordinate|; d: the distance).
    const Rational above =
        Rational(distance_at_least(foot.squared_distance, true)) - 10 * Rational(unit_roundoff) * Rational(m);
    expect(above <= 0 || above * above <= squared, "the foot is too far");
}

bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

void check_lane(const BlockFeet& feet, int lane, const TrianglePoint& foot) {
    expect(same(feet.squared_distance[lane], foot.squared_distance), "eight at a time: another distance");
    for (int k = 0; k < 3; ++k) expect(same(feet.point[k][lane], foot.point[k]), "eight at a time: another foot");
}

void kernels(std::string_view bytes) {
    Bytes in(bytes);
    const int exponent = static_cast<int>(in.next<std::uint16_t>() % 601) - 300;
    const double scale = std::ldexp(1.0, exponent);
    Coordinates coordinates(in);
    std::array<Vec3, 8> v;
    for (Vec3& point : v) point = scale * coordinates.point();
    const TriangleMesh mesh = soup(rows({v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[2], v[0]}));
    const Vec3 &p = v[6], &guess = v[7];
    std::array<Index, 3> all{0, 1, 2};
    TriangleBlock block;
    block.set(mesh, all);
    BlockFeet feet, back;
    closest_points(p, block, feet);
    PointBlock points;
    for (int lane = 0; lane < block_width; ++lane) {
        for (int k = 0; k < 3; ++k) points.coordinate[k][lane] = mesh.vertices(std::min(lane, 2), k);
    }
    const Triangle last = longest_edge_first(triangle_of(mesh, 1));
    closest_points(points, last, back);
    for (int lane = 0; lane < 3; ++lane) {
        const Triangle t = triangle_of(mesh, lane);
        check_one(p, t, guess);
        check_lane(feet, lane, closest_point(p, longest_edge_first(t)));
        check_lane(back, lane, closest_point(mesh.vertices.row(lane), last));
    }
}

}  // namespace
}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(kernels)
