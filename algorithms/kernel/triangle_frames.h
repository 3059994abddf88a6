// Computes the distances from a point to sixteen triangles at a time. Each triangle is stored in its own coordinate
// system, its *frame*, in which a distance takes only products, sums and comparisons.
//
// The frame of a triangle has its origin at a corner a. Its axes, of length 1, are e along the longest edge ab, h in
// the plane of the triangle towards the third corner c, and the normal n. So b has the coordinates (L, 0, 0) and c has
// (x_c, y_c, 0). Moving a point into the frame takes nine products. The distance of the point from the plane is then
// |z|, and within the plane it is the least of the distances from the three edges, or 0 inside the triangle. The edges
// ac and bc are stored as a direction of length 1 and a length. So a query needs no division and no square root; these
// are done when the frame is made, in double precision.
//
// Error. Let T be the type of the numbers (float or double), u its unit roundoff, p the point, R the largest length
// |a|, |b| or |c|, and D = |p| + R. Let s be the computed squared distance, and d the exact distance from p to the
// triangle. For coordinates of at most 2^40,
//     |sqrt(s) - d| <= frame_error<T> * u D + frame_underflow<T>.
// The derivation is for T = float, where double precision makes frames with an error far below u, so that only the
// rounding to float counts. Vectors are measured by Euclid's norm. The parts of the error are:
//   - Axes, 11u D: e, h and n, rounded from double, are within u of orthonormal axes. So a coordinate of p in the frame
//     errs by u |p|; by another u R for rounding the shift, which is minus the coordinate of a; and by another 4u D for
//     three products and their sums: together 6u D. For all three coordinates, this is sqrt(3) * 6u D < 11u D.
//   - Point, u D: p itself is rounded to T, which moves it by u |p|.
//   - Corners, 8u R: L, x_c and y_c err by u * 2R each. The end of an edge that is stored as a direction and a length
//     errs by twice that, 4u R. The end of ac and the end of bc, which both stand for c, differ by no more than the sum
//     of their errors, 8u R.
//   - Flat triangles, 16u R: a triangle whose height is at most 8u times its length is replaced with its longest edge.
//     As the length is at most 2R, no point moves by more than 16u R.
//   - Edges, 6u D: for each edge, the code computes the coordinate t along it and the distance from its line. Both take
//     two products, a sum and a direction that errs by u, with numbers of at most D: 4u D each. Together, the distance
//     from an edge errs by sqrt(2) * 4u D < 6u D.
//   - Inside, 8u D, for points that count as inside or should; these do not have the error of an edge. A point counts
//     as inside if 0 <= x <= L and it seems to be on the inner side of the lines of all three edges. As these distances
//     err by 4u D, it may be outside each line by 4u D. How far may it be from the triangle?
//     Near a corner with angle w: lines that are moved outward by 4u D meet at a distance of 4u D / sin(w / 2) from the
//     corner. If w is at least 60 degrees, this is at most 2 * 4u D. The angle at c is, because ab is the longest edge.
//     If w is smaller at a or b, the condition 0 <= x <= L cuts off the region between the moved lines beyond the
//     corner. Then the point has the triangle straight above or below it (along h), at a distance of at most
//     4u D / cos(w) <= 2 * 4u D.
//     A point inside that counts as outside is within 4u D of one of the lines. It is at least as near to an edge,
//     because the way to the line meets an edge of the triangle first.
//   - Squares, 4u D: s, a sum of squares, errs by 3u s, so its root errs by 1.5u sqrt(s), and sqrt(s) is about D at
//     most. This leaves room for the differences that are squared; their rounding costs another u sqrt(s).
// The sum is 11 + 1 + 8 + 16 + max(6, 8) + 4 = 48u D. frame_error is 64, which also covers terms of order u^2.
//
// For T = double, making the frame errs, too. Edges, lengths and axes take up to 12 roundings each, instead of one
// above: e is within 6u of an axis, h within 10u, and n within 20u; a coordinate errs by 28u D, and L, x_c and y_c by
// 20u R. In total, this is less than 5 times as much as above. frame_error is 256, which is more than 5 * 48.
//
// Underflow. A square may lose 2^-1075. So the square root of a sum of squares of about 2^-1075 errs by any factor. A
// direction that was divided by such a root does not have length 1, and the coordinate of any point along it, however
// far the point is, errs by the same factor. So no direction is made from a length of 2^-502 (frame_point) or less:
//   - If the longest edge, as computed, has at most length 2^-502, the triangle is replaced with a segment of the same
//     length that starts at a and is parallel to the x axis. Both are within 2^-502 of a, up to rounding, so no
//     distance changes by more.
//   - If c is within 2^-501 of the line of ab, the triangle is replaced with ab. No point moves by more,
//     because ab is the longest edge. This includes the triangles of the first case, in which c is within 2^-502 of a.
// For all other triangles, |ab| > 2^-502, and y_c, which is at least half the height, is above 2^-502. Three squares
// lose 3 * 2^-1075, which is less than a 2^-69 part of the sums whose roots are |ab|, |ac|, |bc| and the height. So the
// roots lose a 2^-70 part, far below u.
//
// The underflow of all other products only adds a small error: 2^-1075 for each product of doubles, and 2^-150 for
// each product of floats. In a coordinate, this is multiplied by at most 2^40. Under the last root, it becomes at most
// sqrt(6 * 2^-1075) < 2^-535 for double, and sqrt(6 * 2^-150) < 2^-73 for float. In total, this is less than
// frame_underflow: 2^-500 for double, 2^-60 for float.
#pragma once

