#include "export.h"

#include "error.h"
#include "isolated.h"
#include "mesh_file.h"
#include "paths.h"
#include "shape_file.h"

#include <fmt/format.h>

namespace hausbench {

namespace {

LoadedShape find_shape(const Catalogue& catalogue, const std::string& model) {
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

}  // namespace

std::string export_model(const Catalogue& catalogue, const std::string& model, const std::filesystem::path& to) {
    const MeshFormat format = mesh_format_of(to);  // before loading, so that a wrong extension fails at once
    const LoadedShape loaded = find_shape(catalogue, model);
    write_mesh_file(to, loaded.shape, format);
    const bool points = kind_of(loaded.shape) == ShapeKind::points;
    return points ? fmt::format("{}: {} points", to.string(), element_count(loaded.shape))
                  : fmt::format("{}: {} triangles, {} vertices", to.string(), element_count(loaded.shape),
                                points_of(loaded.shape).rows());
}

}  // namespace hausbench
