// Re-checks the fields of a row, which have a value for each vertex or element of A (Field in solver.h). Checks 100
// vertices and 100 elements, evenly spread, with the exact distances of verify_exact.h. A and B are in their poses, and
// e = field_error() of fields.h.
//
// The fields `distance` and `nearest` are proven: all of B is at least distance - e away from the vertex, and the
// element of B named by `nearest` at most distance + e.
//
// The harness may have cut the triangles of A into smaller ones, called pieces (draw_distance() in fields.h). The
// fields `x`, `y`, `z` are then the vertices, first the vertices of A and then those that cuts added, and `a`, `b`,
// `c`, `element` are the corners of each piece and its triangle of A. Checked: the vertices of A are equal to the bit;
// `distance` and `nearest` also cover the added vertices; the corners of a piece lie within 2e of its triangle of A;
// the areas of the pieces of a triangle add up to its area.
//
// Fields that bound (Field::Meaning `lower` and `upper`) have for an element or vertex T of A a bound on h(T,B), the
// largest distance of a point of T. They can be refuted, not proven. Checked:
// - No lower bound is above an upper bound (for all elements, not only 100).
// - No upper bound is below the distance of a corner or of the centroid.
// - No lower bound is above the largest distance from a corner of T to b, for some elements b of B: as b is convex, no
//   point of T is farther from b than the farthest corner is. The elements b are the nearest to a corner or to the
//   centroid, computed in doubles.
#pragma once

#include "harness/check/verify.h"

#include <string>

namespace hausbench {

// Checks all fields. `slack`: how far the solver's bounds may be off (slack_for_rounding() in verify.cpp). Returns
// `not_checked` if a pose moves a shape out of the range of doubles, or if `stop` ended the check. `reason` says
// why a field is unsound.
Verdict check_fields(const Fields& fields, const Shape& source, const Pose& source_pose, const Shape& target,
                     const Pose& target_pose, double slack, const Stop& stop, std::string& reason);

}  // namespace hausbench
