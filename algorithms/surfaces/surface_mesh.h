// Converts algebraic surfaces to meshes for mesh solvers, by marching tetrahedra, with proven upper bounds on the
// distance between mesh and surface in both directions. composed/surface_meshes.cpp uses both.
#pragma once

#include "algorithms/scene.h"

namespace hausbench {

// Triangulates a surface on a grid of `cells` cells per axis. Each cell consists of the six tetrahedra around its
// diagonal. A vertex of the mesh lies on an edge of a tetrahedron, where bisection finds the change of sign of the
// polynomial; only + - * / are used, so the bits are the same everywhere. Misses a part of the surface if the
// polynomial has the same sign at all corners of the grid around it. Leaves out triangles with two equal corners.
// Throws InputError if no triangle is found. O(cells^3).
TriangleMesh triangulate(const AlgebraicSurface& surface, int cells);

struct MeshDeviation {
    double mesh_to_surface, surface_to_mesh;  // upper bounds on h(mesh, surface) and h(surface, mesh)
};

// Bounds the distances between a surface f = 0 and its mesh.
// - Mesh to surface: let |f| <= M over a triangle. Widen the box of the triangle along axis k by M / m, and let
//   |df/dx_k| >= m there. Then each point of the triangle has a zero of f within M / m along this axis, which is of the
//   order of the square of a cell. If no such m is found, or if the widened box leaves the box of the surface, the
//   bound is the distance from a vertex to a proven point of the surface plus the longest edge from this vertex.
// - Surface to mesh: covers the surface with boxes of the size of a cell over 2^levels. The bound for a box is the
//   distance from its middle to the triangles in the cells around it, plus half its diagonal. Infinity if a box has no
//   triangle near it.
// O(cells^2 4^levels) for a smooth surface.
MeshDeviation deviation(const AlgebraicSurface& surface, const TriangleMesh& mesh, int cells, int levels = 3);

// Returns an upper bound on the distance from p to the triangle abc. `magnitude` is at least the largest |coordinate|
// of p, a, b and c. The caller must hold an UpwardRounding.
double triangle_distance_at_most(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, double magnitude);

}  // namespace hausbench