#include "algorithms/kernel/geometry.h"
#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/watched.h"

#include <cstddef>

namespace hausbench {

inline constexpr std::size_t frames_width = 16;

// Indices of the rows of TriangleFrames. Each row has one number per triangle.
namespace frame_row {
inline constexpr std::size_t e = 0, h = 3, n = 6;  // the axes: three rows each
inline constexpr std::size_t shift = 9;            // three rows: minus the coordinates of a along e, h and n
inline constexpr std::size_t length = 12;          // L, the length of ab
// The edges ac and bc: two rows for the unit direction (its components along e and h), and one for the length.
inline constexpr std::size_t ac = 13, ac_length = 15, bc = 16, bc_length = 18;
inline constexpr std::size_t count = 19;
}  // namespace frame_row

// Constants of the error bound at the top of this file: a computed distance errs by at most frame_error *
// frame_roundoff * D + frame_underflow. D is the largest distance of a corner from the origin plus the distance of the
// point from the origin.
template <class T> inline constexpr double frame_error = sizeof(T) == 4 ? 64 : 256;
template <class T> inline constexpr double frame_roundoff = sizeof(T) == 4 ? 0x1p-24 : 0x1p-53;
template <class T>
inline const double frame_underflow = WATCHED("triangle frames: underflow", sizeof(T) == 4 ? 0x1p-60 : 0x1p-500);

// Underflow could spoil the frames of smaller triangles. A triangle whose longest edge is at most this long is treated
// as a point, and a triangle whose height is at most twice this is replaced with its longest edge.
inline constexpr double frame_point = 0x1p-502;

// The frames of sixteen triangles, one in each lane. frame_row lists the rows.
template <class T> struct alignas(64) TriangleFrames { T row[frame_row::count][frames_width]; };

// The corners of sixteen triangles: row[3 * v + k] has coordinate k of corner v, one triangle in each lane.
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

// Computes the squared distances from a point to all sixteen triangles. Meant for tests; code that must be fast inlines
// squared_in_frames() (triangle_frames-inl.h).
void squared_distances(const TriangleFrames<float>& frames, const float (&point)[3], float (&squared)[frames_width]);
void squared_distances(const TriangleFrames<double>& frames, const double (&point)[3], double (&squared)[frames_width]);

}  // namespace hausbench
