#include "load.h"

#include "error.h"
#include "kernel/splitmix.h"
#include "readers.h"
#include "surface_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <set>
#include <unordered_map>

namespace hausbench {
namespace readers {
namespace {

// Bits of the three coordinates; -0 counts as +0.
struct PointKey {
    std::array<double, 3> x;
    bool operator==(const PointKey&) const = default;
};

struct PointKeyHash {
    std::size_t operator()(const PointKey& key) const {
        std::uint64_t mixed = 0;
        for (const double value : key.x) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, &value, sizeof bits);
            mixed = (mixed ^ bits) * golden_step;
            mixed ^= mixed >> 32;
        }
        return mixed;
    }
};

void merge_equal(Soup& soup) {
    std::unordered_map<PointKey, std::size_t, PointKeyHash> first;
    first.reserve(soup.points.size());
    std::vector<std::size_t> becomes(soup.points.size());
    std::vector<Vec3> kept;
    for (std::size_t v = 0; v < soup.points.size(); ++v) {
        const Vec3& p = soup.points[v];
        const auto [at, fresh] = first.try_emplace(PointKey{{p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}}, kept.size());
        if (fresh) kept.push_back(p);
        becomes[v] = at->second;
    }
    for (auto& face : soup.faces)
        for (std::size_t& v : face) v = becomes[v];
    soup.points = std::move(kept);
    soup.point_lines.clear();
}

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

// Removes corners equal to their predecessor while more than three remain.
std::vector<std::size_t> without_repeats(const std::vector<std::size_t>& face) {
    std::vector<std::size_t> corners;
    for (const std::size_t v : face)
        if (corners.empty() || corners.back() != v) corners.push_back(v);
    while (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
    return corners.size() < 3 ? std::vector(face.begin(), face.begin() + 3) : corners;
}

}  // namespace

LoadedShape finish(const std::string& name, Soup soup, LoadReport report, bool merge) {
    check(name, soup);
    report.objects = soup.objects;
    const auto as_points = [](const std::vector<Vec3>& points) {
        Points rows(static_cast<Eigen::Index>(points.size()), 3);
        for (std::size_t v = 0; v < points.size(); ++v) rows.row(static_cast<Eigen::Index>(v)) = points[v];
        return rows;
    };
    if (soup.faces.empty()) return {PointSet{as_points(soup.points)}, report};
    if (merge) merge_equal(soup);

    std::vector<Index> corners;
    for (const auto& face : soup.faces) {
        if (face.size() < 3) continue;
        if (face.size() == 3) {
            for (const std::size_t v : face) corners.push_back(static_cast<Index>(v));
            continue;
        }
        ++report.polygons;
        const std::vector<std::size_t> polygon = without_repeats(face);
        std::vector<Vec3> positions;
        for (const std::size_t v : polygon) positions.push_back(soup.points[v]);
        for (const auto& triple : triangulate(positions))
            for (const std::size_t k : triple) corners.push_back(static_cast<Index>(polygon[k]));
    }
    if (corners.empty()) throw InputError(name + ": none of its faces has three corners");
    if (corners.size() / 3 > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
        throw InputError(name + ": holds more triangles than are numbered");

    std::vector<Index> becomes(soup.points.size(), -1);
    for (const Index v : corners) becomes[static_cast<std::size_t>(v)] = 0;
    std::vector<Vec3> used;
    for (std::size_t v = 0; v < becomes.size(); ++v)
        if (becomes[v] == 0) {
            becomes[v] = static_cast<Index>(used.size());
            used.push_back(soup.points[v]);
        }
    if (report.unreferenced) report.unreferenced = static_cast<std::int64_t>(soup.points.size() - used.size());
    for (Index& v : corners) v = becomes[static_cast<std::size_t>(v)];
    const Triangles triangles =
        Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
    return {TriangleMesh{as_points(used), triangles}, report};
}

}  // namespace readers

namespace {

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return text;
}

std::string upper_case(std::string text) {
    for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
    return text;
}

std::string extension_of(const std::filesystem::path& file) {
    std::filesystem::path base = file.filename();
    if (lower_case(base.extension().string()) == ".gz") base = base.stem();
    const std::string extension = lower_case(base.extension().string());
    return extension.empty() ? "" : extension.substr(1);
}

// gzip shrinks numbers to about a tenth; it reaches a thousandth only for mere repetition.
constexpr std::size_t inflation = 200, inflated_anyway = std::size_t{1} << 26;

// The whole file, decompressed if it is gzipped (zlib tests the first two bytes).
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
        // For a truncated archive gzread reports no error, but sets this code.
        if (count < 0 || (count == 0 && code != Z_OK)) throw InputError(file.string() + ": cannot be inflated: " + why);
        if (count == 0) return bytes;
        bytes.append(buffer.data(), static_cast<std::size_t>(count));
        const z_off_t taken = gzoffset(in.get());  // bytes of the file read so far; -1 if unknown
        if (taken > 0 && bytes.size() > inflated_anyway && bytes.size() / inflation > static_cast<std::size_t>(taken))
            throw InputError(
                fmt::format("{}: inflates to more than {} times its size, which no mesh does: inflate it "
                            "by hand if it is sound",
                            file.string(), inflation));
    }
}

}  // namespace

bool names_a_file(const std::string& text) {
    static const std::set<std::string> known = {"off", "obj", "ply",  "stl", "xyz", "pts", "csv", "pcd", "las", "laz",
                                                "e57", "glb", "gltf", "3ds", "dae", "fbx", "ac",  "ase", "wrl", "x3d"};
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
    if (format.empty() && lower_case(name).ends_with(".surface.toml")) {
        LoadedShape loaded{read_surface_file(file), {}};
        loaded.report.format = "surface";
        return loaded;
    }
    const std::string kind = lower_case(format.empty() ? extension_of(file) : format);
    if (kind.empty())
        throw InputError(
            name + ": has no extension to tell its format: rename it to .off, .obj, .ply, .stl, .xyz or what it is");
    if (kind == "las" || kind == "laz" || kind == "e57")
        throw InputError(fmt::format(
            "{}: {} is not read, since no library of Debian 12 reads it: convert it to .xyz or .ply, for example with "
            "`las2txt -parse xyz` or `pdal translate`",
            name, upper_case(kind)));
    const bool lines = kind == "xyz" || kind == "pts" || kind == "csv";
    if (kind != "obj" && kind != "ply" && kind != "stl" && kind != "off" && kind != "pcd" && !lines)
        return readers::load_with_assimp(file, format);

    std::string bytes = read_all(file);
    if (bytes.empty()) throw InputError(name + ": is empty: save or fetch it again");
    LoadReport report;
    report.format = kind;
    readers::Soup soup = lines           ? readers::read_point_lines(name, bytes, kind)
                         : kind == "pcd" ? readers::read_pcd(name, bytes)
                                         : readers::read_with_cgal(name, std::move(bytes), kind);
    report.float32 = soup.float32;
    return readers::finish(name, std::move(soup), report, kind == "stl");
}

}  // namespace hausbench
