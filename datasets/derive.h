// Shapes made from other shapes, in float64. The result has the same bits on every machine.
#pragma once

#include "datasets/generate.h"
#include "datasets/load.h"

namespace hausbench {

class Random;  // random.h

// `hausbench list keys` explains them.
const std::vector<Recipe>& operations();
std::vector<Recipe> exact_operations();

// Does check_numbers(), and checks that simplify has exactly one of its two numbers.
void check_operation(const std::string& where, const Recipe& operation, const Numbers& numbers);

// Returns the origin with other coordinates.
Shape with_points(const Given& g, const Points& points);

// Returns 0 .. count - 1 in random order, from the random numbers with counter `first` and above.
std::vector<Index> random_order(Eigen::Index count, const Random& random, std::uint64_t first);

// Returns whether the operation runs in CGAL, which may crash on a mesh that it cannot process,
// or take very long: see separate_process.h.
bool made_in_a_process(const std::string& operation);

// Throws InputError if the operation does not take this kind of shape, or fails on it. simplify
// and remesh need a soup that can be made a manifold, and a program built with CGAL's GPL parts.
LoadedShape derive(const std::string& operation, const Numbers& numbers, const LoadedShape& origin);

// Splits each triangle in four. New vertices follow the old ones; triangles that share an edge share its midpoint. O(n)
// expected.
TriangleMesh subdivide(const TriangleMesh& mesh);

// Returns, for each row, the first row with equal coordinates (-0 = +0); no coordinate may be NaN. O(n) expected.
std::vector<Index> first_equal(const Points& points);

// Returns the mesh of these triangles without unused vertices; the others keep their order.
TriangleMesh without_unused(const Points& vertices, const Triangles& triangles);

// Merges vertices with equal coordinates into the first of them.
TriangleMesh weld(const TriangleMesh& mesh);

// Returns the connected part of each triangle, numbered from 0 in the order of their first triangles.
// Triangles that have a corner with equal coordinates are in the same part. O(n) expected.
std::vector<Index> connected_parts(const TriangleMesh& mesh);

// In derive_cgal.cpp. Both first make the soup a manifold: they weld it, orient the faces, and
// split edges of more than two faces.
TriangleMesh simplify(const TriangleMesh& mesh, Index triangles);
TriangleMesh remesh(const TriangleMesh& mesh, double edge_length);

}  // namespace hausbench
