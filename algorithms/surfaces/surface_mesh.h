// From algebraic surfaces to meshes, so that mesh solvers can be asked about them: marching tetrahedra, and how far the
// mesh is from the surface at most, proven in both directions.
//
// With h(A,B) bounded by [l, u] on the meshes MA, MB of A and B:
//     l - h(MA,A) - h(B,MB) <= h(A,B) <= u + h(A,MA) + h(MB,B).
#pragma once

#include "algorithms/scene.h"

namespace hausbench {

// Triangulates on a grid of `cells` along each axis, each cell cut into the six tetrahedra around its diagonal.
// Vertices lie on their edges where bisection finds the change of sign; only + - * / are used, so the bits are the
// same everywhere. Triangles without area, and parts of the surface that no corner of the grid sees, are left out.
// Throws InputError if no corner sees any part. O(cells^3).
TriangleMesh triangulate(const AlgebraicSurface& surface, int cells);

struct MeshDeviation {
    double mesh_to_surface, surface_to_mesh;  // no less than h(mesh, surface) and h(surface, mesh)
};

// Mesh to surface: over each triangle |f| <= M, and |df/dx_k| >= m in its box widened by M / m along axis k, so that a zero
// lies within M / m (of the order of the square of a cell); where that fails, or the widened box leaves the surface's, the
// distance of a vertex to a proven point, and the longest edge from there.
// Surface to mesh: boxes that may meet the surface, down to a cell over 2^levels; each with the distance of its middle to
// the triangles of the cells around, and half its diagonal. Infinity where one of them cannot be bounded.
// O(cells^2 4^levels) on tame surfaces.
MeshDeviation deviation(const AlgebraicSurface& surface, const TriangleMesh& mesh, int cells, int levels = 3);

// At least the distance from p to the triangle abc. `magnitude`: the largest absolute coordinate of p, a, b and c, at least.
// Wants UpwardRounding.
double triangle_distance_at_most(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, double magnitude);

}  // namespace hausbench
