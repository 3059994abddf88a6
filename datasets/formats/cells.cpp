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

// Returns the corners of all polygons and segments, sorted.
std::vector<std::size_t> corners_of(const std::vector<Face>& faces) {
    std::vector<std::size_t> corners;
    for (const Face& face : faces)
        if (face.size() > 1) corners.insert(corners.end(), face.begin(), face.end());
    std::sort(corners.begin(), corners.end());
    return corners;
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
        for (std::size_t cell = 0; cell + size <= corners.size(); cell += size)
            for (const auto& face : faces_of_cell(size))
                keys.push_back(key_of(face[3] < 0, [&, first = cell](std::size_t k) {
                    return corners[first + static_cast<std::size_t>(face[k])];
                }));
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
            fmt::format("{} of the surface cells lie inside the solid, between two volume cells, and are measured too: "
                        "remove them if only the outside counts",
                        inside));
    if (missing > 0)
        soup.notes.push_back(fmt::format(
            "{} outer faces of the volume cells are not among the surface cells: the outside of the solid is measured "
            "only in part",
            missing));
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
    if (!has([](const Face& face) { return face.size() < 3; })) return;
    const std::vector<Side> sides = sides_of(soup.faces);
    const std::vector<std::size_t> corners = corners_of(soup.faces);
    const auto redundant = [&](const Face& face) {
        if (face.size() == 2) return std::binary_search(sides.begin(), sides.end(), side(face[0], face[1]));
        return face.size() == 1 && std::binary_search(corners.begin(), corners.end(), face[0]);
    };
    std::size_t kept = 0;
    for (std::size_t i = 0; i < soup.faces.size(); ++i) {
        if (redundant(soup.faces[i])) continue;
        if (kept != i) {
            soup.faces[kept] = std::move(soup.faces[i]);
            if (i < soup.face_lines.size()) soup.face_lines[kept] = soup.face_lines[i];
        }
        ++kept;
    }
    soup.faces.resize(kept);
    if (kept < soup.face_lines.size()) soup.face_lines.resize(kept);
}

}  // namespace hausbench::readers
