// One upper bound, from cutting a piece where its nearest triangles meet: Kang, Kyung, Yoon, Kim: Fast and robust Hausdorff distance
// computation from triangle mesh to quad mesh in near-zero cases, Computer Aided Geometric Design 62, 2018.
//
// After public code, and after Sacht and Jacobson 2024, section 3.2.3, who call the bound u3; that paper was not at hand. The
// search is search/cascade.h, the bound is search/piece_bounds.h. Closest points are found by a BVH. The published program
// finds them by a uniform grid, which is not here yet; B is a triangle mesh here, not one of quadrilaterals.
//
// Fields: those of guthe.cpp, and "bound": 0 where the last piece of the triangle was exact, otherwise 3.
// Budget: subdivisions.
#include "search/cascade.h"

namespace hausbench {

SolverEntry kang_solver() {
    return {cascade_info("kang", "Kang et al.", "kang2018"), [](const Options& options) {
                return cascade_solver({{PieceBound::u3}, split_of(options)});
            }};
}

}  // namespace hausbench
