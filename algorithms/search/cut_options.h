// Parameters that say how a solver cuts the triangles of A.
#pragma once

#include "algorithms/options.h"
#include "algorithms/search/subdivision.h"

#include <vector>

namespace hausbench {

// The parameter `split`, for solvers whose papers cut triangles at midpoints. split_of() reads its value.
ParameterSpec split_parameter();
Split split_of(const Options& options);

// How a triangle of A is cut: at the points of its edges that are equally far from two triangles of B, at the midpoints
// of all edges, or only at the midpoint of the longest edge.
enum class Cutting { voronoi, midpoint, longest_edge };

// The parameters `split` and `least_part`, for solvers whose papers cut at Voronoi boundaries
// (meshes/tang/voronoi_cut.h). cutting_of() reads the value of `split`.
std::vector<ParameterSpec> cutting_parameters();
Cutting cutting_of(const Options& options);

}  // namespace hausbench
