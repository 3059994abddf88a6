// Shapes in this project's own cache format: HDF5, float64 coordinates, int32 indices; read back bit-equal.
#pragma once

#include "load.h"

#include <filesystem>
#include <string>

namespace hausbench {

void write_shape(const std::filesystem::path& file, const LoadedShape& shape);  // whole or not at all
LoadedShape read_shape(const std::filesystem::path& file);                      // throws InputError

// SHA-256 (hex) of kind, counts, coordinates and indices, or the text of a polynomial: two shapes with the same hash are the same input.
std::string content_hash(const Shape& shape);

// What keeps this from being a legal shape: no points, a coordinate that is not finite, an index out of range, no
// triangles, a vertex of no triangle, a surface that is none (kernel/polynomial.h). Empty where it is one. Vertices and triangles are numbered from 0. O(n).
std::string shape_problem(const Shape& shape);

}  // namespace hausbench
