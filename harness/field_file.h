// Fields in files: of a run beside its journal, and for other programs as PLY.
//
// Of a run: one line of JSON, {"hausbench_fields": 1, "fields": [{"name", "of", "meaning", "count"}, ...]}, then the values of all
// fields one after the other, float64, little-endian.
#pragma once

#include "fields.h"

#include <filesystem>
#include <optional>
#include <string>

namespace hausbench {

// Whole or not at all. Returns the SHA-256 of the file; throws InputError where it cannot be written.
std::string write_fields(const std::filesystem::path& file, const Fields& fields);

// None where the file is missing, or is not the one with this SHA-256.
std::optional<Fields> read_fields(const std::filesystem::path& file, const std::string& sha256);

// Throws InputError where the name does not end in .ply, or its folder is no place to write.
void check_ply_place(const std::filesystem::path& file);

// A where it stands, its fields as properties of its vertices and faces: doubles, and `nearest` as int. MeshLab colours by a
// property that it knows as `quality`: that is the distance once more. Binary, so that infinity can be told. A point is a vertex:
// fields of a point set's elements are properties of them.
void write_fields_ply(const std::filesystem::path& file, const Shape& shape, const Points& posed, const Fields& fields);

}  // namespace hausbench
