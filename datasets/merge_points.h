// Merges equal points, and drops unused ones.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <vector>

namespace hausbench {

// Returns these rows of the points, in this order.
Points rows_of(const Points& points, const std::vector<Index>& rows);

// Returns, for each point, the index of the first point with the same coordinates (-0 equals +0). No coordinate may be
// NaN. O(n) expected.
std::vector<Index> first_equal(const Points& points);

// Returns the mesh without the vertices that no triangle uses. The other vertices keep their order.
TriangleMesh without_unused(const Points& vertices, const Triangles& triangles);

}  // namespace hausbench
