// Declares the reader of each format, which load_file() calls; private to datasets/.
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

// The contents of a file: points, and faces with any number of corners, which are indices into `points`. Without faces
// it is a point cloud.
struct Soup {
    std::vector<Vec3> points;
    std::vector<std::vector<std::size_t>> faces;
    // The line of each point and face, from 1, for error messages; empty if the reader does not know it.
    std::vector<std::uint32_t> point_lines, face_lines;
    std::int64_t objects = 1;  // number of solids, groups or meshes
    bool float32 = false;      // some coordinates are stored as float32
};

// Adds the point whose coordinates are the first three words of `line`, which has this line number. Throws InputError
// for fewer words, and for a word that is not a number.
void add_point(const std::string& name, std::string_view line, std::uint32_t number, Soup& soup);

// Each function reads one format and is in the file of the same name: read_obj() in obj_file.cpp. They throw
// InputError, with messages that begin with `name`, the name of the file. Coordinates may still be infinite or NaN, and
// indices out of range: finish() checks them.
Soup read_obj(const std::string& name, std::string_view bytes);
Soup read_off(const std::string& name, std::string_view bytes);
Soup read_stl(const std::string& name, std::string_view bytes);  // repeats a point for each of its triangles
Soup read_ply(const std::string& name, std::string_view bytes);
Soup read_vrml(const std::string& name, std::string_view bytes);  // repeats points that several shapes share
Soup read_pcd(const std::string& name, std::string_view bytes);
Soup read_xyz(const std::string& name, std::string_view bytes);  // also .pts; in point_file.cpp
Soup read_csv(const std::string& name, std::string_view bytes);  // in point_file.cpp

// Splits a polygon with n >= 3 corners into n - 2 triangles, whose corners are indices into `corners`. A convex polygon
// becomes a fan; any other is split by ear clipping, as seen along its mean normal.
std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Vec3>& corners);

// Reads a file through the library assimp, in single precision. `format` ("3ds", ...) overrides the file's extension;
// empty: the extension counts.
LoadedShape load_with_assimp(const std::filesystem::path& file, const std::string& format);

// Returns the version of assimp, as in 5.2.5.
std::string assimp_version();

// Reads a file that none of the functions above reads: a surface if `format` is "surface", else through assimp. The
// program defines it in load_foreign.cpp. The C library has a definition of its own, which refuses every file, because
// it links neither assimp nor a reader of TOML.
LoadedShape load_foreign(const std::filesystem::path& file, const std::string& format);

// Makes the shape from a soup: checks all coordinates and indices, drops faces with fewer than three corners, splits
// the other faces into triangles, and drops unused vertices. A soup without faces becomes a point set. `merge` is for
// formats that repeat shared vertices: vertices with equal coordinates (-0 equals +0) are merged before unused ones are
// dropped. Returns the shape with `report`, in which it fills in the numbers that it knows. Throws InputError.
LoadedShape finish(const std::string& name, Soup soup, LoadReport report, bool merge = false);

}  // namespace hausbench::readers
