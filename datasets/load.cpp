#include "datasets/load.h"

#include "algorithms/error.h"
#include "datasets/merge_points.h"
#include "datasets/parse.h"
#include "datasets/readers.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <set>

namespace hausbench {
namespace readers {
namespace {

std::string line_of(const std::vector<std::uint32_t>& lines, std::size_t i) {
    return i < lines.size() ? fmt::format("line {}: ", lines[i]) : "";
}

void check(const std::string& name, const Soup& soup) {
    if (soup.points.empty()) throw InputError(name + ": holds no vertices");
    if (soup.points.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
        throw InputError(fmt::format("{}: holds {} vertices, more than {}", name, soup.points.size(),
                                     std::numeric_limits<Index>::max()));
    for (std::size_t v = 0; v < soup.points.size(); ++v) {
        const Vec3& p = soup.points[v];
        if (!p.allFinite())
            throw InputError(fmt::format("{}: {}vertex {} (from 0) has a coordinate that is not finite: {} {} {}", name,
                                         line_of(soup.point_lines, v), v, p.x(), p.y(), p.z()));
    }
    for (std::size_t f = 0; f < soup.faces.size(); ++f)
        for (const std::size_t v : soup.faces[f])
            if (v >= soup.points.size())
                throw InputError(fmt::format("{}: {}face {} (from 0) names vertex {} (from 0), but there are {}", name,
                                             line_of(soup.face_lines, f), f, static_cast<std::int64_t>(v),
                                             soup.points.size()));
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

// Returns the corners of the triangles of all faces, three for each triangle. Counts in `polygons` the faces that it
// splits.
std::vector<Index> triangles_of(const Soup& soup, std::int64_t& polygons) {
    std::vector<Index> corners;
    for (const auto& face : soup.faces) {
        if (face.size() < 3) continue;
        if (face.size() == 3) {
            for (const std::size_t v : face) corners.push_back(static_cast<Index>(v));
            continue;
        }
        ++polygons;
        const std::vector<std::size_t> polygon = without_repeats(face);
        std::vector<Vec3> positions;
        for (const std::size_t v : polygon) positions.push_back(soup.points[v]);
        for (const auto& triple : triangulate(positions))
            for (const std::size_t k : triple) corners.push_back(static_cast<Index>(polygon[k]));
    }
    return corners;
}

}  // namespace

void add_point(const std::string& name, std::string_view line, std::uint32_t number, Soup& soup) {
    Vec3 point;
    for (double& coordinate : point) {
        const std::string_view word = next_word(line);
        const auto value = decimal(word);
        if (word.empty())
            refuse(name, number, fmt::format("vertex {} (from 0) does not have three coordinates", soup.points.size()));
        if (!value) refuse(name, number, fmt::format("'{}' is no number", shown(word)));
        coordinate = *value;
    }
    soup.points.push_back(point);
    soup.point_lines.push_back(number);
}

LoadedShape finish(const std::string& name, Soup soup, LoadReport report, bool merge) {
    check(name, soup);
    report.objects = soup.objects;
    report.float32 = soup.float32;
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    const Points points =
        Eigen::Map<const Points>(soup.points.front().data(), static_cast<Eigen::Index>(soup.points.size()), 3);
    if (soup.faces.empty()) return {PointSet{points}, report};
    if (merge) {
        const std::vector<Index> first = first_equal(points);
        for (auto& face : soup.faces)
            for (std::size_t& v : face) v = static_cast<std::size_t>(first[v]);
    }
    const std::vector<Index> corners = triangles_of(soup, report.polygons);
    if (corners.empty()) throw InputError(name + ": none of its faces has three corners");
    if (corners.size() / 3 > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
        throw InputError(name + ": has more triangles than can be numbered");
    TriangleMesh mesh = without_unused(
        points, Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3));
    // With `merge`, the dropped vertices are repetitions of others, not unreferenced vertices of the file.
    if (report.unreferenced && !merge) report.unreferenced = points.rows() - mesh.vertices.rows();
    return {std::move(mesh), report};
}

}  // namespace readers

namespace {

using readers::lower_case;

std::string extension_of(const std::filesystem::path& file) {
    std::filesystem::path base = file.filename();
    if (lower_case(base.extension().string()) == ".gz") base = base.stem();
    const std::string extension = lower_case(base.extension().string());
    return extension.empty() ? "" : extension.substr(1);
}

// A gzipped file may inflate to `inflation` times its size, and to `inflated_anyway` bytes in any case. gzip shrinks
// numbers to about a tenth; only a repetition of the same bytes, as in a file made to fill the memory, shrinks to a
// thousandth.
constexpr std::size_t inflation = 200, inflated_anyway = std::size_t{1} << 26;

// Returns the whole file, decompressed if it is gzipped (zlib tests the first two bytes).
std::string read_all(const std::filesystem::path& file) {
    errno = 0;
    const std::unique_ptr<gzFile_s, int (*)(gzFile)> in(gzopen(file.c_str(), "rb"), gzclose);
    if (!in) throw InputError(file.string() + ": cannot be read: " + std::strerror(errno));
    gzbuffer(in.get(), 1 << 18);
    std::string bytes;
    std::vector<char> buffer(1 << 20);
    for (;;) {
        const int count = gzread(in.get(), buffer.data(), static_cast<unsigned>(buffer.size()));
        int code = 0;
        const std::string why = gzerror(in.get(), &code);
        // For a truncated archive gzread returns no error, but gzerror gives a code.
        if (count < 0 || (count == 0 && code != Z_OK)) throw InputError(file.string() + ": cannot be inflated: " + why);
        if (count == 0) return bytes;
        bytes.append(buffer.data(), static_cast<std::size_t>(count));
        const z_off_t taken = gzoffset(in.get());  // bytes of the file read so far; -1 if unknown
        if (taken > 0 && bytes.size() > inflated_anyway && bytes.size() / inflation > static_cast<std::size_t>(taken))
            throw InputError(fmt::format(
                "{}: inflates to more than {} times its size, as no mesh does: inflate it yourself if it is sound",
                file.string(), inflation));
    }
}

}  // namespace

bool names_a_file(const std::string& text) {
    static const std::set<std::string> known = {"off", "obj", "ply", "stl", "xyz",  "pts", "csv", "pcd",
                                                "las", "laz", "e57", "glb", "gltf", "3ds", "dae", "fbx",
                                                "ac",  "ase", "wrl", "wrz", "vrml", "x3d"};
    return text.find('/') != std::string::npos || known.contains(extension_of(text)) ||
           lower_case(text).ends_with(".surface.toml");
}

LoadedShape load_file(const std::filesystem::path& file, const std::string& format) {
    std::error_code error;
    const std::string name = file.string();
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) throw InputError(name + ": no such file: check its path");
    if (std::filesystem::is_directory(status)) throw InputError(name + ": is a folder: name a file in it");
    if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(file, error) == 0)
        throw InputError(name + ": is empty: save or fetch it again");
    if (format.empty() && lower_case(name).ends_with(".surface.toml")) return readers::load_foreign(file, "surface");
    const std::string kind = lower_case(format.empty() ? extension_of(file) : format);
    if (kind.empty())
        throw InputError(name +
                         ": has no extension, which tells the format: rename it to .off, .obj, .ply, .stl, .wrl, .xyz "
                         "or its format");
    if (kind == "las" || kind == "laz" || kind == "e57")
        throw InputError(
            fmt::format("{}: {} cannot be read, because Debian 12 has no library for it: convert it to .xyz or .ply, "
                        "for example with `las2txt -parse xyz` or `pdal translate`",
                        name,
                        kind == "las"   ? "LAS"
                        : kind == "laz" ? "LAZ"
                                        : "E57"));
    using Read = readers::Soup (*)(const std::string& name, std::string_view bytes);
    static const std::map<std::string, Read> own = {
        {"obj", readers::read_obj},   {"off", readers::read_off}, {"ply", readers::read_ply},
        {"stl", readers::read_stl},   {"pcd", readers::read_pcd}, {"xyz", readers::read_xyz},
        {"pts", readers::read_xyz},   {"csv", readers::read_csv}, {"wrl", readers::read_vrml},
        {"vrml", readers::read_vrml}, {"wrz", readers::read_vrml}};
    const auto read = own.find(kind);
    if (read == own.end()) return readers::load_foreign(file, format);
    const std::string bytes = read_all(file);
    if (bytes.empty()) throw InputError(name + ": is empty: save or fetch it again");
    LoadReport report;
    report.format = kind;
    const bool vrml = read->second == readers::read_vrml;
    if (vrml) report.unreferenced = std::nullopt;  // unknown, because shapes may share vertices
    return readers::finish(name, read->second(name, bytes), report, vrml || kind == "stl");
}

}  // namespace hausbench
