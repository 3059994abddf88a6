// What the readers of VTK's legacy and XML files share: the types of numbers and of cells. Private to datasets/.
#pragma once

#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench::readers {

// The cell types of VTK that lists of the PolyData kind stand for.
enum class VtkType : std::int64_t { poly_vertex = 2, poly_line = 4, triangle_strip = 6, polygon = 7 };

// The bits of VTK's array vtkGhostType. VTK does not show cells with one of the first three.
struct VtkGhost {
    static constexpr std::int64_t duplicate_cell = 1, refined_cell = 8, hidden_cell = 32, hidden_point = 2;
};

// Returns the number that a word of a text array defines: rounded once, to float32 if that is the type of the array.
// Returns nothing if the word is not a number of this type.
std::optional<double> vtk_number(std::string_view word, Stored type);

// Returns a number as an integer. Values beyond 2^62 become 2^62, which is never a valid index, and NaN becomes 0.
std::int64_t vtk_integer(double value);

// A part of a VTK dataset: cells, whose corners index the points of the same part.
struct VtkPiece {
    std::string place;                      // begins messages: "" or "piece 2 (from 0): "
    std::size_t first_point = 0;            // in the soup
    std::vector<std::int64_t> ends;         // of cell i: one past its last corner in `corners`
    std::vector<std::int64_t> corners;      // of all cells
    std::vector<std::int64_t> types;        // of each cell
    std::vector<std::int64_t> cell_ghosts;  // VtkGhost of each cell; empty: none
    std::vector<std::int64_t> point_ghosts;

    // Appends cells of one type. Throws InputError if the ends decrease, or do not lead to the end of the corners.
    void append(const std::string& name, VtkType type, const std::vector<std::int64_t>& more_ends,
                const std::vector<std::int64_t>& more_corners);
};

// Turns cells into faces of a soup.
class VtkCells {
public:
    VtkCells(const std::string& name, Soup& soup) : name_(name), soup_(soup) {}

    // Adds the cells of a piece, whose points are the soup's from piece.first_point to the last. Leaves out volume cells
    // and ghost cells. Throws InputError for curved cells, cells of an unknown type, a wrong number of corners, indices
    // out of range and hidden points.
    void add(const VtkPiece& piece);

    // Adds notes about cells that were left out. Throws InputError if no cell is left, unless the dataset has none.
    void end();

private:
    void add_cell(const VtkPiece& piece, std::size_t cell, std::size_t begin, std::size_t end);
    std::size_t corner(const VtkPiece& piece, std::size_t cell, std::size_t at) const;
    [[noreturn]] void refuse_cell(const VtkPiece& piece, std::size_t cell, const std::string& why) const;

    const std::string& name_;
    Soup& soup_;
    std::int64_t cells_ = 0, ghosts_ = 0, short_ = 0, surface_ = 0;
    std::map<std::string_view, std::int64_t> volumes_;  // number of cells of each type
};

}  // namespace hausbench::readers
