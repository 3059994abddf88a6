// Shapes in the cache format of this project: HDF5, float64 coordinates, int32 indices. Reading returns the same bits.
#pragma once

#include "datasets/load.h"

#include <filesystem>
#include <string>

namespace hausbench {

// Writes a complete file or none. `made_from` identifies everything that the shape was made from,
// such as the bytes of its raw file; empty: unknown.
void write_shape(const std::filesystem::path& file, const LoadedShape& shape, const std::string& made_from = "");

// Throws InputError, also if the file has a shape made from something other than `made_from`; empty: not checked.
LoadedShape read_shape(const std::filesystem::path& file, const std::string& made_from = "");

// Returns the SHA-256 (hex) of kind, counts, coordinates and indices, or of a surface's
// polynomial and box: two shapes with the same hash are the same input.
std::string content_hash(const Shape& shape);

// Returns the reason why a shape is invalid: no points, a coordinate that is not finite, an index
// out of range, no triangles, a vertex without a triangle, an invalid surface
// (kernel/polynomial.h). Empty if it is valid. Vertices and triangles are numbered from 0. O(n).
std::string shape_problem(const Shape& shape);

}  // namespace hausbench
