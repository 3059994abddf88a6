// A file of the witness: the point of A, the point of B, and the line segment between them, for viewers.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <filesystem>

namespace hausbench {

// Throws InputError if the name does not end in .ply, .vtk or .obj, or if its folder cannot be written to.
void check_witness_place(const std::filesystem::path& file);

// Writes two vertices, first `on_a`, and an edge. As text; coordinates are read back with the same bits.
void write_witness(const std::filesystem::path& file, const Vec3& on_a, const Vec3& on_b);

}  // namespace hausbench
