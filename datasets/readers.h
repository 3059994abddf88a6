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

// The contents of a file: faces of any number of corners over shared vertices.
struct Soup {
    std::vector<Vec3> points;
    std::vector<std::vector<std::size_t>> faces;
    // Line numbers in the file, from 1; empty for binary formats.
    std::vector<std::uint32_t> point_lines, face_lines;
    std::int64_t objects = 1;
    bool float32 = false;  // a coordinate is stored as float32
};

// Adds the point given by the first three words of a line. Throws InputError for fewer words, and
// for a word that is not a number.
void add_point(const std::string& name, std::string_view line, std::uint32_t number, Soup& soup);

// Read one format each; finish() then checks the soup. `name` begins every message of the
// InputErrors that they throw. Each is in the file named after it.
Soup read_obj(const std::string& name, std::string_view bytes);
Soup read_off(const std::string& name, std::string_view bytes);
Soup read_stl(const std::string& name, std::string_view bytes);  // repeats equal points
Soup read_ply(const std::string& name, std::string_view bytes);
Soup read_vrml(const std::string& name, std::string_view bytes);  // repeats equal points
Soup read_pcd(const std::string& name, std::string_view bytes);
Soup read_xyz(const std::string& name, std::string_view bytes);  // .pts too; point_file.cpp
Soup read_csv(const std::string& name, std::string_view bytes);  // point_file.cpp

// Returns triples of positions 0..n-1 in the polygon: a fan if it is convex, else by ear clipping
// in its mean plane. n >= 3.
std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Vec3>& corners);

// An empty `format` means the file's extension.
LoadedShape load_with_assimp(const std::filesystem::path& file, const std::string& format);

// Checks every number, drops faces with fewer than three corners and unused vertices, and splits
// faces into triangles. `merge` first merges equal vertices (-0 = +0), for formats that repeat them.
LoadedShape finish(const std::string& name, Soup soup, LoadReport report, bool merge = false);

}  // namespace hausbench::readers
