// Writes shapes as text files for other programs. Coordinates have 17 digits, so reading them gives the same bits.
#pragma once

#include "algorithms/scene.h"

#include <filesystem>

namespace hausbench {

enum class MeshFormat { off, obj, ply };

// Returns the format for the extension of the file, in upper or lower case. Throws InputError, which lists the
// formats, for any other extension.
MeshFormat mesh_format_of(const std::filesystem::path& file);

// Writes a shape; a point set becomes vertices without faces. The file is complete or absent, because it is written
// under a temporary name and renamed. O(n). Throws InputError if it cannot be written or if the shape is an algebraic
// surface.
void write_mesh_file(const std::filesystem::path& file, const Shape& shape, MeshFormat format);

}  // namespace hausbench
