#include "harness/plan/experiment.h"

#include "algorithms/error.h"
#include "algorithms/plugin.h"
#include "algorithms/registry.h"
#include "datasets/model_table.h"
#include "datasets/toml_reader.h"
#include "harness/plan/keys.h"
#include "harness/plan/plugin_code.h"
#include "harness/plan/scene_reader.h"
#include "harness/plan/severity.h"
#include "harness/plan/solver_reader.h"
#include "process/whole_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <utility>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

// Merges `over` into `base`: a value of `over` replaces the value with the same key, and two tables with the same key
// are merged recursively. Moves the nodes, because a copied node loses its line number.
void merge(toml::table& base, toml::table& over) {
    for (auto&& [key, node] : over) {
        toml::table* into = base[key].as_table();
        toml::table* from = node.as_table();
        if (into && from) {
            merge(*into, *from);
        } else {
            node.visit([&, &name = key](auto& value) { base.insert_or_assign(name, std::move(value)); });
        }
    }
}

// Returns the names of all profiles: `quick`, `paper` and those that the file defines.
std::vector<std::string> profiles_of(const toml::table& table) {
    std::set<std::string> names = {"quick", "paper"};
    if (const toml::table* profiles = table["profile"].as_table()) {
        for (const auto& [name, node] : *profiles) names.insert(std::string(name.str()));
    }
    return {names.begin(), names.end()};
}

// Returns whether a scene or solver belongs to the profile. It does if its key `profiles` lists the profile or is
// missing.
bool wanted(const ExperimentTable& reader, const std::string& profile, const std::vector<std::string>& existing) {
    const auto profiles = reader.texts("profiles");
    for (const std::string& name : profiles) {
        if (std::find(existing.begin(), existing.end(), name) != existing.end()) continue;
        reader.fail(*reader.find("profiles"),
                    fmt::format("unknown profile '{}'{}", name, nearest_hint(name, existing)));
    }
    return profiles.empty() || std::find(profiles.begin(), profiles.end(), profile) != profiles.end();
}

// Reads the key `expected_unsound`. `labels` holds the labels of all solvers in the file, because the key may name
// solvers of any profile.
std::vector<std::string> read_expected_unsound(const ExperimentTable& root, const std::vector<std::string>& labels) {
    const auto expected = root.texts("expected_unsound");
    for (const std::string& label : expected) {
        if (std::find(labels.begin(), labels.end(), label) != labels.end()) continue;
        root.fail(*root.find("expected_unsound"), fmt::format("'expected_unsound' names no solver of this file: '{}'{}",
                                                              label, nearest_hint(label, labels)));
    }
    return expected;
}

// Returns all tables of one kind, such as [[scene]], and checks their keys. Throws InputError if the file has none.
std::vector<ExperimentTable> tables_of(const ExperimentTable& root, const KeyTable& keys) {
    const std::string kind = keys.title.substr(2, keys.title.size() - 4);  // without brackets
    const toml::node* node = root.find(kind);
    const toml::array* array = node ? node->as_array() : nullptr;
    if (node && !array) root.fail(*node, fmt::format("'{}' must be written as {}", kind, keys.title));
    if (!array) throw InputError(fmt::format("{}: no {} in it: add at least one", root.file().string(), keys.title));
    std::vector<ExperimentTable> tables;
    for (const toml::node& item : *array) {
        if (!item.is_table()) root.fail(item, fmt::format("write it as {}", keys.title));
        tables.emplace_back(root.file(), *item.as_table(), keys);
    }
    return tables;
}

// Loads the plug-ins that the experiment names, except those that are already loaded.
void load_plugins(const ExperimentTable& root, const fs::path& folder) {
    for (const std::string& name : root.texts("plugins")) {
        const fs::path library = fs::absolute(folder / name).lexically_normal();
        const auto is_it = [&](const Plugin& plugin) { return plugin.file == library; };
        if (std::any_of(plugins().begin(), plugins().end(), is_it)) continue;
        try {
            load_plugin_in_copy(library);
        } catch (const InputError& error) {
            root.fail(*root.find("plugins"), error.what());
        }
    }
}

