// Shared by load_file() and its readers; private to datasets/.
#pragma once

#include "load.h"

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
    std::vector<std::uint32_t> point_lines, face_lines;  // line numbers in the file, from 1; empty for binary formats
    std::int64_t objects = 1;
    bool float32 = false;  // a coordinate is stored in that precision
};

// A file as it is given to CGAL's reader: the same numbers, without what CGAL 5.5 rejects, misreads or fails to check.
struct Mended {
    std::string bytes;
    std::size_t points = 0, faces = 0;  // the counts that the reader must find
    std::int64_t objects = 1;
    std::vector<std::uint32_t> lines;  // for each line of `bytes`, its line number in the file, from 1
    std::vector<std::uint32_t> point_lines, face_lines;  // as in Soup
    bool float32 = false;                                // likewise
};

// Each throws InputError that begins with `name`.
//   OBJ: only `v` and `f` statements are kept (CGAL refuses a file for an unknown one), faces without texture and
//     normal numbers (CGAL loses a corner after a tab); continued lines are joined, UTF-16 is converted.
//   OFF: a missing header is added; colours, normals and textures are removed (CGAL reads past the end of short
//     lines).
//   STL: a file is binary if its size fits, whether or not it begins with "solid" (CGAL keeps points of a failed
//     attempt to read it as text); keywords in any case.
//   PLY: comments are dropped; integer coordinates in text become double (CGAL would dereference a null pointer).
Mended mend_obj(const std::string& name, std::string bytes);
Mended mend_off(const std::string& name, const std::string& bytes);
Mended mend_stl(const std::string& name, std::string bytes);
Mended mend_ply(const std::string& name, const std::string& bytes);  // mend_ply.cpp

// `format` is obj, off, stl or ply.
Soup read_with_cgal(const std::string& name, std::string bytes, const std::string& format);

// Point clouds, in double precision; `format` is xyz, pts or csv. What lines may hold: point_file.cpp.
Soup read_point_lines(const std::string& name, std::string_view bytes, const std::string& format);
Soup read_pcd(const std::string& name, std::string_view bytes);  // pcd_file.cpp

// Triples of positions 0..n-1 in the polygon: a fan where it is convex, else by ear clipping in its mean plane. n >= 3.
std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Vec3>& corners);

// `format`: empty to use the file's extension.
LoadedShape load_with_assimp(const std::filesystem::path& file, const std::string& format);

// Checks every number, drops faces of fewer than three corners and vertices without a face, splits faces into triangles.
// `merge`: first merges equal vertices (-0 = +0), for formats that repeat them.
LoadedShape finish(const std::string& name, Soup soup, LoadReport report, bool merge = false);

}  // namespace hausbench::readers
