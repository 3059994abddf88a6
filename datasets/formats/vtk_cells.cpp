#include "datasets/formats/vtk_cells.h"

#include "algorithms/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hausbench::readers {
namespace {

// How a cell becomes faces.
enum class Kind { empty, points, lines, strip, polygon, pixel, volume, curved };

struct CellType {
    std::int64_t number;
    std::string_view name;  // of VTK, without VTK_
    Kind kind;
    std::size_t corners = 0;  // their number; 0: any
};

constexpr std::array cell_types = std::to_array<CellType>({
    {0, "EMPTY_CELL", Kind::empty},
    {1, "VERTEX", Kind::points, 1},
    {2, "POLY_VERTEX", Kind::points},
    {3, "LINE", Kind::lines, 2},
    {4, "POLY_LINE", Kind::lines},
    {5, "TRIANGLE", Kind::polygon, 3},
    {6, "TRIANGLE_STRIP", Kind::strip},
    {7, "POLYGON", Kind::polygon},
    {8, "PIXEL", Kind::pixel, 4},
    {9, "QUAD", Kind::polygon, 4},
    {10, "TETRA", Kind::volume},
    {11, "VOXEL", Kind::volume},
    {12, "HEXAHEDRON", Kind::volume},
    {13, "WEDGE", Kind::volume},
    {14, "PYRAMID", Kind::volume},
    {15, "PENTAGONAL_PRISM", Kind::volume},
    {16, "HEXAGONAL_PRISM", Kind::volume},
    {21, "QUADRATIC_EDGE", Kind::curved},
    {22, "QUADRATIC_TRIANGLE", Kind::curved},
    {23, "QUADRATIC_QUAD", Kind::curved},
    {24, "QUADRATIC_TETRA", Kind::volume},
    {25, "QUADRATIC_HEXAHEDRON", Kind::volume},
    {26, "QUADRATIC_WEDGE", Kind::volume},
    {27, "QUADRATIC_PYRAMID", Kind::volume},
    {28, "BIQUADRATIC_QUAD", Kind::curved},
    {29, "TRIQUADRATIC_HEXAHEDRON", Kind::volume},
    {30, "QUADRATIC_LINEAR_QUAD", Kind::curved},
    {31, "QUADRATIC_LINEAR_WEDGE", Kind::volume},
    {32, "BIQUADRATIC_QUADRATIC_WEDGE", Kind::volume},
    {33, "BIQUADRATIC_QUADRATIC_HEXAHEDRON", Kind::volume},
    {34, "BIQUADRATIC_TRIANGLE", Kind::curved},
    {35, "CUBIC_LINE", Kind::curved},
    {36, "QUADRATIC_POLYGON", Kind::curved},
    {37, "TRIQUADRATIC_PYRAMID", Kind::volume},
    {41, "CONVEX_POINT_SET", Kind::volume},
    {42, "POLYHEDRON", Kind::volume},
    {51, "PARAMETRIC_CURVE", Kind::curved},
    {52, "PARAMETRIC_SURFACE", Kind::curved},
    {53, "PARAMETRIC_TRI_SURFACE", Kind::curved},
    {54, "PARAMETRIC_QUAD_SURFACE", Kind::curved},
    {55, "PARAMETRIC_TETRA_REGION", Kind::volume},
    {56, "PARAMETRIC_HEX_REGION", Kind::volume},
    {60, "HIGHER_ORDER_EDGE", Kind::curved},
    {61, "HIGHER_ORDER_TRIANGLE", Kind::curved},
    {62, "HIGHER_ORDER_QUAD", Kind::curved},
    {63, "HIGHER_ORDER_POLYGON", Kind::curved},
    {64, "HIGHER_ORDER_TETRAHEDRON", Kind::volume},
    {65, "HIGHER_ORDER_WEDGE", Kind::volume},
    {66, "HIGHER_ORDER_PYRAMID", Kind::volume},
    {67, "HIGHER_ORDER_HEXAHEDRON", Kind::volume},
    {68, "LAGRANGE_CURVE", Kind::curved},
    {69, "LAGRANGE_TRIANGLE", Kind::curved},
    {70, "LAGRANGE_QUADRILATERAL", Kind::curved},
    {71, "LAGRANGE_TETRAHEDRON", Kind::volume},
    {72, "LAGRANGE_HEXAHEDRON", Kind::volume},
    {73, "LAGRANGE_WEDGE", Kind::volume},
    {74, "LAGRANGE_PYRAMID", Kind::volume},
    {75, "BEZIER_CURVE", Kind::curved},
    {76, "BEZIER_TRIANGLE", Kind::curved},
    {77, "BEZIER_QUADRILATERAL", Kind::curved},
    {78, "BEZIER_TETRAHEDRON", Kind::volume},
    {79, "BEZIER_HEXAHEDRON", Kind::volume},
    {80, "BEZIER_WEDGE", Kind::volume},
    {81, "BEZIER_PYRAMID", Kind::volume},
});

// Returns the least number of corners with which a cell of this kind is not degenerate.
std::size_t least_corners(Kind kind) { return kind == Kind::points ? 1 : kind == Kind::lines ? 2 : 3; }

}  // namespace

