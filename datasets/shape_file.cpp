#include "datasets/shape_file.h"

#include "algorithms/error.h"
#include "algorithms/kernel/polynomial.h"
#include "datasets/hdf5.h"
#include "datasets/seal.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <sstream>
#include <stdexcept>
#include <vector>

namespace hausbench {
namespace {

constexpr std::int64_t shape_schema = 2;

template <class Matrix, class Value> Matrix rows_of_three(const std::vector<Value>& values) {
    if (values.size() % 3 != 0) throw std::runtime_error("its coordinates or indices do not come by three");
    return Eigen::Map<const Matrix>(values.data(), static_cast<Eigen::Index>(values.size() / 3), 3);
}

LoadedShape read_unchecked(const std::filesystem::path& path, const std::string& made_from) {
    const h5::File file(path, h5::Open::read);
    if (!file.has_attribute("", "shape_schema") || file.integer_attribute("", "shape_schema") != shape_schema)
        throw std::runtime_error("is not a shape file of this version");
    if (!made_from.empty() && file.text_attribute("", "made_from") != made_from)
        throw std::runtime_error("has a shape that was made from another file or recipe");
    LoadedShape loaded;
    const std::string kind = file.text_attribute("", "kind");
    const Points points =
        rows_of_three<Points>(file.read_doubles("coordinates"));  // for a surface, the corners of its box
    if (kind == "mesh")
        loaded.shape = TriangleMesh{points, rows_of_three<Triangles>(file.read_indices("triangles"))};
    else if (kind == "points")
        loaded.shape = PointSet{points};
    else if (kind == "surface")
        loaded.shape = AlgebraicSurface{file.text_attribute("", "polynomial"), points};
    else
        throw std::runtime_error("is of unknown kind '" + kind + "'");

    loaded.report.format = file.text_attribute("", "format");
    loaded.report.precision = file.text_attribute("", "precision");
    const std::int64_t unreferenced = file.integer_attribute("", "unreferenced");
    loaded.report.unreferenced = unreferenced < 0 ? std::nullopt : std::optional(unreferenced);
    loaded.report.float32 = file.has_attribute("", "float32") && file.integer_attribute("", "float32") != 0;
    loaded.report.polygons = file.integer_attribute("", "polygons");
    loaded.report.objects = file.integer_attribute("", "objects");
    loaded.report.segments = file.integer_attribute("", "segments");
    loaded.report.single_points = file.integer_attribute("", "single_points");
    loaded.report.dropped_points = file.integer_attribute("", "dropped_points");
    loaded.report.dropped_faces = file.integer_attribute("", "dropped_faces");
    loaded.report.stated.unit = file.text_attribute("", "unit");
    loaded.report.stated.micrometres = file.read_doubles("micrometres").at(0);
    const std::string up = file.text_attribute("", "up");
    loaded.report.stated.up = up.empty() ? '\0' : up[0];
    std::istringstream notes(file.text_attribute("", "notes"));
    for (std::string line; std::getline(notes, line);) loaded.report.notes.push_back(line);
    if (content_hash(loaded.shape) != file.text_attribute("", "content_hash"))
        throw std::runtime_error("does not match its content hash");
    return loaded;
}

}  // namespace

void write_shape(const std::filesystem::path& path, const LoadedShape& loaded, const std::string& made_from) {
    // The process number in the name keeps apart two processes that write the same file. Whichever renames last
    // replaces the other's file, which has the same shape.
    std::filesystem::path temporary = path;
    temporary += fmt::format(".{}.part", ::getpid());
    try {
        h5::File file(temporary, h5::Open::create);
        file.attribute("", "shape_schema", shape_schema);
        file.attribute("", "kind", std::string(to_string(kind_of(loaded.shape))));
        file.attribute("", "content_hash", content_hash(loaded.shape));
        file.attribute("", "made_from", made_from);
        file.attribute("", "format", loaded.report.format);
        file.attribute("", "precision", loaded.report.precision);
        file.attribute("", "unreferenced", loaded.report.unreferenced.value_or(-1));
        file.attribute("", "float32", std::int64_t(loaded.report.float32));
        file.attribute("", "polygons", loaded.report.polygons);
        file.attribute("", "objects", loaded.report.objects);
        file.attribute("", "segments", loaded.report.segments);
        file.attribute("", "single_points", loaded.report.single_points);
        file.attribute("", "dropped_points", loaded.report.dropped_points);
        file.attribute("", "dropped_faces", loaded.report.dropped_faces);
        file.attribute("", "unit", loaded.report.stated.unit);
        file.write("micrometres", std::vector<double>{loaded.report.stated.micrometres}, 1);
        file.attribute("", "up", loaded.report.stated.up ? std::string(1, loaded.report.stated.up) : std::string());
        file.attribute("", "notes", fmt::format("{}", fmt::join(loaded.report.notes, "\n")));
        const Points& points = points_of(loaded.shape);
        file.write("coordinates", std::vector<double>(points.data(), points.data() + points.size()), 3);
        if (const auto* mesh = std::get_if<TriangleMesh>(&loaded.shape)) {
            const Triangles& t = mesh->triangles;
            file.write("triangles", std::vector<Index>(t.data(), t.data() + t.size()), 3);
        }
        if (const auto* surface = std::get_if<AlgebraicSurface>(&loaded.shape))
            file.attribute("", "polynomial", surface->polynomial);
        file.close();
        std::filesystem::rename(temporary, path);
    } catch (const std::runtime_error& error) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        throw InputError(fmt::format(
            "{}: cannot write the shape ({}): make room, or name another folder with HAUSBENCH_CACHE, or with "
            "TMPDIR for a file that is measured",
            path.string(), error.what()));
    }
}

LoadedShape read_shape(const std::filesystem::path& path, const std::string& made_from) {
    LoadedShape loaded;
    try {
        h5::check_seal(path);
        loaded = read_unchecked(path, made_from);
    } catch (const std::runtime_error& error) {
        const std::string why = error.what();
        const bool named = why.starts_with(path.string());
        throw InputError((named ? "" : path.string() + ": ") + why + "; delete the file, and it is made again");
    }
    const std::string problem = shape_problem(loaded.shape);
    if (!problem.empty()) throw InputError(path.string() + ": " + problem + "; delete the file, and it is made again");
    return loaded;
}

std::string shape_problem(const Shape& shape) {
    if (const auto* surface = std::get_if<AlgebraicSurface>(&shape)) return surface_problem(*surface);
    const Points& points = points_of(shape);
    if (points.rows() == 0) return "holds no points";
    for (Eigen::Index i = 0; i < points.rows(); ++i)
        if (!points.row(i).allFinite()) return fmt::format("vertex {} (from 0) has a coordinate that is not finite", i);
    const auto* mesh = std::get_if<TriangleMesh>(&shape);
    if (!mesh) return "";
    if (mesh->triangles.rows() == 0) return "is a mesh without triangles";
    std::vector<bool> used(static_cast<std::size_t>(points.rows()), false);
    for (Eigen::Index t = 0; t < mesh->triangles.rows(); ++t)
        for (int k = 0; k < 3; ++k) {
            const Index v = mesh->triangles(t, k);
            if (v < 0 || v >= points.rows())
                return fmt::format("triangle {} (from 0) names vertex {} of {}", t, v, points.rows());
            used[static_cast<std::size_t>(v)] = true;
        }
    for (std::size_t v = 0; v < used.size(); ++v)
        if (!used[v]) return fmt::format("vertex {} (from 0) belongs to no triangle", v);
    return "";
}

}  // namespace hausbench
