// Writes shapes as text files for other programs, with 17 digits, so that reading gives the same bits.
#pragma once

#include "algorithms/scene.h"

#include <filesystem>

namespace hausbench {

enum class MeshFormat { off, obj, ply };

// The format that the extension names, in any case. Throws InputError that lists the formats.
MeshFormat mesh_format_of(const std::filesystem::path& file);

// A point set is written as vertices without faces. The file is complete or absent: it is written to a temporary file and
// renamed. O(n). Throws InputError if it cannot be written.
void write_mesh_file(const std::filesystem::path& file, const Shape& shape, MeshFormat format);

}  // namespace hausbench
