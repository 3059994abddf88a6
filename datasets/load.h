// Reads mesh and point files of any common format into float64 shapes.
#pragma once

#include "algorithms/scene.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace hausbench {

struct LoadReport {
    std::string format;                 // "obj", "ply", "stl", "off", ... as read
    std::string precision = "float64";  // "float32" if the reader rounds to it (assimp)
    bool float32 = false;               // the file or its reader rounds coordinates to float32
    // Number of dropped vertices; empty: unknown, because the reader drops them.
    std::optional<std::int64_t> unreferenced = 0;
    std::int64_t polygons = 0;  // faces of more than three corners, which were split into triangles
    std::int64_t objects = 1;   // solids, groups or meshes in the file, joined into one soup
};

struct LoadedShape {
    Shape shape;
    LoadReport report;
};

// Returns whether a string is a path rather than a name: it contains '/', or has the extension of
// a format that is read.
bool names_a_file(const std::string& text);

// Reads OBJ, PLY, STL, OFF, VRML and point clouds (XYZ, PTS, CSV, PCD) in float64, gzipped or not; everything else
// through assimp. A file with vertices and no faces is a point set; NAME.surface.toml is an algebraic surface
// (surface_file.h). `format` ("obj", ...) overrides the file's extension. Throws InputError, one line with the file,
// the place and the remedy, for a missing, empty or unparsable file, no vertices, a NaN or infinite coordinate
// (names the vertex), or an index out of range. A hostile file may still crash the reader: see separate_process.h.
LoadedShape load_file(const std::filesystem::path& file, const std::string& format = "");

}  // namespace hausbench
