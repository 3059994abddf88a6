#include "library/shape.h"

#include "datasets/formats/parse.h"
#include "datasets/load.h"
#include "datasets/merge_points.h"
#include "datasets/units.h"
#include "library/arrays.h"
#include "library/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace hausbench {
namespace library {
namespace {

// Returns the shape without the vertices that no face uses.
Shape measured(const Shape& given) {
    const auto* mesh = std::get_if<TriangleMesh>(&given);
    return mesh ? Shape(without_unused(mesh->vertices, mesh->triangles)) : given;
}

constexpr const char* none = "none";

// The options `unit` and `up`, checked.
struct Conversion {
    std::optional<Unit> unit;
    char up = 0;
    bool forget_unit = false, forget_up = false;
};

Conversion conversion_of(const hausbench_read_options& options) {
    Conversion conversion;
    if (options.unit) {
        conversion.forget_unit = readers::lower_case(options.unit) == none;
        conversion.unit = unit_named(options.unit);
        if (!conversion.unit && !conversion.forget_unit)
            throw ArgumentError(2, fmt::format("unit: '{}' is not a unit: give one of {}, or none",
                                               one_line(options.unit), unit_names()));
    }
    if (options.up) {
        const std::string up = readers::lower_case(options.up);
        conversion.forget_up = up == none;
        if (up == "x" || up == "y" || up == "z")
            conversion.up = static_cast<char>(up[0] - 'a' + 'A');
        else if (!conversion.forget_up)
            throw ArgumentError(2, fmt::format("up: '{}' is not an axis: give X, Y, Z or none", one_line(options.up)));
    }
    return conversion;
}

void convert(LoadedShape& loaded, const Conversion& conversion, const std::string& name) {
    Stated& stated = loaded.report.stated;
    if (conversion.unit) convert_to_unit(loaded, *conversion.unit, name);
    if (conversion.up) convert_to_up(loaded, conversion.up);
    if (conversion.forget_unit) stated = {{}, 0, stated.up};
    if (conversion.forget_up) stated.up = 0;
}

std::string text_or_none(const char* text) { return text ? text : ""; }

std::shared_ptr<Model> read(const char* path, const hausbench_read_options& options) {
    if (options.reserved != 0) throw ArgumentError(2, "options: reserved must be 0");
    expect_flag(options.drop_invalid, "options: drop_invalid", 2);
    const Conversion conversion = conversion_of(options);
    LoadOptions how;
    how.format = text_or_none(options.format);
    how.columns = text_or_none(options.columns);
    how.drop_invalid = options.drop_invalid == 1;
    try {
        LoadedShape loaded = load_file(path, how);
        convert(loaded, conversion, path);
        const double metres = loaded.report.stated.micrometres / 1e6;
        return std::make_shared<Model>(std::move(loaded.shape), Origin{path, std::move(loaded.report), metres});
    } catch (const InputError& wrong) {
        throw ArgumentError(1, wrong.what());
    }
}

// Returns the origin of arrays that state what `about` does.
Origin origin_of(const hausbench_description& about) {
    const auto fail = [](const std::string& what) { throw ArgumentError(3, "about: " + what); };
    for (const std::int64_t count : {about.segments, about.single_points, about.dropped_points, about.dropped_faces})
        if (count < 0) fail(fmt::format("has the number {}: give at least 0", count));
    if (!(about.unit >= 0 && std::isfinite(about.unit * 1e6)))
        fail(fmt::format("unit is {}: give the length of the unit in metres, or 0", about.unit));
    if (about.up != 0 && about.up != 'X' && about.up != 'Y' && about.up != 'Z')
        fail(fmt::format("up is {}: give 'X', 'Y', 'Z' or 0", about.up));
    Origin origin;
    origin.unit = about.unit;
    if (about.unit > 0) origin.report.stated = stated_unit(about.unit);
    origin.report.stated.up = static_cast<char>(about.up);
    origin.report.segments = about.segments;
    origin.report.single_points = about.single_points;
    origin.report.dropped_points = about.dropped_points;
    origin.report.dropped_faces = about.dropped_faces;
    return origin;
}

std::shared_ptr<Model> from_arrays(const hausbench_array* vertices, const hausbench_array* faces, Origin origin) {
    Points points = points_in(*given(vertices, "vertices", 1), 1);
    if (!faces) return std::make_shared<Model>(PointSet{std::move(points)}, std::move(origin));
    Triangles triangles = triangles_in(*faces, static_cast<Index>(points.rows()), 2);
    return std::make_shared<Model>(TriangleMesh{std::move(points), std::move(triangles)}, std::move(origin));
}

}  // namespace

Model::Model(Shape given, Origin origin)
    : measured_(measured(given)), origin_(std::move(origin)), largest_(magnitude(points_of(measured_))) {
    auto* mesh = std::get_if<TriangleMesh>(&given);
    if (mesh && mesh->vertices.rows() != points_of(measured_).rows()) given_ = std::move(*mesh);
}

const Triangles* Model::given_faces() const {
    if (given_) return &given_->triangles;
    const auto* mesh = std::get_if<TriangleMesh>(&shape());
    return mesh ? &mesh->triangles : nullptr;
}

std::shared_ptr<PreparedShape> Model::prepared(int exponent) {
    constexpr std::size_t most_kept = 3;
    const std::lock_guard lock(keeping_);
    const auto at = std::find_if(prepared_.begin(), prepared_.end(),
                                 [&](const auto& candidate) { return candidate->exponent() == exponent; });
    if (at != prepared_.end()) {
        prepared_.splice(prepared_.begin(), prepared_, at);
        return prepared_.front();
    }
    prepared_.push_front(exponent == 0 ? std::make_shared<PreparedShape>(measured_)
                                       : std::make_shared<PreparedShape>(Shape(shape()), exponent));
    if (prepared_.size() > most_kept) prepared_.pop_back();
    return prepared_.front();
}

std::shared_ptr<Model> model_of(const hausbench_shape* handle, const char* name, int argument) {
    return given(handle, name, argument)->model;
}

}  // namespace library
}  // namespace hausbench