// Checks the names and values in each claim. `hausbench draw` decides whether the claims are true.
void check_claims(const ExperimentTable& root, const std::vector<std::string>& labels) {
    if (!root.find("claim")) return;
    for (const ExperimentTable& claim : tables_of(root, claim_keys())) {
        for (const char* key : {"solver", "faster_than"}) {
            const std::string name = claim.text(key), label = name.substr(0, name.find('('));
            if (std::find(labels.begin(), labels.end(), label) != labels.end()) continue;
            claim.fail(*claim.find(key), fmt::format("'{}' names no solver of this file: '{}'{}", key, name,
                                                     nearest_hint(label, labels)));
        }
        if (claim.text("solver") == claim.text("faster_than"))
            claim.fail(*claim.find("faster_than"), "'faster_than' names the solver itself: name another");
        claim.limit("by", 1);
        const std::string on = claim.text("on", "average");
        if (on != "average" && on != "every")
            claim.fail(*claim.find("on"), fmt::format("'on' must be average or every, not '{}'", on));
    }
}

void read_limits(const ExperimentTable& root, Experiment& experiment) {
    Limits& limits = experiment.limits;
    const toml::node* node = root.find("limits");
    if (!node) return;
    if (!node->is_table()) root.fail(*node, "'limits' must be a table");
    ExperimentTable reader(root.file(), *node->as_table(), limit_keys());
    limits.case_seconds = reader.limit("case_seconds", limits.case_seconds);
    limits.prepare_seconds = reader.limit("prepare_seconds", limits.prepare_seconds);
    limits.memory_bytes = std::int64_t(reader.limit("memory_mb", double(limits.memory_bytes >> 20)) * 1048576);
    experiment.reference_seconds = reader.limit("reference_seconds", experiment.reference_seconds);
}

// Checks the keys of all profiles, even of those that are not run, so that misspelt keys are found.
void expect_profiles(const fs::path& file, const toml::table& table) {
    const toml::node* profiles = table.get("profile");
    if (!profiles) return;
    const ExperimentTable root(file, table, top_keys());
    if (!profiles->is_table()) root.fail(*profiles, "'profile' must be a table: write [profile.NAME]");
    KeyTable keys = top_keys();
    std::erase_if(keys.keys, [](const Key& key) { return key.name == "profile"; });
    for (const auto& [name, node] : *profiles->as_table()) {
        if (!node.is_table())
            root.fail(node, fmt::format("'profile.{0}' must be a table: write [profile.{0}]", name.str()));
        keys.title = fmt::format("[profile.{}]", name.str());
        ExperimentTable(file, *node.as_table(), keys);
    }
}

toml::table with_profile(const fs::path& file, toml::table table, const std::string& profile) {
    const auto profiles = profiles_of(table);
    if (std::find(profiles.begin(), profiles.end(), profile) == profiles.end()) {
        throw InputError(
            fmt::format("{}: unknown profile '{}'{}", file.string(), profile, nearest_hint(profile, profiles)));
    }
    expect_profiles(file, table);
    if (toml::table* over = table["profile"][profile].as_table()) merge(table, *over);
    return table;
}

toml::table parsed(const fs::path& file, const std::string& text, const std::string& profile) {
    try {
        return with_profile(file, toml::parse(text, file.string()), profile);
    } catch (const toml::parse_error& error) {
        throw InputError(one_line(fmt::format("{}:{}:{}: {}", file.string(), error.source().begin.line,
                                              error.source().begin.column, error.description())));
    }
}

std::vector<ModelInfo> own_models(const ExperimentTable& root, const std::string& profile) {
    std::vector<ModelInfo> models = read_models(root, ModelsOf::experiment);
    const auto profiles = profiles_of(root.table());
    for (const ExperimentTable& scene : tables_of(root, scene_keys())) {
        if (!wanted(scene, profile, profiles)) continue;
        for (const ExperimentTable& variant : by_severity(scene)) {
            std::vector<ModelInfo> of_scene = models_in(variant);
            std::move(of_scene.begin(), of_scene.end(), std::back_inserter(models));
        }
    }
    return models;
}

