// Shapes made from other shapes, in float64; the result is the same bit for bit on every machine.
#pragma once

#include "datasets/generate.h"
#include "datasets/load.h"

namespace hausbench {

class Random;  // random.h

// vertices   a mesh becomes the set of its vertices
// weld       vertices (or points) with equal coordinates become one
// sample     count, seed: random points on the surface, uniform in area; of a point set, `count` of its points
// quantise   cells: each coordinate becomes the nearest multiple of 1 / cells, as in voxel data; equal points all stay
// simplify   ratio, or triangles: edge collapse (CGAL, Lindstrom and Turk 1998) down to that many triangles
// remesh     edge: even edges of this length, a fraction of the diagonal (CGAL, isotropic remeshing, 3 rounds)
// noise      amplitude, seed: each vertex moves within a cube of half this edge, a fraction of the diagonal
// subdivide  levels: splits each triangle in four at the midpoints of its edges; the surface changes by rounding only
// triangulate  cells: an algebraic surface becomes a mesh by marching tetrahedra (surfaces/surface_mesh.h); no other
//            operation takes a surface
// scale      factor, about the origin
// normalise  box centred at the origin, diagonal 1
// outlier    x, y, z: a point set gets one more point, the last
// translate  x, y, z: fractions of the diagonal
// rotate     x, y, z: the axis; t: tangent of half the angle; about the origin (rational, so that no libm is needed)
// stray      distance: the last element once more, that far along (2, 1, 2); a scan with one stray triangle or point
// two_clusters  distance: the shape, and a copy of it that far along (2, 1, 2)
// And those of derive_exact.cpp:
// move       x, y, z: lengths
// stretch    x, y, z: a factor for each coordinate; flattens a mesh into needles and caps
// power      exponent: all coordinates times that power of two; rounded only where they become subnormal
// nudge      ulps: every x becomes the double that many steps above it
// repeat     count, vertices, x, y, z, grow: copies of all elements, each moved on by x, y, z, and copy i larger by 1 + i grow; with `vertices` 0
//            the copies are of faces alone
// shuffle    seed: another order of vertices, of faces, and another first corner of each
// float32    each coordinate becomes the nearest float
const std::vector<Recipe>& operations();
std::vector<Recipe> exact_operations();

// As check_numbers(); also checks that simplify has exactly one of its two numbers.
void check_operation(const std::string& where, const Recipe& operation, const Numbers& numbers);

// What an operation gives where it only moves points.
Shape with_points(const Given& g, const Points& points);

// 0 .. count - 1 in a random order, by the numbers from `first` on.
std::vector<Index> random_order(Eigen::Index count, const Random& random, std::uint64_t first);

// Whether the operation is CGAL's, which may crash on a mesh that it cannot process, or take very long: see isolated.h.
bool made_in_a_process(const std::string& operation);

// Throws InputError if the operation does not take this shape, or fails on it (simplify and remesh need a soup that can be
// made a manifold, and a program built with CGAL's GPL parts).
LoadedShape derive(const std::string& operation, const Numbers& numbers, const LoadedShape& origin);

// Splits each triangle in four. New vertices follow the old ones; triangles that share an edge share its midpoint. O(n)
// expected.
TriangleMesh subdivide(const TriangleMesh& mesh);

// For each row, the first row with equal coordinates (-0 = +0); none may be NaN. O(n) expected.
std::vector<Index> first_equal(const Points& points);

// The mesh of these triangles without the vertices that none of them names; the others keep their order.
TriangleMesh without_unused(const Points& vertices, const Triangles& triangles);

// Merges vertices with equal coordinates into the first of them.
TriangleMesh weld(const TriangleMesh& mesh);

// The connected part of each triangle, numbered from 0 in the order of their first triangles. Triangles that have a corner with equal
// coordinates are in one part. O(n) expected.
std::vector<Index> connected_parts(const TriangleMesh& mesh);

// In derive_cgal.cpp. They first make the soup a manifold: weld it, orient the faces, split edges of more than two faces.
TriangleMesh simplify(const TriangleMesh& mesh, Index triangles);
TriangleMesh remesh(const TriangleMesh& mesh, double edge_length);

}  // namespace hausbench
