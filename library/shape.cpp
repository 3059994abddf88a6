#include "library/shape.h"

#include "datasets/load.h"
#include "datasets/merge_points.h"
#include "datasets/formats/formats.h"
#include "library/arrays.h"
#include "library/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

namespace hausbench {
namespace library {
namespace {

// Returns the shape without the vertices that no face uses.
Shape measured(const Shape& given) {
    const auto* mesh = std::get_if<TriangleMesh>(&given);
    return mesh ? Shape(without_unused(mesh->vertices, mesh->triangles)) : given;
}

}  // namespace

Model::Model(Shape given, std::string name)
    : measured_(measured(given)), name_(std::move(name)), largest_(magnitude(points_of(measured_))) {
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
    const auto at =
        std::find_if(prepared_.begin(), prepared_.end(), [&](const auto& one) { return one->exponent() == exponent; });
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

namespace readers {

Soup read_with_assimp(const Input& input) {
    throw InputError(fmt::format("{}: .{} is read by the program alone, through a library that this one does not link: "
                                 "convert it with `hausbench export`, or to one of {}",
                                 input.name, input.format, known_endings(true)));
}

LoadedShape read_surface(const std::filesystem::path& file) {
    throw InputError(file.string() + ": algebraic surfaces are read by the program alone: use `hausbench measure`");
}

}  // namespace readers
}  // namespace hausbench

using namespace hausbench::library;

extern "C" {

int hausbench_shape_of(const hausbench_array* vertices, const hausbench_array* faces, hausbench_shape** shape,
                       hausbench_error* error) {
    return guarded(error, [&] {
        given(shape, "shape", 3);
        hausbench::Points points = points_in(*given(vertices, "vertices", 1), 1);
        if (!faces) {
            *shape = new hausbench_shape{std::make_shared<Model>(hausbench::PointSet{std::move(points)}, "arrays")};
            return;
        }
        hausbench::Triangles triangles = triangles_in(*faces, static_cast<hausbench::Index>(points.rows()), 2);
        *shape = new hausbench_shape{
            std::make_shared<Model>(hausbench::TriangleMesh{std::move(points), std::move(triangles)}, "arrays")};
    });
}

int hausbench_read(const char* path, hausbench_shape** shape, hausbench_error* error) {
    return guarded(error, [&] {
        given(path, "path", 1);
        given(shape, "shape", 2);
        try {
            *shape = new hausbench_shape{std::make_shared<Model>(hausbench::load_file(path).shape, path)};
        } catch (const hausbench::InputError& wrong) {
            throw ArgumentError(1, wrong.what());
        }
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
        give(*description, ours);
    });
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
