// Writes shapes as other programs read them: text, 17 digits, so that reading gives back the same bits.
#pragma once

#include "scene.h"

#include <filesystem>

namespace hausbench {

enum class MeshFormat { off, obj, ply };

// By extension, in letters of any case. Throws InputError that names the formats.
MeshFormat mesh_format_of(const std::filesystem::path& file);

// Point sets are vertices without faces. Whole or not at all: by a temporary file beside it and rename. O(n). Throws
// InputError where it cannot be written.
void write_mesh_file(const std::filesystem::path& file, const Shape& shape, MeshFormat format);

}  // namespace hausbench
