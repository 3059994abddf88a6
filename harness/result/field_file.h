// Fields in files: of a run beside its journal, and for other programs as PLY or VTK.
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

// Throws InputError where the name ends in neither .ply nor .vtk, or its folder is no place to write.
void check_export_place(const std::filesystem::path& file);

// A where it stands with its fields, as PLY or VTK by the extension: doubles, and `nearest` as int. Binary, so that values keep
// their bits and infinity can be told.
//
// PLY: properties of vertices and faces. MeshLab colours by a property that it knows as `quality`: that is the distance once more.
// A point is a vertex: fields of a point set's elements are properties of them.
//
// VTK, legacy 3.0, for ParaView, whose PLY reader leaves such properties out: scalars of points and cells. The data set is an
// unstructured grid of triangles, or of vertices where A is a point set.
void export_fields(const std::filesystem::path& file, const Shape& shape, const Points& posed, const Fields& fields);

}  // namespace hausbench
