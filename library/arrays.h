// Reads the arrays of a caller, who is not trusted.
#pragma once

#include "algorithms/kernel/geometry.h"
#include "library/hausbench.h"

namespace hausbench::library {

// Copy an array, check the copy (so that a caller who changes the array meanwhile does no harm), and throw
// ArgumentError, with the row, for anything that hausbench_shape_of() refuses. `argument` is the argument's number.
Points points_in(const hausbench_array& array, int argument);
Triangles triangles_in(const hausbench_array& array, Index vertices, int argument);

}  // namespace hausbench::library
