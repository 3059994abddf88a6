// Operations that make shapes from other shapes, in float64. The results have the same bits on every machine.
#pragma once

#include "datasets/generate.h"
#include "datasets/load.h"
#include "datasets/merge_points.h"

namespace hausbench {

class RandomNumbers;  // random.h

// All operations. `hausbench list keys` prints them with their explanations.
const std::vector<Recipe>& operations();
std::vector<Recipe> exact_operations();  // the operations of derive_exact.cpp

// Calls check_numbers(), and checks that `simplify` is given exactly one of `ratio` and `triangles`. Throws InputError.
void check_operation(const std::string& where, const Recipe& operation, const Numbers& numbers);

// Returns a copy of g.origin, the shape that the operation is applied to, with these coordinates.
Shape with_points(const Given& g, const Points& points);

// Returns 0, ..., count - 1 in random order. Uses the random numbers `first`, ..., first + count - 1.
std::vector<Index> random_order(Eigen::Index count, const RandomNumbers& random, std::uint64_t first);

// Returns whether the operation must run in a separate process (separate_process.h), because CGAL performs it and may
// crash or take very long on some meshes.
bool made_in_a_process(const std::string& operation);

// Applies an operation to a shape. Throws InputError if the operation does not accept this kind of shape, or fails on
// it. `simplify` and `remesh` need a mesh that can be made a manifold, and a program built with CGAL's GPL parts.
LoadedShape derive(const std::string& operation, const Numbers& numbers, const LoadedShape& origin);

// Splits each triangle in four at the midpoints of its edges. New vertices follow the old ones; two triangles that
// share an edge also share its midpoint. O(n) expected.
TriangleMesh subdivide(const TriangleMesh& mesh);

// Merges vertices with equal coordinates into the first of them.
TriangleMesh weld(const TriangleMesh& mesh);

// Returns, for each triangle, the number of its connected part. Triangles that share a corner, by its coordinates,
// belong to the same part. Parts are numbered from 0 in the order of their first triangles. O(n) expected.
std::vector<Index> connected_parts(const TriangleMesh& mesh);

// Simplify by edge collapse to this number of triangles; remesh with edges of about this length. Both first make the
// mesh a manifold: they weld it, drop degenerate and duplicate faces, orient the others, and duplicate vertices so that
// at most two faces meet at an edge. Throw InputError if that fails. simplify() also throws if it can collapse no more
// edges and the number of triangles is still more than 10 % too large. In derive_cgal.cpp.
TriangleMesh simplify(const TriangleMesh& mesh, Index triangles);
TriangleMesh remesh(const TriangleMesh& mesh, double edge_length);

}  // namespace hausbench
