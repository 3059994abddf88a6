// Converts algebraic surfaces to meshes for mesh solvers: marching tetrahedra, with proven upper bounds of the
// distance between mesh and surface in both directions.
//
// With h(A,B) bounded by [l, u] on the meshes MA, MB of A and B:
//     l - h(MA,A) - h(B,MB) <= h(A,B) <= u + h(A,MA) + h(MB,B).
#pragma once

#include "algorithms/scene.h"

namespace hausbench {

// Triangulates a surface on a grid of `cells` cells per axis, each cut into the six tetrahedra around its diagonal.
// Vertices lie on their edges where bisection finds the change of sign; it uses only + - * /, so the bits are the
// same everywhere. Triangles without area are left out, and so are parts of the surface that no corner of the grid
// detects. Throws InputError if nothing is detected. O(cells^3).
TriangleMesh triangulate(const AlgebraicSurface& surface, int cells);

struct MeshDeviation {
    double mesh_to_surface, surface_to_mesh;  // upper bounds of h(mesh, surface) and h(surface, mesh)
};

// Bounds the distances between a surface and its mesh.
// Mesh to surface: if |f| <= M over a triangle, and |df/dx_k| >= m in its box widened by M / m along axis k, then a
// zero lies within M / m, which is of the order of the square of a cell. If this fails, or if the widened box leaves
// the surface's box, the bound is the distance of a vertex to a proven point plus the longest edge from that vertex.
// Surface to mesh: takes boxes that may meet the surface, down to the size of a cell over 2^levels. The bound for a
// box is the distance of its middle to the triangles of the surrounding cells plus half its diagonal. Infinity if one
// of them cannot be bounded. O(cells^2 4^levels) on tame surfaces.
MeshDeviation deviation(const AlgebraicSurface& surface, const TriangleMesh& mesh, int cells, int levels = 3);

// Returns an upper bound of the distance from p to the triangle abc. `magnitude` is at least the largest absolute
// coordinate of p, a, b and c. Requires UpwardRounding.
double triangle_distance_at_most(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, double magnitude);

}  // namespace hausbench
