// Shapes in the cache format of this project: HDF5, float64 coordinates, int32 indices; reading gives the same bits.
#pragma once

#include "datasets/load.h"

#include <filesystem>
#include <string>

namespace hausbench {

// The file is complete or absent. `made_from` identifies everything that the shape was made from, such as the bytes of its raw file;
// empty: unknown.
void write_shape(const std::filesystem::path& file, const LoadedShape& shape, const std::string& made_from = "");

// Throws InputError, also if the file holds a shape that was made from something else than `made_from`; empty: not checked.
LoadedShape read_shape(const std::filesystem::path& file, const std::string& made_from = "");

// SHA-256 (hex) of kind, counts, coordinates and indices, or the text of a polynomial: two shapes with the same hash are the same input.
std::string content_hash(const Shape& shape);

// The reason why this is not a valid shape: no points, a coordinate that is not finite, an index out of range, no
// triangles, a vertex of no triangle, an invalid surface (kernel/polynomial.h). Empty if it is valid. Vertices and triangles are numbered from 0. O(n).
std::string shape_problem(const Shape& shape);

}  // namespace hausbench
