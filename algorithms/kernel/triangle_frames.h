// Triangles in their own frames, sixteen side by side: the distances from a point to all of them take only products
// and sums.
//
// The frame of a triangle with longest edge ab has the axes e along ab, h towards the third corner c, and the
// normal n; its origin is a, so b = (L, 0, 0) and c = (x_c, y_c, 0). Moving a point there takes nine products. Its
// distance in the plane is the least of its distances to the three edges, or 0 inside; the edges ac and bc are kept
// as a direction of length 1 and a length. A query needs no division and no square root: they are done when the
// frame is made, in double precision.
//
// Error. u is the unit roundoff of T, R the largest |corner|, and D = |p| + R. For coordinates of at most 2^40, let
// s be the computed square and d the exact distance from p to the triangle: |sqrt(s) - d| <= frame_error<T> u D,
// plus 2^-60 for float and 2^-500 for double because of underflow. The derivation is for T = float, where making
// the frame errs by far less than u; vectors are measured by Euclid's norm:
//   - e, h and n, rounded from double, are within u of orthonormal axes. A coordinate of p errs by u|p| for that,
//     by u R for rounding the shift and by 4u D for three products and their sums: 6u D. For all three it is
//     sqrt(3) 6u D < 11u D.
//   - p itself, once rounded, is off by u|p|.
//   - Corners: L, x_c, y_c err by u 2R each; as directions and lengths of edges, by twice that, and c as seen from
//     a differs no more from c as seen from b: 8u R. A triangle flatter than 8u of its length is replaced by its
//     longest edge, which moves no point by more than that: 16u R.
//   - In the plane: t and the distance s to the line of an edge take two products, a sum and a direction that errs
//     by u, on numbers of at most D: 4u D each, so sqrt(2) 4u D < 6u D for an edge.
//   - Inside: a point counts as inside if it is within 4u D of the inner side of the three lines and 0 <= x <= L.
//     How near to the triangle is it then? Near a corner of 60 degrees or more it is within 2 * 4u D, because the
//     mitre of an angle w is 1 / sin(w / 2) long. The angle at c is such an angle, as ab is longest. Near a or b
//     with a smaller angle, where 0 <= x <= L cuts the mitre off, the triangle is straight below or above the
//     point, within 4u D / cos(w) <= 2 * 4u D. If an inside point counts as outside, it is within 4u D of a line,
//     and at least as near to an edge, because the way to the line meets an edge of the triangle first. Together
//     8u D.
//   - The sums of squares and the square root of s: 3u s, so 1.5u sqrt(s) <= 4u D.
// Together 11 + 1 + 8 + 16 + max(6, 8) + 4 = 48u D; terms of order u^2 are far below the 64 that is used. For
// T = double, making the frame counts: edges, lengths and axes take up to 12 roundings each instead of one above (e
// is within 6u of an axis, h within 10u, n within 20u; a coordinate errs by 28u D, L, x_c and y_c by 20u R). In
// total this is less than 5 times as much; 256 is used.
//
// Underflow. A square may lose 2^-1075, so the root of a sum of squares of about 2^-1075 errs by any factor; a
// direction divided by it does not have length 1, and the coordinates of all points, however far, are off by that
// factor. So no direction is made from a length of 2^-502 or less:
//   - If the longest edge, as computed, is no longer than that, the triangle is replaced by a segment of its length
//     along the x axis from a. Both are within 2^-502 of a, up to rounding, so no distance changes by more.
//   - If c is no farther than 2^-501 from the line of ab, the triangle is replaced by ab. No point moves by more,
//     as ab is longest. A point is flat too, as c is within 2^-502 of a.
// Otherwise |ab| > 2^-502, and y_c, which is at least half the height, is above 2^-502. Three squares lose
// 3 2^-1075, a part of less than 2^-69 of the sums whose roots are |ab|, |ac|, |bc| and the height. So the roots
// lose a part of 2^-70, far below u. All other products only add their losses: 2^-1075 each for double, 2^-150 for
// float, times at most 2^40 in a coordinate, and under the last root sqrt(6 2^-1075) < 2^-535 or
// sqrt(6 2^-150) < 2^-73. Together less than 2^-500 for double, and less than 2^-60 for float.
#pragma once

#include "algorithms/kernel/geometry.h"
#include "algorithms/kernel/point_triangle.h"

#include <cstddef>

namespace hausbench {

inline constexpr std::size_t frames_width = 16;

// Row numbers of TriangleFrames; each row has one number per triangle.
namespace frame_row {
inline constexpr std::size_t e = 0, h = 3, n = 6;  // three rows each
inline constexpr std::size_t shift = 9;            // three rows: minus the corner a along e, h and n
inline constexpr std::size_t length = 12;          // L
inline constexpr std::size_t ac = 13, ac_length = 15, bc = 16, bc_length = 18;
inline constexpr std::size_t count = 19;
}  // namespace frame_row

template <class T> inline constexpr double frame_error = sizeof(T) == 4 ? 64 : 256;
template <class T> inline constexpr double frame_roundoff = sizeof(T) == 4 ? 0x1p-24 : 0x1p-53;
template <class T> inline constexpr double frame_underflow = sizeof(T) == 4 ? 0x1p-60 : 0x1p-500;

// A triangle whose longest edge is at most this long counts as a point. A triangle whose height is at most twice
// this counts as its longest edge.
inline constexpr double frame_point = 0x1p-502;

template <class T> struct alignas(64) TriangleFrames { T row[frame_row::count][frames_width]; };

// The coordinates of the corners: row[3 v + k] holds coordinate k of corner v of each triangle.
struct alignas(64) CornerRows {
    double row[9][frames_width];

    void set(std::size_t lane, const Triangle& triangle) {
        const Vec3* const corners[3] = {&triangle.a, &triangle.b, &triangle.c};
        for (std::size_t v = 0; v < 3; ++v)
            for (std::size_t k = 0; k < 3; ++k) row[3 * v + k][lane] = (*corners[v])[static_cast<Index>(k)];
    }
};

void make_frames(const CornerRows& corners, TriangleFrames<float>& frames);
void make_frames(const CornerRows& corners, TriangleFrames<double>& frames);

// Computes the squared distances from a point to all triangles. For tests; code where speed matters inlines the
// kernel of triangle_frames-inl.h.
void squared_distances(const TriangleFrames<float>& frames, const float (&point)[3], float (&squared)[frames_width]);
void squared_distances(const TriangleFrames<double>& frames, const double (&point)[3], double (&squared)[frames_width]);

}  // namespace hausbench
