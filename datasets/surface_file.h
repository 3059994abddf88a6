// Algebraic surfaces as text: files NAME.surface.toml, and models of recipe "surface" in the manifest.
//
//     polynomial = "x^2/4 + y^2/4 - z^2/9"     # the surface is the zero set; see kernel/polynomial.h
//     box = [[-2, 2], [-2, 2], [-2, 2]]        # the ranges of x, y and z
#pragma once

#include "algorithms/scene.h"
#include "datasets/toml_reader.h"

#include <filesystem>
#include <string>

namespace hausbench {

// Reads the keys `polynomial` and `box` of a table, and ignores others. Throws InputError for a missing key, an invalid
// polynomial (the message has the column), or a box that is not three pairs of numbers or has no volume.
AlgebraicSurface read_surface(const TomlReader& table);

// Reads a file NAME.surface.toml. Throws like read_surface(), and also for invalid TOML and for other keys.
AlgebraicSurface read_surface_file(const std::filesystem::path& file);

// Returns a description: "x^2 + y^2 - 1 = 0 in [-2, 2] x [-2, 2] x [-2, 2]".
std::string describe(const AlgebraicSurface& surface);

}  // namespace hausbench
