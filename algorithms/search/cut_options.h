// Parameters that say how a solver cuts the triangles of A.
#pragma once

#include "algorithms/options.h"
#include "algorithms/search/subdivision.h"

#include <vector>

namespace hausbench {

// The parameter `split` of solvers whose papers cut triangles at midpoints, and the value that it has in `options`.
ParameterSpec split_parameter();
Split split_of(const Options& options);

// The points where a triangle of A is cut: the points of its edges that are equally far from two triangles of B, the
// midpoints of all its edges, or only the midpoint of the longest edge.
enum class Cutting { voronoi, midpoint, longest_edge };

// The parameters `split` and `least_part` of solvers whose papers describe Voronoi subdivision
// (meshes/tang/voronoi_cut.h), and the value that `split` has in `options`.
std::vector<ParameterSpec> cutting_parameters();
Cutting cutting_of(const Options& options);

}  // namespace hausbench