std::optional<double> vtk_number(std::string_view word, Stored type) {
    if (type.is_float32()) return decimal<float>(word);
    if (type.kind == 'F') return decimal(word);
    const auto fitting = [&](auto value) -> std::optional<double> {
        if (!value || (type.size < 8 && !type.holds(static_cast<double>(*value)))) return std::nullopt;
        return static_cast<double>(*value);
    };
    return type.kind == 'U' ? fitting(whole<std::uint64_t>(word)) : fitting(whole<std::int64_t>(word));
}

std::int64_t vtk_integer(double value) {
    return std::isnan(value) ? 0 : static_cast<std::int64_t>(std::clamp(value, -0x1p62, 0x1p62));
}

void VtkPiece::append(const std::string& name, VtkType type, const std::vector<std::int64_t>& more_ends,
                      const std::vector<std::int64_t>& more_corners) {
    std::int64_t last = 0;
    const auto before = static_cast<std::int64_t>(corners.size());
    for (std::size_t i = 0; i < more_ends.size(); ++i) {
        const std::int64_t next = more_ends[i];
        if (next < last || next > static_cast<std::int64_t>(more_corners.size()))
            throw InputError(
                fmt::format("{}: {}the offsets of its cells are damaged: cell {} (from 0 in its list) begins at {} and "
                            "ends at {} of "
                            "{} corners",
                            name, place, i, last, next, more_corners.size()));
        ends.push_back(before + next);
        last = next;
    }
    if (last != static_cast<std::int64_t>(more_corners.size()))
        throw InputError(
            fmt::format("{}: {}the offsets of its cells are damaged: the cells have {} corners, but {} are "
                        "listed",
                        name, place, last, more_corners.size()));
    corners.insert(corners.end(), more_corners.begin(), more_corners.end());
    types.insert(types.end(), more_ends.size(), static_cast<std::int64_t>(type));
}

void VtkCells::refuse_cell(const VtkPiece& piece, std::size_t cell, const std::string& why) const {
    throw InputError(fmt::format("{}: {}cell {} (from 0) {}", name_, piece.place, cell, why));
}

void VtkCells::add(const VtkPiece& piece) {
    std::size_t begin = 0;
    for (std::size_t cell = 0; cell < piece.ends.size(); ++cell) {
        const auto end = static_cast<std::size_t>(piece.ends[cell]);
        add_cell(piece, cell, begin, end);
        begin = end;
    }
    cells_ += static_cast<std::int64_t>(piece.ends.size());
}

std::size_t VtkCells::corner(const VtkPiece& piece, std::size_t cell, std::size_t at) const {
    const std::size_t points = soup_.points.size() - piece.first_point;
    const std::int64_t v = piece.corners[at];
    if (v < 0 || static_cast<std::uint64_t>(v) >= points)
        refuse_cell(piece, cell, fmt::format("names point {} (from 0), but there are {}", v, points));
    const auto point = static_cast<std::size_t>(v);
    if (point < piece.point_ghosts.size() && (piece.point_ghosts[point] & VtkGhost::hidden_point) != 0)
        refuse_cell(piece, cell,
                    fmt::format("uses point {} (from 0), which the array vtkGhostType hides: such cells are not "
                                "supported: extract the surface with Extract Surface in ParaView, and save that",
                                point));
    return piece.first_point + point;
}

