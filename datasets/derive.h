// Shapes made from other shapes, in float64, the same bits each time.
#pragma once

#include "generate.h"
#include "load.h"

namespace hausbench {

// vertices   a mesh becomes the set of its vertices
// weld       vertices (or points) with equal coordinates become one
// sample     count, seed: points spread over the surface, by area; of a point set, `count` of its points
// quantise   cells: each coordinate becomes the nearest multiple of 1 / cells, as in voxel data; equal points all stay
// simplify   ratio, or triangles: edge collapse (CGAL, Lindstrom and Turk 1998) down to that many triangles
// remesh     edge: even edges of this length, a fraction of the diagonal (CGAL, isotropic remeshing, 3 rounds)
// noise      amplitude, seed: each vertex moves within a cube of half this edge, a fraction of the diagonal
// subdivide  levels: each triangle in four at the midpoints of its edges; the surface stays the same but for rounding
// triangulate  cells: an algebraic surface becomes a mesh by marching tetrahedra (surfaces/surface_mesh.h), the only
//            operation that takes one
// scale      factor, about the origin
// normalise  box centred at the origin, diagonal 1
// outlier    x, y, z: a point set gets one more point, the last
// translate  x, y, z: fractions of the diagonal
// rotate     x, y, z: the axis; t: tangent of half the angle; about the origin (rational, so that no libm is needed)
const std::vector<Recipe>& operations();

// As check_numbers(), and that simplify has one of its two numbers.
void check_operation(const std::string& where, const Recipe& operation, const Numbers& numbers);

// Throws InputError for a shape that the operation does not take, or that it cannot do (simplify, remesh of a soup
// that no manifold can be made from; a program built without CGAL's GPL parts).
LoadedShape derive(const std::string& operation, const Numbers& numbers, const LoadedShape& origin);

// Each triangle in four. New vertices come after the old ones; an edge of several triangles has one midpoint. O(n)
// expected.
TriangleMesh subdivide(const TriangleMesh& mesh);

// Vertices with equal coordinates (-0 = +0) become the first of them.
TriangleMesh weld(const TriangleMesh& mesh);

// derive_cgal.cpp; a soup is made a manifold first: welded, faces oriented, edges of more than two faces taken apart.
TriangleMesh simplify(const TriangleMesh& mesh, Index triangles);
TriangleMesh remesh(const TriangleMesh& mesh, double edge_length);

}  // namespace hausbench
