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
// Returns lines for the user: what was written, and the notes of the reader as `measure` prints them.
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
    const LoadReport& report = loaded.report;
    const bool points = kind_of(loaded.shape) == ShapeKind::points;
    std::string text =
        fmt::format("{}: {} {}", to.string(), element_count(loaded.shape), points ? "points" : "triangles");
    if (!points) text += fmt::format(", {} vertices", points_of(loaded.shape).rows());
    text += reading_text(report) + "\n";
    for (const std::string& note : report.notes) text += fmt::format("note       {}: {}\n", model, note);
    if (report.stated.micrometres != 0)
        text +=
            fmt::format("note       {}: is in {}, which the written file does not state\n", model, report.stated.unit);
    if (report.stated.up != 0)
        text += fmt::format("note       {}: {} points up, which the written file does not state\n", model,
                            report.stated.up);
    return text;
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
    verb->callback([] { print(export_model(model, file, options, matrix)); });
}

}  // namespace hausbench
