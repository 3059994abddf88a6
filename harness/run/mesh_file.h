// Writes shapes as text files for other programs. Writes 17 digits so that coordinates round-trip exactly.
#pragma once

#include "algorithms/scene.h"

#include <filesystem>

namespace hausbench {

enum class MeshFormat { off, obj, ply };

// Returns the format for the file's extension, in upper or lower case. Throws InputError for an unknown extension.
MeshFormat mesh_format_of(const std::filesystem::path& file);

// Writes a mesh, or a point set as vertices without faces. Writes under a temporary name and then renames the file, so
// that an incomplete file never has this name. Throws InputError if the file cannot be written, or if the shape is an
// algebraic surface.
void write_mesh_file(const std::filesystem::path& file, const Shape& shape, MeshFormat format);

}  // namespace hausbench
