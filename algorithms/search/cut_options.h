// Parameters that say how a solver cuts the triangles of A.
#pragma once

#include "algorithms/options.h"
#include "algorithms/search/subdivision.h"

#include <vector>

namespace hausbench {

// The parameter `split` of solvers that publish midpoint subdivision, and its value.
ParameterSpec split_parameter();
Split split_of(const Options& options);

enum class Cutting { voronoi, midpoint, longest_edge };

// The parameters `split` and `least_part` of solvers that publish Voronoi subdivision (voronoi_cut.h), and the value of the first.
std::vector<ParameterSpec> cutting_parameters();
Cutting cutting_of(const Options& options);

}  // namespace hausbench
