// Re-checks fields (Row::fields) on 100 vertices and 100 elements of A, evenly spread, with the exact distances of
// verify_exact.h.
//
// `distance` and `nearest`, proven: all of B posed is at least distance - e away from the vertex, and the named
// element at most distance + e, with e = field_error() of fields.h.
//
// A drawn A (fields `x`, `y`, `z` of vertices; `a`, `b`, `c`, `element` of pieces): the posed vertices of A come
// first, to the bit, and `distance` and `nearest` also cover the vertices that cuts added. The corners of a piece
// lie within 2e of its triangle of A. The areas of the pieces of a triangle add up to its area.
//
// `lower` and `upper` of an element (or a vertex) T of A bound h(T, B posed), the largest distance of its points.
// They can be refuted, not proven:
// - No lower bound is above an upper bound (for all elements, not only 100).
// - No upper bound is below the distance of a corner or of the centroid.
// - No lower bound is above the largest distance from a corner of T to b, for a single element b of B: as b is
//   convex, no point of T is farther from it. The elements b that are tried are about the nearest to a corner or to
//   the centroid.
#pragma once

#include "harness/check/verify.h"

#include <string>

namespace hausbench {

// Checks all fields. `slack`: how far the solver's bounds may be off, see slack_for_rounding(). Returns
// `not_checked` if a pose moves a shape out of the range of doubles, or if `stop` ended the check. `reason` says
// why a field is unsound.
Verdict check_fields(const Fields& fields, const Shape& source, const Pose& source_pose, const Shape& target,
                     const Pose& target_pose, double slack, const Stop& stop, std::string& reason);

}  // namespace hausbench
