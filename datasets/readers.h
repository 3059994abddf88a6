// What load_file() and its two readers share; private to datasets/.
#pragma once

#include "load.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace hausbench::readers {

// Faces of any number of corners over shared vertices, as a file holds them.
struct Soup {
    std::vector<Vec3> points;
    std::vector<std::vector<std::size_t>> faces;
    std::vector<std::uint32_t> point_lines, face_lines;  // of the file, from 1; empty for binary formats
    std::int64_t objects = 1;
};

// A file as CGAL's reader gets it: the same numbers, less what CGAL 5.5 stumbles over or lets pass.
struct Mended {
    std::string bytes;
    std::size_t points = 0, faces = 0;  // how many the reader must find
    std::int64_t objects = 1;
    std::vector<std::uint32_t> lines;                    // line of the file, from 1, of each line of `bytes`
    std::vector<std::uint32_t> point_lines, face_lines;  // as in Soup
};

// Each throws InputError that begins with `name`.
//   OBJ: only `v` and `f` statements are kept (CGAL refuses a file for an unknown one), faces without texture and
//     normal numbers (CGAL loses the corner after a tab); continued lines joined, UTF-16 read.
//   OFF: a header is put where there is none; colours, normals and textures are left out (CGAL reads beyond short
//     lines).
//   STL: binary by its size, not by the word "solid" (CGAL keeps points of a first try as text); letters of any case.
//   PLY: comments dropped, in text integer coordinates become double (CGAL would read through a null pointer).
Mended mend_obj(const std::string& name, std::string bytes);
Mended mend_off(const std::string& name, const std::string& bytes);
Mended mend_stl(const std::string& name, std::string bytes);
Mended mend_ply(const std::string& name, const std::string& bytes);  // mend_ply.cpp

// `format` is obj, off, stl or ply.
Soup read_with_cgal(const std::string& name, std::string bytes, const std::string& format);

// Triples of positions 0..n-1 in the polygon: a fan where it is convex, else by ear clipping in its mean plane. n >= 3.
std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Vec3>& corners);

// `format`: empty for the one that the file's extension names.
LoadedShape load_with_assimp(const std::filesystem::path& file, const std::string& format);

// Checks every number, drops faces of fewer than three corners and vertices of no face, makes triangles. `merge`: equal
// vertices (-0 = +0) become one first, for formats that repeat them.
LoadedShape finish(const std::string& name, Soup soup, LoadReport report, bool merge = false);

}  // namespace hausbench::readers
