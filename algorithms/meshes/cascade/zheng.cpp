// A single upper bound, from the triangles of B nearest to a piece's corners and barycentre: Zheng, Sun, Liu, Bao,
// Huang: Economic upper bound estimation in Hausdorff distance computation for triangle meshes, Computer Graphics
// Forum 41, 2022.
//
// The paper was not at hand, so this follows public code and Sacht and Jacobson 2024, section 3.2.4. The search is in
// cascade.h. The bound of a piece T is the least h(T, S) over the triangles S nearest to its three corners and its
// barycentre (search/piece_bounds.h). Ours: the barycentre is measured only if the corners do not settle the piece,
// and it counts for the lower bound like any point of A. The boxes of a BVH of A purge groups of triangles
// (`regions`, search/source_regions.h).
//
// Fields: as in guthe.cpp, and "bound": 0 if the last piece of the triangle was exact, otherwise 5.
// Budget: subdivisions.
#include "algorithms/meshes/cascade/cascade.h"

namespace hausbench {

SolverEntry zheng_solver() {
    return {cascade_info("zheng", "Zheng 2022", "zheng2022", true), [](const Options& options) {
                return cascade_solver(cascade_of(options, {PieceBound::nearest_triangles}));
            }};
}

}  // namespace hausbench
