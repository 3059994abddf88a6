// Re-checks the fields of a row, which have a value for each vertex or element of A (Field in solver.h). Checks 100
// vertices and 100 elements, evenly spread, with the exact distances of verify_exact.h. A and B are in their poses, and
// e = field_error() of fields.h is the allowed error.
//
// The fields `distance` and `nearest` are proven: all of B is at least distance - e away from the vertex, and the
// element `nearest` of B is at most distance + e away.
//
// The harness may have cut the triangles of A into smaller ones, called pieces (draw_distance() in fields.h). The
// fields `x`, `y`, `z` then contain the vertices of A, followed by the vertices that cuts added; `a`, `b`, `c`,
// `element` contain the corners of each piece and its triangle of A. These conditions are checked:
// - The vertices of A are unchanged.
// - `distance` and `nearest` are right for the added vertices, too.
// - The corners of a piece lie within 2e of its triangle of A.
// - The areas of the pieces of a triangle add up to its area.
//
// Fields with the meaning `lower` or `upper` (Field::Meaning) bound h(T,B), the largest distance from a point of T to
// B, for each element or vertex T of A. They can be refuted, not proven. These conditions are checked:
// - No lower bound is above an upper bound (for all elements, not only 100).
// - No upper bound is below the distance of a corner or of the centroid.
// - No lower bound is above the largest distance from a corner of T to b, for some elements b of B: because b is
//   convex, no point of T is farther from b than the farthest corner is. The elements b are the nearest to a corner or
//   to the centroid, computed in doubles.
#pragma once

#include "harness/check/verify.h"

#include <string>

namespace hausbench {

// Checks all fields of a row. `slack` is the allowed error of the solver's bounds (slack_for_rounding() in verify.cpp).
// Returns `not_checked` if a pose moves a shape out of the range of doubles, or if `stop` ended the check. `reason`
// says why a field is unsound.
Verdict check_fields(const Fields& fields, const Shape& source, const Pose& source_pose, const Shape& target,
                     const Pose& target_pose, double slack, const Stop& stop, std::string& reason);

}  // namespace hausbench
