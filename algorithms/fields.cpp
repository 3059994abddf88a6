#include "fields.h"

#include "error.h"
#include "kernel/rounding.h"
#include "structures/bvh.h"

#include <algorithm>
#include <cmath>

namespace hausbench {

namespace {

Points standing(const PreparedShape& shape, const Pose& pose, const char* name) {
    if (kind_of(shape.shape()) == ShapeKind::surface)
        throw InputError("an algebraic surface has no vertices, so it has no fields: triangulate it first");
    Points points = posed(shape.original(), pose);
    if (points.allFinite()) return points;
    throw InputError(std::string("the pose moves a point of ") + name +
                     " beyond the largest double, 1.8e308: give both shapes in a larger unit");
}

}  // namespace

Fields distance_fields(const PreparedShape& source, const Pose& source_pose, const PreparedShape& target,
                       const Pose& target_pose) {
    Shape vertices = PointSet{standing(source, source_pose, "A")};
    Shape there = target.shape();
    points_of(there) = standing(target, target_pose, "B");
    const int exponent = scale_exponent(std::max(magnitude(points_of(vertices)), magnitude(points_of(there))));
    const PreparedShape from(std::move(vertices), exponent), to(std::move(there), exponent);
    const TriangleBvh tree(to.triangles());
    const Points& points = points_of(from.shape());
    const auto count = static_cast<std::size_t>(points.rows());
    Field distance{"distance", Field::Of::vertices, Field::Meaning::number, std::vector<double>(count)};
    Field nearest{"nearest", Field::Of::vertices, Field::Meaning::number, std::vector<double>(count)};
    Counters unused;
    ClosestHints hints;
    for (std::size_t i = 0; i < count; ++i) {
        const ClosestPoint found = tree.closest(points.row(static_cast<Index>(i)).transpose(), hints, unused);
        distance.values[i] = std::ldexp(std::sqrt(found.squared_distance), -exponent);
        nearest.values[i] = found.triangle;
        hints.warm_triangle = found.triangle;  // neighbours in the file are often neighbours in space
    }
    return {std::move(distance), std::move(nearest)};
}

// Both shapes are scaled by a power of two, so that M is in [0.5, 1): coordinates that underflow are off by 2^-1075, next to uM nothing,
// and the distance by as much when it is scaled back.
//
// Let p be a vertex, T = abc a triangle with its longest edge e = b - a first, d the distance from p to T, q the point that closest_point
// (point_triangle.h) returns. q is within 7uM of T, so |p - q| >= d - 7uM. Here is the other side: |p - q| <= d + 271uM. The largest
// that was found is 10uM. Lengths are at most S = 2 sqrt(3) M < 3.47M; terms of order u^2 are in what constants are rounded up by.
//
// 1. Dot products of two computed differences err by 5.1u times both lengths, squares of lengths by 5.1u of themselves, their inverses by
//    6.2u. So along * inverse, for the point of an edge of length l that is nearest to p, errs by 12.4uS / l, which moves the point by
//    12.4uS, and rounding it by 6uM: it is within d_edge + 49.1uM of p. If l < 2^-500, where squares underflow, any point of the edge is
//    that near. The same holds of T if the point of T nearest to p is on an edge. Otherwise let it be a + X e + Y h, h the height over e.
// 2. |h| <= 46uS, a needle: the line along h through that point has at most |h| of it in T, so an edge is nearer to it than 80uM, and
//    step 1 finds a point within d + 80uM + 49.1uM.
// 3. |h| > 46uS. x_c errs by 12.4u, f - x_c e is rounded by 4.1u|e|: it is off by 4.1u|e| across e, and by 16.5u|e| along e. The second
//    step leaves 5.3u|h| + 230u^2|e| < 10.3u|h| along e, and 5.2u|e| =: b < 0.113|h| across. In y = h.ap / h.h, times |h|:
//       6u|e|             from b in the plane of T, where ap has Y|h| along h
//       13.1u|e|          from what is left along e, where ap has X|e|
//       r = 6.7ud|e|/|h|  from b out of the plane, where ap has d: the tilt
//       9.5uS             from rounding the two dot products and the quotient
//    and in x + y x_c, times |e|: 12.4uS from step 1, 12.4uy|e| from x_c, 2.1uS from the product and the difference.
// 4. If the weights are accepted, y <= 1, and the foot is off by 26.9uS along e and 28.6uS + r along h. No two points of T are farther
//    apart along h than |h|, so r counts as r' <= min(r, |h|), and sqrt(d^2 + r'^2) <= d + r|h| / 2d < d + 3.4uS. With the 7uM of the
//    rounded point |p - q| <= d + 42.7uS + 7uM < d + 156uM.
// 5. If they are refused, the foot as computed is outside, and a part s of the way to it from the exact one is on an edge. As s|y - Y| <= 1,
//    that is s y <= 2, the way so far is 42.4uS along e at most, and as before along h: an edge is within d + 54.6uS of p, and step 1 finds
//    a point within d + 54.6uS + 49.1uM < d + 239uM.
// 6. The smallest of the computed squares wins, which err by 7.1u of each other's roots, 25uM; then q is moved into the box of T, by no
//    more than it is off T: 239 + 25 + 7 = 271.
//
// Over all triangles the smallest computed square wins once more, 25uM, and its triangle is within 7uM of q: 303uM. The distance is
// computed with an error of 4u, 14uM, which is less. 320uM is more than all of it.
double field_error(double magnitude) { return 320 * unit_roundoff * magnitude + 0x1p-1074; }

std::string_view to_string(Field::Of of) { return of == Field::Of::vertices ? "vertices" : "elements"; }

std::string_view to_string(Field::Meaning meaning) {
    constexpr std::string_view names[] = {"lower", "upper", "number"};
    return names[static_cast<std::size_t>(meaning)];
}

}  // namespace hausbench
