#include "harness/commands/named_shape.h"

#include "algorithms/error.h"
#include "datasets/corpus.h"
#include "datasets/paths.h"
#include "datasets/separate_process.h"
#include "datasets/shape_file.h"
#include "harness/commands/verb.h"

#include <fmt/format.h>

namespace hausbench {

namespace {

// The models of the project. Reading them takes longer than loading a small one, so all shapes of a command share them.
const Catalogue& known_models() {
    static const Catalogue models = catalogue();
    return models;
}

}  // namespace

LoadedShape load_named(const std::string& name) {
    if (names_a_file(name)) return load_separately(program_path(), name);
    const Catalogue& models = known_models();
    if (!models.has(name)) {
        if (std::filesystem::exists(name)) return load_separately(program_path(), name);
        std::vector<std::string> names;
        for (const ModelInfo& model : models.models()) names.push_back(model.name);
        throw InputError(fmt::format("'{}' is neither a model nor a file{}", name, nearest_hint(name, names)));
    }
    const auto resolved = models.resolve(name);
    if (const auto* missing = std::get_if<MissingModel>(&resolved))
        throw InputError(fmt::format("model '{}': {}", name, missing->reason));
    return read_shape(std::get<ResolvedModel>(resolved).shape_file);
}

std::filesystem::path file_behind(const std::string& name) {
    if (names_a_file(name)) return name;
    const Catalogue& models = known_models();
    if (!models.has(name)) return name;
    const ModelInfo* model = &models.find(name);
    while (model->source == "derived") model = &models.find(model->from);
    return model->source == "file" ? model->folder / model->path : std::filesystem::path();
}

}  // namespace hausbench