void VtkCells::add_cell(const VtkPiece& piece, std::size_t cell, std::size_t begin, std::size_t end) {
    constexpr std::int64_t not_shown = VtkGhost::duplicate_cell | VtkGhost::refined_cell | VtkGhost::hidden_cell;
    if (cell < piece.cell_ghosts.size() && (piece.cell_ghosts[cell] & not_shown) != 0) {
        ++ghosts_;
        return;
    }
    const std::int64_t number = piece.types[cell];
    const auto type = std::find_if(cell_types.begin(), cell_types.end(),
                                   [&](const CellType& entry) { return entry.number == number; });
    if (type == cell_types.end())
        refuse_cell(
            piece, cell,
            fmt::format("has the unknown type {}: convert it to polygons, in ParaView with Extract Surface", number));
    if (type->kind == Kind::curved)
        refuse_cell(
            piece, cell,
            fmt::format("is a VTK_{}, which is curved: only straight lines and flat surfaces are read: in "
                        "ParaView apply Extract Surface, which splits such cells (Nonlinear Subdivision Level), "
                        "and save that",
                        type->name));
    if (type->kind == Kind::volume) ++volumes_[type->name];
    if (type->kind == Kind::volume || type->kind == Kind::empty) return;
    const std::size_t size = end - begin;
    if (type->corners != 0 && size != type->corners)
        refuse_cell(piece, cell,
                    fmt::format("is a VTK_{} with {} corners instead of {}", type->name, size, type->corners));
    std::vector<std::size_t> corners;
    for (std::size_t at = begin; at < end; ++at) corners.push_back(corner(piece, cell, at));
    if (size < least_corners(type->kind)) ++short_;
    surface_ += size >= 3 && type->kind != Kind::points && type->kind != Kind::lines ? 1 : 0;
    auto& faces = soup_.faces;
    if (type->kind == Kind::pixel) std::swap(corners[2], corners[3]);
    if (type->kind == Kind::points)
        for (const std::size_t v : corners) faces.push_back({v});
    else if (type->kind == Kind::lines && size > 2)
        for (std::size_t i = 0; i + 1 < size; ++i) faces.push_back({corners[i], corners[i + 1]});
    else if (type->kind == Kind::strip && size > 3)
        for (std::size_t i = 0; i + 2 < size; ++i)
            faces.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    else if (size > 0)
        faces.push_back(std::move(corners));
}

void VtkCells::end() {
    std::int64_t volumes = 0;
    std::string names;
    for (const auto& [name, count] : volumes_) {
        volumes += count;
        names += fmt::format("{}{} VTK_{}", names.empty() ? "" : ", ", count, name);
    }
    if (volumes > 0 && surface_ == 0)
        throw InputError(
            fmt::format("{}: has volume cells ({}) and no surface: extract its surface, in ParaView with "
                        "Extract Surface, and save that",
                        name_, names));
    if (volumes > 0)
        soup_.notes.push_back(
            fmt::format("{} volume {} left out ({}): only the points, lines and surfaces of the file "
                        "are measured",
                        volumes, volumes == 1 ? "cell was" : "cells were", names));
    if (ghosts_ > 0)
        soup_.notes.push_back(
            fmt::format("{} {} left out, which the array vtkGhostType marks as duplicate, refined or "
                        "hidden: VTK does not show them",
                        ghosts_, ghosts_ == 1 ? "cell was" : "cells were"));
    if (short_ > 0)
        soup_.notes.push_back(
            fmt::format("{} {} fewer corners than the type needs: such a cell counts as a segment or a "
                        "single point, and without corners as nothing",
                        short_, short_ == 1 ? "cell has" : "cells have"));
    if (!soup_.faces.empty()) return;
    if (cells_ > 0)
        throw InputError(name_ +
                         ": none of its cells is a point, a line or a surface: extract the surface in ParaView "
                         "with Extract Surface, and save that");
    if (!soup_.points.empty()) soup_.notes.push_back("has points and no cells: all points are read as a point set");
}

}  // namespace hausbench::readers