// Reads everything in an experiment except its scenes and solvers.
void read_top(const ExperimentTable& root, Experiment& experiment) {
    experiment.models = own_models(root, experiment.profile);
    experiment.title = root.text("title");
    experiment.paper = root.text("paper", "");
    experiment.tolerances = root.tolerances("tolerances");
    experiment.of = root.text("of", experiment.of);
    if (std::find(tolerance_units.begin(), tolerance_units.end(), experiment.of) == tolerance_units.end()) {
        root.fail(*root.find("of"), fmt::format("'of' must be diagonal, longest, absolute or lower, not '{}'{}",
                                                experiment.of, nearest_hint(experiment.of, tolerance_units)));
    }
    experiment.quantity = read_quantity(root, experiment.quantity);
    experiment.statistics = read_statistics(root, {});
    experiment.weigh = read_weigh(root, experiment.weigh);
    experiment.floor = root.length("floor", experiment.floor);
    experiment.cutoff = root.length("cutoff", experiment.cutoff);
    experiment.budget = root.count("budget", 0, -1);
    experiment.threads = root.count("threads", 1, experiment.threads);
    experiment.repeats = root.count("repeats", 0, experiment.repeats);
    experiment.rounds = root.count("rounds", 1, experiment.rounds);
    experiment.trace = root.flag("trace", experiment.trace);
    experiment.fields = root.flag("fields", experiment.fields);
    experiment.stages = root.flag("stages", experiment.stages);
    experiment.reference = root.flag("reference", experiment.reference);
    read_limits(root, experiment);
}

// Names of scenes, and of [[scene]] tables that make several scenes, which a solver may list in `scenes`. `wanted`: in
// the profile that is run; `all`: in any profile.
struct SceneNames {
    std::set<std::string> wanted, all;
};

SceneNames read_scenes(const ExperimentTable& root, const std::vector<std::string>& profiles, Experiment& experiment) {
    SceneNames names;
    std::vector<std::string> swept;
    for (const ExperimentTable& given : tables_of(root, scene_keys())) {
        names.all.insert(given.text("name"));
        const bool is_wanted = wanted(given, experiment.profile, profiles);
        if (is_wanted) swept.push_back(given.text("name"));
        for (const ExperimentTable& table : by_severity(given)) {
            const ScenePlan scene = read_scene(table);
            const auto pairs = expand(table, scene);
            for (const ScenePlan& pair : pairs) names.all.insert(pair.name);
            if (!is_wanted) continue;
            expect_pose_files(table, scene);
            bool fresh = names.wanted.insert(scene.name).second;
            for (ScenePlan pair : pairs) {
                fresh = fresh && ((pair.matrix.empty() && pair.each.empty()) || names.wanted.insert(pair.name).second);
                if (table.filling()) pair.each = given.text("name");
                experiment.scenes.push_back(std::move(pair));
            }
            if (!fresh)
                table.fail(
                    fmt::format("two scenes named '{}' in profile {}: rename one", scene.name, experiment.profile));
        }
    }
    names.wanted.insert(swept.begin(), swept.end());  // a solver may also list a sweep as a whole
    return names;
}

// Reads the solvers of the profile into `experiment`. Returns the labels of all solvers in the file, whatever their
// profile.
std::vector<std::string> read_solvers(const ExperimentTable& root, const std::vector<std::string>& profiles,
                                      const SceneNames& names, Experiment& experiment) {
    std::vector<std::string> labels;
    for (const ExperimentTable& table : tables_of(root, solver_keys())) {
        labels.push_back(table.text("label", table.text("name")));
        if (!wanted(table, experiment.profile, profiles)) continue;
        SolverPlan solver = read_solver(table, experiment);
        if (solver.tolerances.empty()) solver.tolerances = experiment.tolerances;
        if (solver.tolerances.empty()) table.fail("no 'tolerances', here or at the top: a tolerance has no default");
        for (const std::string& scene : solver.scenes) {
            if (names.all.contains(scene)) continue;
            table.fail(
                fmt::format("unknown scene '{}'{}", scene, nearest_hint(scene, {names.all.begin(), names.all.end()})));
        }
        expect_searches(table, solver, experiment.scenes);
        // Skips a solver whose scenes all belong to other profiles.
        if (!solver.scenes.empty() && std::none_of(solver.scenes.begin(), solver.scenes.end(),
                                                   [&](const auto& s) { return names.wanted.contains(s); }))
            continue;
        experiment.solvers.push_back(std::move(solver));
    }
    return labels;
}

