// `hausbench export`: writes a model, or any mesh file, in a format for other programs.
#include "commands/verb.h"

#include "corpus.h"
#include "error.h"
#include "isolated.h"
#include "mesh_file.h"
#include "paths.h"
#include "shape_file.h"

#include <fmt/format.h>

namespace hausbench {

namespace {

LoadedShape find_shape(Catalogue catalogue, const std::string& model) {
    add_tier_of(model, manifest_file(), catalogue);
    std::vector<std::string> names;
    for (const ModelInfo& info : catalogue.models()) {
        if (info.name != model) {
            names.push_back(info.name);
            continue;
        }
        const auto resolved = catalogue.resolve(model);
        if (const auto* missing = std::get_if<MissingModel>(&resolved))
            throw InputError(fmt::format("model '{}': {}", model, missing->reason));
        return read_shape(std::get<ResolvedModel>(resolved).shape_file);
    }
    if (std::filesystem::exists(model)) return load_isolated(program_path(), model);
    throw InputError(fmt::format("'{}' is neither a model nor a file{}", model, nearest_hint(model, names)));
}

// OFF, OBJ or PLY by the extension, with 17 digits: reading it gives the same bits. Returns a line that says what was written.
std::string export_model(const Catalogue& catalogue, const std::string& model, const std::filesystem::path& to) {
    const MeshFormat format = mesh_format_of(to);  // before loading, so that a wrong extension fails at once
    const LoadedShape loaded = find_shape(catalogue, model);
    write_mesh_file(to, loaded.shape, format);
    const bool points = kind_of(loaded.shape) == ShapeKind::points;
    return points ? fmt::format("{}: {} points", to.string(), element_count(loaded.shape))
                  : fmt::format("{}: {} triangles, {} vertices", to.string(), element_count(loaded.shape),
                                points_of(loaded.shape).rows());
}

}  // namespace

void add_export(CLI::App& app, int&) {
    static std::string model;
    static std::filesystem::path file;
    auto* verb = app.add_subcommand("export", "write a model as OFF, OBJ or PLY with all digits, for other programs");
    verb->add_option("model", model, "a model of datasets/manifest.toml, or any mesh file")->required();
    verb->add_option("file", file, "file to write: .off, .obj or .ply")->required();
    verb->callback([] { print(export_model(catalogue(), model, file) + "\n"); });
}

}  // namespace hausbench
