// What the readers of file formats share: what they are given, and what they return. Private to datasets/.
//
// To add a format, write a file FORMAT.cpp in this folder that defines its reader, add the file to
// datasets/CMakeLists.txt, and add a row to the table in formats.cpp.
#pragma once

#include "datasets/load.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench::readers {

// What a reader is given.
struct Input {
    std::string name;            // of the file, to begin messages with
    std::string_view bytes;      // the whole file, inflated
    std::filesystem::path file;  // where it lies
    std::string format;          // its ending in lower case, such as "obj"
    LoadOptions options;

    // Returns the contents of another file that this one refers to, by a path relative to its folder. Throws InputError
    // if the path is absolute, contains "..", leads out of the folder through a link, is not a regular file, or if the
    // file is larger than `most` bytes.
    std::string beside(const std::string& path, std::uint64_t most = std::uint64_t{1} << 32) const;
};

// The contents of a file: points, and faces with any number of corners, which are indices into `points`. A face of two
// corners is a line segment, and a face of one corner a single point. Without faces, or if all of them have one corner,
// the file is a point set.
struct Soup {
    std::vector<Vec3> points;
    std::vector<std::vector<std::size_t>> faces;
    // The line of each point and face, from 1, for error messages; empty if the reader does not know it.
    std::vector<std::uint32_t> point_lines, face_lines;
    std::int64_t objects = 1;  // number of solids, groups or meshes
    bool float32 = false;      // some coordinates are stored as float32
    bool merge = false;        // the format repeats shared vertices: finish() merges vertices with equal coordinates
    bool unreferenced_unknown = false;  // the reader does not know which vertices of the file are not used
    std::string precision = "float64";  // of the reader
    Stated stated;                      // the unit and axes that the file states, or its format defines
    std::vector<std::string> notes;     // what the user should know, such as parts of the file that were left out
};

// Reads one format. Throws InputError, with messages that begin with the file's name. Coordinates may still be infinite
// or NaN, and indices out of range: finish() checks them.
using Read = Soup(const Input& input);

// Adds the point whose coordinates are the first three words of `line`, which has this line number. Throws InputError
// for fewer words, and for a word that is not a number.
void add_point(const std::string& name, std::string_view line, std::uint32_t number, Soup& soup);

// Splits a polygon with n >= 3 corners into n - 2 triangles, whose corners are indices into `corners`. A convex polygon
// becomes a fan; any other is split by ear clipping, as seen along its mean normal.
std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Vec3>& corners);

// A reader that needs a foreign library. The program defines it in foreign.cpp; the C library, which links none, has a
// definition that refuses (library/foreign.cpp).
LoadedShape read_surface(const std::filesystem::path& file);  // NAME.surface.toml

// Makes the shape from a soup: checks all coordinates and indices, splits polygons into triangles, turns segments and
// single points of a mesh into degenerate triangles, and drops unused vertices, which may have coordinates that are not
// finite. With options.drop_invalid, drops all points with such coordinates and the faces that use them. Throws
// InputError.
LoadedShape finish(const Input& input, Soup soup);

}  // namespace hausbench::readers
