// How a solver cuts the triangles of A, as its parameters say.
#pragma once

#include "algorithms/options.h"
#include "algorithms/search/subdivision.h"

#include <vector>

namespace hausbench {

// The parameter `split` where the published one is at midpoints, and what it says.
ParameterSpec split_parameter();
Split split_of(const Options& options);

enum class Cutting { voronoi, midpoint, longest_edge };

// The parameters `split` and `least_part` where it is Voronoi subdivision (voronoi_cut.h), and what the first of them says.
std::vector<ParameterSpec> cutting_parameters();
Cutting cutting_of(const Options& options);

}  // namespace hausbench
