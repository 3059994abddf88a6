// Branch and bound with a single upper bound for each piece of A, from the triangles of B nearest to its corners and
// its barycentre. Zheng, Sun, Liu, Bao, Huang: Economic upper bound estimation in Hausdorff distance computation for
// triangle meshes, Computer Graphics Forum 41, 2022.
//
// The paper was not at hand, so this follows public code and Sacht and Jacobson 2024, section 3.2.4. The search is in
// cascade.h. The bound of a piece T is the least h(T, S) over four triangles S of B: the ones nearest to the corners
// and to the barycentre of T (search/piece_bounds.h). Ours: the barycentre is measured only if the bound from the
// three corners is not small enough, and its distance may raise the lower bound like the distance of any point of A.
// The boxes of a BVH over A purge groups of triangles (`regions`, search/source_regions.h).
//
// Fields: as in guthe.cpp, and "bound", the last bound computed for a piece of the triangle: 5 for the bound above (its
// number in PieceBound), or 0 if it was exact.
// Budget: subdivisions.
#include "algorithms/meshes/cascade.h"

namespace hausbench::zheng {

SolverEntry solver() {
    return {cascade_info("zheng", "Zheng 2022", "zheng2022", true), [](const Options& options) {
                return cascade_solver(cascade_of(options, {PieceBound::nearest_triangles}));
            }};
}

}  // namespace hausbench::zheng