using namespace hausbench::library;

extern "C" {

int hausbench_shape_of(const hausbench_array* vertices, const hausbench_array* faces, hausbench_shape** shape,
                       hausbench_error* error) {
    return guarded(error, [&] {
        given(shape, "shape", 3);
        *shape = new hausbench_shape{from_arrays(vertices, faces, {})};
    });
}

int hausbench_shape_stating(const hausbench_array* vertices, const hausbench_array* faces,
                            const hausbench_description* about, hausbench_shape** shape, hausbench_error* error) {
    return guarded(error, [&] {
        given(shape, "shape", 4);
        const hausbench_description ours = taken<hausbench_description>(about, HAUSBENCH_DESCRIPTION_INIT, "about", 3);
        *shape = new hausbench_shape{from_arrays(vertices, faces, origin_of(ours))};
    });
}

int hausbench_read(const char* path, hausbench_shape** shape, hausbench_error* error) {
    return guarded(error, [&] {
        given(path, "path", 1);
        given(shape, "shape", 2);
        *shape = new hausbench_shape{read(path, HAUSBENCH_READ_OPTIONS_INIT)};
    });
}

int hausbench_read_with(const char* path, const hausbench_read_options* options, hausbench_shape** shape,
                        hausbench_error* error) {
    return guarded(error, [&] {
        given(path, "path", 1);
        const hausbench_read_options ours =
            taken<hausbench_read_options>(options, HAUSBENCH_READ_OPTIONS_INIT, "options", 2);
        given(shape, "shape", 3);
        *shape = new hausbench_shape{read(path, ours)};
    });
}

int hausbench_describe(const hausbench_shape* shape, hausbench_description* description, hausbench_error* error) {
    return guarded(error, [&] {
        const auto model = model_of(shape, "shape", 1);
        expect_size(*given(description, "description", 2), "description", 2);
        const hausbench::Points& points = points_of(model->shape());
        hausbench_description ours = HAUSBENCH_DESCRIPTION_INIT;
        ours.is_mesh = model->given_faces() ? 1 : 0;
        ours.vertices = model->given_points().rows();
        ours.faces = model->given_faces() ? model->given_faces()->rows() : 0;
        for (int k = 0; k < 3; ++k) {
            ours.box[k] = points.col(k).minCoeff();
            ours.box[3 + k] = points.col(k).maxCoeff();
        }
        ours.diagonal = hausbench::diagonal(points);
        const hausbench::LoadReport& report = model->origin().report;
        ours.segments = report.segments;
        ours.single_points = report.single_points;
        ours.dropped_points = report.dropped_points;
        ours.dropped_faces = report.dropped_faces;
        ours.unit = model->origin().unit;
        ours.up = report.stated.up;
        give(*description, ours);
    });
}

const char* hausbench_note(const hausbench_shape* shape, size_t number) {
    if (!shape) return nullptr;
    const std::vector<std::string>& notes = shape->model->origin().report.notes;
    return number < notes.size() ? notes[number].c_str() : nullptr;
}

int hausbench_copy_out(const hausbench_shape* shape, double* vertices, int64_t* faces, hausbench_error* error) {
    return guarded(error, [&] {
        const auto model = model_of(shape, "shape", 1);
        const hausbench::Points& points = model->given_points();
        if (vertices) std::copy_n(points.data(), points.size(), vertices);
        if (const hausbench::Triangles* triangles = model->given_faces(); triangles && faces)
            std::copy_n(triangles->data(), triangles->size(), faces);
    });
}

void hausbench_shape_release(hausbench_shape* shape) { delete shape; }

}  // extern "C"
