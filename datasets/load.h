// Reads meshes and point clouds from files of the formats in formats/formats.h into float64 shapes.
#pragma once

#include "algorithms/scene.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hausbench {

// How to read a file.
struct LoadOptions {
    std::string format = {};  // "obj", ...: the format, instead of the file's ending; empty: the ending counts
    std::string columns =
        {};  // of a text file of points: "2,3,4" or the names of the columns of x, y and z; empty: by their header
    bool drop_invalid = false;  // drops points with a coordinate that is not finite, and faces that use them
};

// The unit of length and the direction of the axes that a file states, or that its format defines.
struct Stated {
    std::string unit = {};   // "inch", as shown to users; empty: none
    double micrometres = 0;  // length of the unit; 0: none
    char up = 0;             // the axis that points up: 'X', 'Y' or 'Z'; 0: not stated
};

// How a shape was read or made.
struct LoadReport {
    std::string format;                 // "obj", "ply", "stl", "off", ...: the format it was read as
    std::string precision = "float64";  // of the reader; "float32" if it rounds coordinates
    bool float32 = false;               // some coordinates were rounded to float32, in the file or by the reader
    // Number of vertices that no face uses, which were dropped; empty if it is not known.
    std::optional<std::int64_t> unreferenced = 0;
    std::int64_t polygons = 0;        // faces of more than three corners, which were split into triangles
    std::int64_t objects = 1;         // solids, groups or meshes in the file, joined into one shape
    std::int64_t segments = 0;        // line segments of a mesh, which became degenerate triangles
    std::int64_t single_points = 0;   // single points of a mesh, which became degenerate triangles
    std::int64_t dropped_points = 0;  // by LoadOptions::drop_invalid
    std::int64_t dropped_faces = 0;   // faces that used such points
    Stated stated = {};
    std::vector<std::string> notes = {};  // what else the user should know, each one line
};

struct LoadedShape {
    Shape shape;
    LoadReport report;
};

// Returns whether a string is a path rather than the name of a model: it contains '/', or ends with the extension of a
// known format.
bool names_a_file(const std::string& text);

// Returns whether a file, by its ending, is a table of points, for which LoadOptions::columns may be set.
bool has_columns(const std::filesystem::path& file);

// Reads a shape from a file of a format in formats/formats.h, gzipped or not. The coordinates are the numbers that the
// file defines: nothing is turned, scaled or left out without a line in `notes`. A file with vertices and no faces
// becomes a point set; NAME.surface.toml is an algebraic surface (surface_file.h).
//
// Throws InputError for a missing, empty or unparsable file, no vertices, a NaN or infinite coordinate, an index out of
// range, and a part of the format that is not supported. The message is one line: the file, the line or vertex with the
// error, and often a hint. A damaged or malicious file may still crash the reader of a foreign library;
// load_separately() in separate_process.h protects against that.
LoadedShape load_file(const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace hausbench
