// Re-checks fields (Row::fields) on 100 vertices and 100 elements of A, evenly spread, with what verify_exact.h offers.
//
// `distance` and `nearest`, proven: all of B posed is at least distance - e away from the vertex, and the element named at most
// distance + e, with e = field_error() of fields.h.
//
// A drawn A (fields `x`, `y`, `z` of vertices; `a`, `b`, `c`, `element` of pieces): its vertices in its pose come first, to the bit,
// and `distance` and `nearest` go on to the vertices that cuts added. The corners of a piece lie within 2e of its triangle of A. The
// pieces of a triangle have its area.
//
// `lower` and `upper` of an element T (or of a vertex) of A, which bound h(T, B posed), the largest distance of a point of it: that can
// refute, not prove. No lower bound is above an upper one (of all elements, not of 100). No upper bound is below the distance of a
// corner or of the centroid. No lower bound is above the largest distance from a corner to b, for a single element b of B: as b is
// convex, no point of T is farther from it. It tries the elements b that are about the nearest to a corner or the centroid.
#pragma once

#include "harness/check/verify.h"

#include <string>

namespace hausbench {

// `slack`: the largest rounding error of the solver's bounds, see slack_for_rounding(). `not_checked` if a pose takes
// a shape out of the range of doubles, or if it was stopped; `reason` names the unsound value.
Verdict check_fields(const Fields& fields, const Shape& source, const Pose& source_pose, const Shape& target,
                     const Pose& target_pose, double slack, const Stop& stop, std::string& reason);

}  // namespace hausbench
