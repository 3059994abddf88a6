// Writes and reads files of fields (solver.h): in the harness's own format, next to the journal of a run, and in PLY or
// VTK for other programs.
//
// The harness's format begins with one line of JSON: {"hausbench_fields": 1, "fields": [{"name", "of", "meaning",
// "count"}, ...]}. The values follow, one field after the other, as little-endian float64.
#pragma once

#include "harness/ask/fields.h"

#include <filesystem>
#include <optional>
#include <string>

namespace hausbench {

// Writes fields in the harness's own format, as a whole or not at all. Returns the SHA-256 of the file. Throws
// InputError if it cannot be written.
std::string write_fields(const std::filesystem::path& file, const Fields& fields);

// Reads fields in the harness's own format. Returns nothing if the file is missing or has another SHA-256.
std::optional<Fields> read_fields(const std::filesystem::path& file, const std::string& sha256);

// Throws InputError if the name ends in neither .ply nor .vtk, or if its folder cannot be written to.
void check_export_place(const std::filesystem::path& file);

// Returns the name of the file for the other direction, the fields of B: x.back.ply for x.ply.
std::filesystem::path file_of_way_back(const std::filesystem::path& file);

// Writes a drawn shape (fields.h) as PLY or VTK, by the extension, with the `distance` (double) and `nearest` (int) of
// each vertex. `solver_fields` holds the solver's own fields, which know no cuts: a piece gets the value of its
// triangle, and a vertex added by a cut gets NaN. The files are binary, so values keep their bits.
//
// PLY: only vertices have properties, because meshio misreads files with properties of faces. MeshLab colours by the
// property `quality`, CloudCompare by `scalar_distance`, both copies of the distance as float; other viewers by `red`,
// `green` and `blue`, from 0 to the largest distance. If A is a point set, the fields of its elements become properties of
// vertices.
//
// VTK (legacy format 3.0) is for ParaView, whose PLY reader drops unknown properties. All fields become scalars of
// points or of cells; `element` is the triangle of A that a piece belongs to.
void export_fields(const std::filesystem::path& file, const DrawnField& drawn, const Fields& solver_fields);

}  // namespace hausbench
