// Reads shapes named on the command line.
#pragma once

#include "datasets/load.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>

namespace hausbench {

// How a verb reads and places its shapes.
struct ShapeOptions {
    std::string columns;        // LoadOptions::columns
    bool drop_invalid = false;  // LoadOptions::drop_invalid
    std::string unit;           // converts to this unit; "none": forgets what the file states; empty: keeps it
    std::string up;  // 'X', 'Y' or 'Z': turns the shape so that this axis points up; "none" and empty likewise

    bool any() const { return !columns.empty() || drop_invalid || !unit.empty() || !up.empty(); }
};

// Adds --columns, --drop-invalid, --unit and --up.
void take_shape_options(CLI::App* verb, ShapeOptions& options);

// Reads a mesh file, or a model of the project by its name, such as "bunny". A name with a '/' or an extension always
// means a file. Then converts the shape to the unit and the axes of the options. Throws InputError for a model that was
// not fetched, for an unknown name, and for an algebraic surface that would have to be converted.
LoadedShape load_named(const std::string& name, const ShapeOptions& options = {});

// Returns what reading a shape rounded, dropped or made, such as ", 3 line segments"; empty if nothing.
std::string reading_text(const LoadReport& report);

// Moves a shape by the 4 x 4 matrix in a text file, whose last row is 0 0 0 1: a vertex p becomes
// ((m0 x + m1 y) + m2 z) + m3 and so on, rounded after each operation. Throws InputError if the file is not such a
// matrix, if the shape is an algebraic surface, and if a coordinate overflows.
void transform(LoadedShape& loaded, const std::filesystem::path& matrix);

// Returns the file that load_named() reads for this name. For a derived model, returns the file of the model from which
// it is derived. Returns an empty path if the model has no file, such as a generated model.
std::filesystem::path file_behind(const std::string& name);

}  // namespace hausbench
