#include "datasets/formats/cells.h"

#include "algorithms/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace hausbench::readers {
namespace {

using Face = std::vector<std::size_t>;
using Side = std::pair<std::size_t, std::size_t>;

Side side(std::size_t a, std::size_t b) { return {std::min(a, b), std::max(a, b)}; }

// Returns the sides of all polygons, sorted.
std::vector<Side> sides_of(const std::vector<Face>& faces) {
    std::vector<Side> sides;
    for (const Face& face : faces)
        for (std::size_t i = 0; face.size() > 2 && i < face.size(); ++i)
            sides.push_back(side(face[i], face[(i + 1) % face.size()]));
    std::sort(sides.begin(), sides.end());
    return sides;
}

std::string listed(const VolumeCells& volumes) {
    static const std::map<std::size_t, std::string_view> kinds = {
        {4, "tetrahedra"}, {5, "pyramids"}, {6, "prisms"}, {8, "hexahedra"}};
    std::string text;
    for (const auto& [size, corners] : volumes)
        if (!corners.empty())
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", corners.size() / size, kinds.at(size));
    return text;
}

// The corners of a triangle or quadrilateral, sorted; a triangle has the greatest number as fourth.
using Key = std::array<std::uint32_t, 4>;

// Returns the key of the face that has the corners `at(0)` to `at(3)`, or to `at(2)` for a triangle.
template <class Corner> Key key_of(bool triangle, const Corner& at) {
    Key key;
    for (std::size_t k = 0; k < 4; ++k)
        key[k] = triangle && k == 3 ? ~std::uint32_t{0} : static_cast<std::uint32_t>(at(k));
    std::sort(key.begin(), key.end());
    return key;
}

// Returns the faces of a volume cell, given by the places of their corners in the cell. -1: a triangle.
const std::vector<std::array<int, 4>>& faces_of_cell(std::size_t corners) {
    static const std::map<std::size_t, std::vector<std::array<int, 4>>> all = {
        {4, {{0, 1, 2, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 2, 3, -1}}},
        {5, {{0, 1, 2, 3}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}},
        {6, {{0, 1, 2, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
        {8, {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}}};
    return all.at(corners);
}

// Returns the keys of the faces of all volume cells, sorted.
std::vector<Key> faces_of_cells(const VolumeCells& volumes) {
    std::vector<Key> keys;
    for (const auto& [size, corners] : volumes)
        for (const std::size_t* cell = corners.data(); cell != corners.data() + corners.size(); cell += size)
            for (const auto& face : faces_of_cell(size))
                keys.push_back(key_of(face[3] < 0, [&](std::size_t k) { return cell[face[k]]; }));
    std::sort(keys.begin(), keys.end());
    return keys;
}

// Adds notes if the surface cells are not exactly the outside of the volume cells.
void compare(const VolumeCells& volumes, Soup& soup) {
    std::vector<Key> surface;
    for (const Face& face : soup.faces)
        if (face.size() == 3 || face.size() == 4)
            surface.push_back(key_of(face.size() == 3, [&](std::size_t k) { return face[k]; }));
    std::sort(surface.begin(), surface.end());
    surface.erase(std::unique(surface.begin(), surface.end()), surface.end());
    std::size_t inside = 0, missing = 0;
    const std::vector<Key> solid = faces_of_cells(volumes);
    for (auto at = solid.begin(); at != solid.end();) {
        const auto end = std::find_if(at, solid.end(), [&](const Key& key) { return key != *at; });
        const bool measured = std::binary_search(surface.begin(), surface.end(), *at);
        inside += measured && end - at > 1 ? 1 : 0;
        missing += !measured && end - at == 1 ? 1 : 0;
        at = end;
    }
    if (inside > 0)
        soup.notes.push_back(
            fmt::format("surface cells that lie inside the solid, between two volume cells, are measured too ({}): "
                        "remove them if only the outside counts",
                        inside));
    if (missing > 0)
        soup.notes.push_back(
            fmt::format("the surface cells are only a part of the outside of the solid: they lack {} outer faces of "
                        "the volume cells",
                        missing));
}

// Removes the faces that a test selects.
template <class Test> void drop(Soup& soup, const Test& test) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < soup.faces.size(); ++i) {
        if (test(soup.faces[i])) continue;
        if (kept != i) {
            soup.faces[kept] = std::move(soup.faces[i]);
            if (i < soup.face_lines.size()) soup.face_lines[kept] = soup.face_lines[i];
        }
        ++kept;
    }
    soup.faces.resize(kept);
    if (kept < soup.face_lines.size()) soup.face_lines.resize(kept);
}

// Removes the points, with a note about those that no other face has as a corner.
void drop_points(Soup& soup) {
    std::vector<bool> corner(soup.points.size(), false);
    for (const Face& face : soup.faces)
        for (const std::size_t v : face) corner[v] = corner[v] || face.size() > 1;
    std::size_t alone = 0;
    drop(soup, [&](const Face& face) {
        alone += face.size() == 1 && !corner[face[0]] ? 1 : 0;
        return face.size() == 1;
    });
    if (alone > 0)
        soup.notes.push_back(fmt::format(
            "points that belong to no line or surface cell, such as the centres of arcs, are left out ({})", alone));
}

}  // namespace

void keep_surface(const std::string& name, const VolumeCells& volumes, std::string_view remedy, Soup& soup) {
    const auto has = [&](auto test) { return std::any_of(soup.faces.begin(), soup.faces.end(), test); };
    const std::string solids = listed(volumes);
    if (!solids.empty()) {
        if (!has([](const Face& face) { return face.size() > 2; }))
            throw InputError(fmt::format("{}: has volume cells ({}) and no surface cells, such as triangles: {}", name,
                                         solids, remedy));
        soup.notes.push_back(
            fmt::format("the volume cells of the file ({}) are left out: only its surface cells are measured", solids));
        compare(volumes, soup);
    }
    const bool polygons = has([](const Face& face) { return face.size() > 2; });
    if (polygons && has([](const Face& face) { return face.size() == 2; })) {
        const std::vector<Side> sides = sides_of(soup.faces);
        drop(soup, [&](const Face& face) {
            return face.size() == 2 && std::binary_search(sides.begin(), sides.end(), side(face[0], face[1]));
        });
        const auto lines =
            std::count_if(soup.faces.begin(), soup.faces.end(), [](const Face& face) { return face.size() == 2; });
        if (lines > 0)
            soup.notes.push_back(
                fmt::format("segments that are a side of no surface cell are measured too ({})", lines));
    }
    if (has([](const Face& face) { return face.size() > 1; })) drop_points(soup);
}

}  // namespace hausbench::readers
