// Turns the soup of a reader into a shape.
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/readers.h"
#include "datasets/merge_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hausbench::readers {
namespace {

std::string line_of(const std::vector<std::uint32_t>& lines, std::size_t i) {
    return i < lines.size() ? fmt::format("line {}: ", lines[i]) : "";
}

void check_indices(const std::string& name, const Soup& soup) {
    if (soup.points.empty()) throw InputError(name + ": holds no vertices");
    if (soup.points.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
        throw InputError(fmt::format("{}: holds {} vertices, more than {}", name, soup.points.size(),
                                     std::numeric_limits<Index>::max()));
    for (std::size_t f = 0; f < soup.faces.size(); ++f)
        for (const std::size_t v : soup.faces[f])
            if (v >= soup.points.size())
                throw InputError(fmt::format("{}: {}face {} (from 0) names vertex {} (from 0), but there are {}", name,
                                             line_of(soup.face_lines, f), f, static_cast<std::int64_t>(v),
                                             soup.points.size()));
}

// Refuses points that are not finite. In a soup with faces, only those that a face uses.
void check_finite(const std::string& name, const Soup& soup) {
    std::vector<bool> used(soup.points.size(), soup.faces.empty());
    for (const auto& face : soup.faces)
        for (const std::size_t v : face) used[v] = true;
    for (std::size_t v = 0; v < soup.points.size(); ++v) {
        const Vec3& p = soup.points[v];
        if (used[v] && !p.allFinite())
            throw InputError(fmt::format(
                "{}: {}vertex {} (from 0) has a coordinate that is not finite: {} {} {}: mend it, or leave such points "
                "out with --drop-invalid (in Python drop_invalid=True)",
                name, line_of(soup.point_lines, v), v, p.x(), p.y(), p.z()));
    }
}

// Drops points that are not finite, and the faces that use them.
void drop_invalid(const std::string& name, Soup& soup, LoadReport& report) {
    const auto invalid = [&](std::size_t v) { return !soup.points[v].allFinite(); };
    if (soup.faces.empty()) {
        report.dropped_points = std::erase_if(soup.points, [](const Vec3& p) { return !p.allFinite(); });
        soup.point_lines.clear();
        if (soup.points.empty()) throw InputError(name + ": has no point whose coordinates are all finite");
        return;
    }
    for (std::size_t v = 0; v < soup.points.size(); ++v) report.dropped_points += invalid(v) ? 1 : 0;
    report.dropped_faces =
        std::erase_if(soup.faces, [&](const auto& face) { return std::any_of(face.begin(), face.end(), invalid); });
    soup.face_lines.clear();
    if (soup.faces.empty()) throw InputError(name + ": has no face whose corners all have finite coordinates");
}

// Returns the face without corners that repeat their predecessor. If fewer than three corners remain, returns the first
// three of the face, a degenerate triangle, instead.
std::vector<std::size_t> without_repeats(const std::vector<std::size_t>& face) {
    std::vector<std::size_t> corners;
    for (const std::size_t v : face)
        if (corners.empty() || corners.back() != v) corners.push_back(v);
    while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
    return corners.size() < 3 ? std::vector(face.begin(), face.begin() + 3) : corners;
}

// What splitting the polygons of a soup into triangles decides, because no format says where to cut.
struct Splits {
    double off_plane = 0;       // the largest distance of a corner from the mean plane of its polygon
    std::int64_t crossing = 0;  // polygons whose triangles cover more than the polygon, which crosses itself

    void add(const std::vector<Vec3>& corners, const std::vector<std::array<std::size_t, 3>>& triangles) {
        Vec3 normal = Vec3::Zero(), centre = Vec3::Zero();
        for (std::size_t i = 0; i < corners.size(); ++i) {
            normal += (corners[i] - corners[0]).cross(corners[(i + 1) % corners.size()] - corners[0]);
            centre += corners[i] / static_cast<double>(corners.size());
        }
        const double length = normal.norm();
        double covered = 0, signs = 0;  // twice the areas of the triangles in the plane
        for (const auto& [a, b, c] : triangles) {
            const Vec3 twice = (corners[b] - corners[a]).cross(corners[c] - corners[a]);
            const double area = length > 0 ? twice.dot(normal) / length : twice.norm();
            covered += std::abs(area);
            signs += length > 0 ? area : 0;
        }
        if (covered > std::abs(signs) * (1 + 1e-6)) ++crossing;
        for (const Vec3& corner : corners)
            if (length > 0) off_plane = std::max(off_plane, std::abs((corner - centre).dot(normal)) / length);
    }

    // Says what was decided. `largest` is the largest coordinate: corners that rounding moved off a plane are not told.
    void note(double largest, bool float32, std::vector<std::string>& notes) const {
        if (off_plane > largest * (float32 ? 0x1p-21 : 0x1p-48))
            notes.push_back(fmt::format(
                "has polygons that are not flat (a corner is up to {:.3g} from the mean plane): they are cut "
                "along diagonals that the format does not define",
                off_plane));
        if (crossing > 0)
            notes.push_back(
                fmt::format("has polygons that cross themselves ({}): their triangles may cover more than the "
                            "polygon",
                            crossing));
    }
};

// Returns the corners of the triangles of all faces, three for each triangle. Counts in the report the polygons that it
// splits, and the segments and single points that become degenerate triangles.
std::vector<Index> triangles_of(const Soup& soup, LoadReport& report) {
    std::vector<Index> corners;
    Splits splits;
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        for (const std::size_t v : {a, b, c}) corners.push_back(static_cast<Index>(v));
    };
    for (const auto& face : soup.faces) {
        if (face.empty()) continue;
        if (face.size() <= 3) {
            add(face[0], face.size() > 1 ? face[1] : face[0], face.back());
            report.segments += face.size() == 2 ? 1 : 0;
            report.single_points += face.size() == 1 ? 1 : 0;
            continue;
        }
        ++report.polygons;
        const std::vector<std::size_t> polygon = without_repeats(face);
        std::vector<Vec3> positions;
        for (const std::size_t v : polygon) positions.push_back(soup.points[v]);
        const auto triangles = triangulate(positions);
        splits.add(positions, triangles);
        for (const auto& [a, b, c] : triangles) add(polygon[a], polygon[b], polygon[c]);
    }
    double largest = 0;
    for (const Vec3& p : soup.points)
        if (p.allFinite()) largest = std::max(largest, p.cwiseAbs().maxCoeff());
    splits.note(largest, soup.float32, report.notes);
    return corners;
}

// If all faces are single points, makes them the points of a point set. Counts the other points as unreferenced.
void points_alone(Soup& soup, LoadReport& report) {
    const auto one_corner = [](const auto& face) { return face.size() == 1; };
    if (soup.faces.empty() || !std::all_of(soup.faces.begin(), soup.faces.end(), one_corner)) return;
    std::vector<Vec3> points;
    std::vector<bool> used(soup.points.size(), false);
    std::vector<std::uint32_t> lines;
    for (std::size_t f = 0; f < soup.faces.size(); ++f) {
        const std::size_t v = soup.faces[f][0];
        if (used[v]) continue;  // named twice, and still one point
        used[v] = true;
        points.push_back(soup.points[v]);
        if (f < soup.face_lines.size()) lines.push_back(soup.face_lines[f]);
    }
    if (report.unreferenced) report.unreferenced = std::count(used.begin(), used.end(), false);
    soup.points = std::move(points);
    soup.point_lines = std::move(lines);
    soup.faces.clear();
}

}  // namespace

