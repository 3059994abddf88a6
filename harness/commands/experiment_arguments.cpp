#include "harness/commands/experiment_arguments.h"

#include "algorithms/error.h"
#include "datasets/paths.h"
#include "datasets/shape_file.h"
#include "harness/plan/own_models.h"
#include "harness/run/progress.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

namespace hausbench {

namespace {

// Returns `named` if it is a path, otherwise the experiment with this stem in the project or the installation. Throws
// InputError if there is none.
std::filesystem::path experiment_file(const std::filesystem::path& named) {
    if (named.has_parent_path() || named.has_extension() || std::filesystem::exists(named)) return named;
    std::vector<std::string> stems;
    for (const auto& file : experiment_files(experiments_folder())) {
        if (file.stem() == named) return file;
        stems.push_back(file.stem().string());
    }
    if (stems.empty()) return named;
    throw InputError(fmt::format("'{}' is neither a file nor an experiment of the project{}", named.string(),
                                 nearest_hint(named.string(), stems)));
}

}  // namespace

Plan plan_of(const ExperimentArguments& arguments, bool quiet) {
    const std::filesystem::path file = experiment_file(arguments.file);
    const Experiment experiment = arguments.with.empty()
                                      ? read_experiment(file, arguments.profile)
                                      : read_experiment_with(file, arguments.with, arguments.profile);
    static Catalogue models = catalogue();  // static, because the plan points into it
    add_own_models(models, experiment);
    Progress progress(quiet);
    return make_plan(experiment, models, arguments.choice,
                     [&](const std::string& name, std::size_t before, std::size_t of) {
                         if (before == 0) progress.total(of);
                         if (before > 0) progress.done(1);
                         progress.doing("model " + name);
                     });
}

ShapeOf recorded_shapes(const Experiment& experiment) {
    return [experiment, models = std::make_shared<std::optional<Catalogue>>()](const ModelRecord& record) {
        if (!*models) {
            Catalogue all = catalogue();
            add_own_models(all, experiment);
            *models = std::move(all);
        }
        const auto resolved = (*models)->resolve(record.name);
        const auto* model = std::get_if<ResolvedModel>(&resolved);
        if (!model || model->content_hash != record.sha256)
            throw InputError(fmt::format("model '{}' is missing or has changed since it was measured", record.name));
        return read_shape(model->shape_file).shape;
    };
}

std::filesystem::path results_of(const ExperimentArguments& arguments) {
    return arguments.results.empty() ? results_folder(experiment_file(arguments.file)) : arguments.results;
}

}  // namespace hausbench
