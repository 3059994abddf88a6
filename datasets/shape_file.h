// Files of shapes in the cache: HDF5 with float64 coordinates and int32 indices. Reading a file returns exactly the
// bits that were written.
#pragma once

#include "datasets/hash.h"
#include "datasets/load.h"

#include <filesystem>
#include <string>

namespace hausbench {

// Writes a complete file or none. `made_from` is a key that identifies everything the shape was made from, such as a
// hash of the recipe and of the bytes of the input file; empty: unknown. Throws InputError if the file cannot be
// written.
void write_shape(const std::filesystem::path& file, const LoadedShape& shape, const std::string& made_from = "");

// Reads a file of write_shape(). Throws InputError if that is not possible, if the shape is invalid, or if the file was
// written with another `made_from`; an empty `made_from` is not compared.
LoadedShape read_shape(const std::filesystem::path& file, const std::string& made_from = "");

// Returns the reason why a shape is invalid: no points, a coordinate that is not finite, an index
// out of range, no triangles, a vertex without a triangle, an invalid surface
// (kernel/polynomial.h). Empty if it is valid. Vertices and triangles are numbered from 0. O(n).
std::string shape_problem(const Shape& shape);

}  // namespace hausbench