void add_point(const std::string& name, std::string_view line, std::uint32_t number, Soup& soup) {
    Vec3 point;
    for (double& coordinate : point) {
        const std::string_view word = next_word(line);
        const auto value = decimal(word);
        if (word.empty())
            refuse(name, number, fmt::format("vertex {} (from 0) does not have three coordinates", soup.points.size()));
        if (!value) refuse(name, number, fmt::format("'{}' is not a number", shown(word)));
        coordinate = *value;
    }
    soup.points.push_back(point);
    soup.point_lines.push_back(number);
}

LoadedShape finish(const Input& input, Soup soup) {
    check_indices(input.name, soup);
    LoadReport report;
    report.format = input.format;
    report.precision = soup.precision;
    report.float32 = soup.float32;
    report.objects = soup.objects;
    report.stated = soup.stated;
    report.notes = std::move(soup.notes);
    if (soup.unreferenced_unknown) report.unreferenced = std::nullopt;
    points_alone(soup, report);
    if (input.options.drop_invalid) drop_invalid(input.name, soup, report);
    check_finite(input.name, soup);
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    const Points points =
        Eigen::Map<const Points>(soup.points.front().data(), static_cast<Eigen::Index>(soup.points.size()), 3);
    if (soup.faces.empty()) return {PointSet{points}, report};
    if (soup.merge) {
        const std::vector<Index> first = first_equal(points);
        for (auto& face : soup.faces)
            for (std::size_t& v : face) v = static_cast<std::size_t>(first[v]);
    }
    const std::vector<Index> corners = triangles_of(soup, report);
    if (corners.empty()) throw InputError(input.name + ": none of its faces has a corner");
    if (corners.size() / 3 > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
        throw InputError(input.name + ": has more triangles than can be numbered");
    TriangleMesh mesh = without_unused(
        points, Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3));
    // With `merge`, the dropped vertices are repetitions of others, not unreferenced vertices of the file.
    if (report.unreferenced && !soup.merge) report.unreferenced = points.rows() - mesh.vertices.rows();
    return {std::move(mesh), report};
}

}  // namespace hausbench::readers
