// Reads meshes and point clouds from files of any common format into float64 shapes.
#pragma once

#include "algorithms/scene.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace hausbench {

// How a shape was read or made.
struct LoadReport {
    std::string format;                 // "obj", "ply", "stl", "off", ...: the format it was read as
    std::string precision = "float64";  // of the reader; "float32" for assimp, which rounds coordinates
    bool float32 = false;               // some coordinates were rounded to float32, in the file or by the reader
    // Number of vertices that no face uses, which were dropped; empty if it is not known.
    std::optional<std::int64_t> unreferenced = 0;
    std::int64_t polygons = 0;  // faces of more than three corners, which were split into triangles
    std::int64_t objects = 1;   // solids, groups or meshes in the file, joined into one shape
};

struct LoadedShape {
    Shape shape;
    LoadReport report;
};

// Returns whether a string is a path rather than the name of a model: it contains '/', or ends with the extension of a
// known format.
bool names_a_file(const std::string& text);

// Reads a shape from a file: OBJ, PLY, STL, OFF, VRML and point clouds (XYZ, PTS, CSV, PCD) in float64, gzipped or not,
// and other formats through assimp, in float32. A file with vertices and no faces becomes a point set;
// NAME.surface.toml is an algebraic surface (surface_file.h). `format` ("obj", ...) overrides the file's extension.
//
// Throws InputError for a missing, empty or unparsable file, no vertices, a NaN or infinite coordinate, or an index out
// of range. The message is one line: the file, the line or vertex with the error, and often a hint. A damaged or
// malicious file may still crash the reader; load_separately() in separate_process.h protects against that.
LoadedShape load_file(const std::filesystem::path& file, const std::string& format = "");

}  // namespace hausbench
