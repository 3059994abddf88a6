// The search of surface_enclosure.cpp: boxes of A, that of the largest upper bound first, until the bounds are as close as asked.
#pragma once

#include "algorithms/solver.h"
#include "algorithms/surfaces/surface_tree.h"

namespace hausbench {

// Works on copies of the trees, which it refines until both together have `most_cells` boxes. Wants UpwardRounding.
Result enclose(const SurfaceTree& source, const SurfaceTree& target, std::size_t most_cells, const Query& query,
               Trace& trace);

}  // namespace hausbench
