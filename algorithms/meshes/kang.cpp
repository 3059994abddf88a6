// Branch and bound with a single upper bound for each piece of A: the piece is cut where the triangles of B nearest
// to its corners meet, and each part is bounded by one of these triangles. Kang, Kyung, Yoon, Kim: Fast and robust
// Hausdorff distance computation from triangle mesh to quad mesh in near-zero cases, Computer Aided Geometric Design
// 62, 2018.
//
// The paper was not at hand, so this follows public code and Sacht and Jacobson 2024, section 3.2.3, which calls the
// bound u3. The search is in cascade.h, the bound in search/piece_bounds.h. Closest points are found with a uniform
// grid (structures/triangle_grid.h) or with a BVH, which is faster if A is far from B. Here B is a triangle mesh, not a
// quad mesh.
//
// Fields: as in guthe.cpp, and "bound", the last bound computed for a piece of the triangle: 3, or 0 if it was exact.
// Budget: subdivisions.
#include "algorithms/meshes/cascade.h"

namespace hausbench::kang {

SolverEntry solver() {
    SolverInfo info = cascade_info("kang", "Kang 2018", "kang2018");
    info.may_need.push_back(need<TriangleGrid>(Side::target));
    info.parameters.push_back({.name = "closest",
                               .default_value = std::string("grid"),
                               .paper_value = "grid",
                               .description = "structure that finds the closest points of B: a uniform grid or a BVH",
                               .choices = {"grid", "bvh"}});
    return {info, [](const Options& options) {
                Cascade cascade = cascade_of(options, {PieceBound::u3});
                cascade.grid = options.text("closest") == "grid";
                return cascade_solver(std::move(cascade));
            }};
}

}  // namespace hausbench::kang
