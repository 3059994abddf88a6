// `hausbench export`: writes a model, or any mesh file, in a format for other programs.
#include "algorithms/error.h"
#include "harness/commands/named_shape.h"
#include "harness/commands/verb.h"
#include "harness/run/mesh_file.h"
#include "process/whole_file.h"

#include <fmt/format.h>

namespace hausbench {

namespace {

// Writes a model as OFF, OBJ or PLY, depending on the extension, with 17 digits so that coordinates round-trip exactly.
// Returns a line for the user.
std::string export_model(const std::string& model, const std::filesystem::path& to, const ShapeOptions& options,
                         const std::filesystem::path& matrix) {
    const MeshFormat format = mesh_format_of(to);  // before loading, so that a wrong extension fails at once
    if (is_same_file(to, file_behind(model)))
        throw InputError(fmt::format("{}: is the input file: choose another name", to.string()));
    if (!options.columns.empty() && !has_columns(model))
        throw InputError(
            fmt::format("--columns: {} is not a table of points, such as .csv or .xyz: leave it out", model));
    LoadedShape loaded = load_named(model, options);
    if (!matrix.empty()) transform(loaded, matrix);
    write_mesh_file(to, loaded.shape, format);
    const bool points = kind_of(loaded.shape) == ShapeKind::points;
    return points ? fmt::format("{}: {} points", to.string(), element_count(loaded.shape))
                  : fmt::format("{}: {} triangles, {} vertices", to.string(), element_count(loaded.shape),
                                points_of(loaded.shape).rows());
}

}  // namespace

void add_export(CLI::App& app, int&) {
    static std::string model;
    static std::filesystem::path file, matrix;
    static ShapeOptions options;
    auto* verb = add_verb(app, "export", "writes a model with all digits, for other programs",
                          "hausbench export bunny bunny.ply");
    verb->add_option("model", model, "a model (see `hausbench list models`) or a file")->type_name("MODEL")->required();
    verb->add_option("file", file, "file to write: .off, .obj or .ply")->type_name("FILE")->required();
    take_shape_options(verb, options);
    verb->add_option("--transform", matrix, "moves the shape by the 4 x 4 matrix in this text file")->type_name("FILE");
    verb->callback([] { print(export_model(model, file, options, matrix) + "\n"); });
}

}  // namespace hausbench
