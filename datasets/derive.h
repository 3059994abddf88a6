// Shapes made from other shapes, in float64; the result is the same bit for bit on every machine.
#pragma once

#include "datasets/generate.h"
#include "datasets/load.h"

namespace hausbench {

class Random;  // random.h

// `hausbench list keys` explains them.
const std::vector<Recipe>& operations();
std::vector<Recipe> exact_operations();

// As check_numbers(); also checks that simplify has exactly one of its two numbers.
void check_operation(const std::string& where, const Recipe& operation, const Numbers& numbers);

// The result of an operation that only moves points.
Shape with_points(const Given& g, const Points& points);

// 0 .. count - 1 in a random order, by the numbers from `first` on.
std::vector<Index> random_order(Eigen::Index count, const Random& random, std::uint64_t first);

// Whether the operation is CGAL's, which may crash on a mesh that it cannot process, or take very long: see separate_process.h.
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