std::string text_of(const fs::path& file) {
    if (fs::is_directory(file))
        throw InputError(fmt::format("{}: is a folder: name an experiment file (.toml)", file.string()));
    expect_no_device(file);
    std::ifstream in(file);
    if (!in)
        throw InputError(
            fmt::format("{}: cannot open it: name an experiment file, such as one below experiments/", file.string()));
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

Experiment read_text(const fs::path& file, const std::string& stem, std::string text, const std::string& profile,
                     PlugIns plug_ins) {
    Experiment experiment;
    experiment.file = file;
    experiment.stem = stem;
    experiment.profile = profile;
    experiment.toml = std::move(text);

    const toml::table table = parsed(file, experiment.toml, profile);
    const ExperimentTable root(file, table, top_keys());
    read_top(root, experiment);
    const auto profiles = profiles_of(table);
    if (root.find("plugins") && plug_ins == PlugIns::refused)
        throw InputError(fmt::format("{}: names plug-ins, which are loaded only to run it", file.string()));
    load_plugins(root, experiment.folder());
    const SceneNames names = read_scenes(root, profiles, experiment);
    const auto labels = read_solvers(root, profiles, names, experiment);
    experiment.expected_unsound = read_expected_unsound(root, labels);
    check_claims(root, labels);
    return experiment;
}

}  // namespace

std::vector<ModelInfo> models_of(const fs::path& file, const std::string& toml, const std::string& profile) {
    const toml::table table = parsed(file, toml, profile);
    return own_models(ExperimentTable(file, table, top_keys()), profile);
}

Experiment read_experiment(const fs::path& file, const std::string& profile, PlugIns plug_ins) {
    return read_text(file, file.stem().string(), text_of(file), profile, plug_ins);
}

Experiment read_experiment_with(const fs::path& file, const std::string& solver, const std::string& profile) {
    static_cast<void>(read_experiment(file, profile));  // loads the plug-ins; reports mistakes with their lines
    const auto& parameters = find_solver(solver).info.parameters;
    if (std::any_of(parameters.begin(), parameters.end(),
                    [](const ParameterSpec& parameter) { return parameter.required(); }))
        throw InputError(fmt::format("--with {}: needs parameters: write a [[solver]] with them in a copy of {}",
                                     solver, file.string()));
    toml::table table = toml::parse(text_of(file), file.string());
    const auto forget = [](toml::table& section) {
        for (const char* key : {"solver", "claim", "expected_unsound"}) section.erase(key);
    };
    forget(table);
    if (toml::table* profiles = table["profile"].as_table()) {
        for (auto&& [name, node] : *profiles)
            if (toml::table* section = node.as_table()) forget(*section);
    }
    table.insert_or_assign("solver", toml::array{toml::table{{"name", solver}}});
    if (const auto title = table["title"].value<std::string>())
        table.insert_or_assign("title", fmt::format("{}: {}", *title, solver));
    std::ostringstream text;
    text << table << '\n';
    return read_text(file, fmt::format("{}_{}", file.stem().string(), solver), text.str(), profile, PlugIns::loaded);
}

Experiment in_profile(const Experiment& experiment, const std::string& profile) {
    return read_text(experiment.file, experiment.stem, experiment.toml, profile, PlugIns::loaded);
}

std::vector<fs::path> experiment_files(const fs::path& folder) {
    std::vector<fs::path> files;
    if (fs::exists(folder)) {
        for (const auto& entry : fs::recursive_directory_iterator(folder)) {
            if (entry.path().extension() == ".toml") files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) { return a.stem() < b.stem(); });
    for (std::size_t i = 1; i < files.size(); ++i) {
        if (files[i].stem() == files[i - 1].stem()) {
            throw InputError(fmt::format("{} and {}: two experiments of one stem: rename one", files[i - 1].string(),
                                         files[i].string()));
        }
    }
    return files;
}

bool unsound_expected(const Case& spec, const Experiment& experiment) {
    if (spec.certified == 1) return false;
    const auto& labels = experiment.expected_unsound;
    if (std::find(labels.begin(), labels.end(), spec.label) != labels.end()) return true;
    return std::any_of(solvers().begin(), solvers().end(), [&](const SolverEntry& entry) {
        return entry.info.name == spec.solver && !entry.info.known_wrong.empty();
    });
}

}  // namespace hausbench
