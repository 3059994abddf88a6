#include "harness/plan/own_models.h"

#include "algorithms/error.h"
#include "datasets/corpus.h"
#include "datasets/paths.h"
#include "harness/record/profiles.h"

#include <fmt/format.h>

#include <set>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

ModelInfo file_model(const std::string& path, const fs::path& folder) {
    ModelInfo model;
    model.name = model.path = path;
    model.source = "file";
    model.folder = folder;
    return model;
}

[[noreturn]] void refuse(const fs::path& file, int line, const std::string& why) {
    throw InputError(one_line(line > 0 ? fmt::format("{}:{}: {}", file.string(), line, why)
                                       : fmt::format("{}: {}", file.string(), why)));
}

// Returns the name of the model from which a corpus rule would derive this one, such as "cow" for "cow_half". Returns
// an empty string if no rule fits.
std::string origin_by_rule(const std::string& name) {
    for (const CorpusRule& rule : corpus_rules())
        if (name.ends_with(rule.ending)) return name.substr(0, name.size() - rule.ending.size());
    return "";
}

void expect_file(const fs::path& experiment, int line, const ModelInfo& model) {
    const fs::path file = model.folder / model.path;
    std::error_code ignored;
    if (fs::exists(file, ignored)) return;
    refuse(experiment, line,
           fmt::format("model '{}': there is no file {}: paths count from the experiment's folder", model.name,
                       file.string()));
}

}  // namespace

void add_own_models(Catalogue& catalogue, const Experiment& experiment) {
    const fs::path& file = experiment.file;
    const fs::path folder = file.parent_path();
    for (const ModelInfo& model : experiment.models) {
        if (model.source == "file") expect_file(file, 0, model);
    }
    catalogue.add(file, experiment.models);
    const auto use = [&](const std::string& name, int line) {
        if (catalogue.has(name)) return;
        if (const std::string origin = origin_by_rule(name); catalogue.has(origin))
            refuse(file, line,
                   fmt::format("no model '{}': '{}' is not of the corpus: list it under 'manifest' in "
                               "datasets/corpus.toml, or define [model.{}]",
                               name, origin, name));
        if (!names_a_file(name)) {
            std::vector<std::string> names;
            for (const ModelInfo& model : catalogue.models()) names.push_back(model.name);
            refuse(file, line,
                   fmt::format("no model '{}'{}: define [model.{}] with a path, or give a path such as \"{}.ply\"",
                               name, nearest_hint(name, names), name, name));
        }
        const ModelInfo model = file_model(name, folder);
        expect_file(file, line, model);
        catalogue.add(file, {model});
    };
    for (const ScenePlan& scene : experiment.scenes) {
        use(scene.source, scene.source_line);
        use(scene.target, scene.target_line);
    }
}

void add_own_models(Catalogue& catalogue, const ResultFile& result) {
    const auto text = [&](const char* name) {
        const auto at = result.texts.find(name);
        return at == result.texts.end() ? "" : at->second;
    };
    const fs::path file = text("experiment_file");
    std::set<std::string> profiles;  // profiles of rows from earlier runs; each may define models of its own
    for (const Row& row : result.rows) profiles.merge(profile_names(row.spec.profile));
    profiles.erase(text("profile"));
    std::vector<std::string> all{text("profile")};  // the result's own profile first, so that its models win
    all.insert(all.end(), profiles.begin(), profiles.end());
    for (const std::string& profile : all) {
        if (text("experiment_toml").empty()) break;
        auto models = models_of(file, text("experiment_toml"), profile);
        if (profile != text("profile"))
            std::erase_if(models, [&](const ModelInfo& model) { return catalogue.has(model.name); });
        catalogue.add(file, std::move(models));
    }
    std::vector<ModelInfo> files;
    std::set<std::string> named;
    for (const ModelRecord& model : result.models) {
        if (!catalogue.has(model.name) && names_a_file(model.name) && named.insert(model.name).second)
            files.push_back(file_model(model.name, file.parent_path()));
    }
    catalogue.add(file, std::move(files));
}

}  // namespace hausbench
