#include "experiment.h"

#include "corpus.h"
#include "error.h"
#include "model_table.h"
#include "paths.h"
#include "recording.h"
#include "registry.h"
#include "toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

// One table of the file: every key must be one of `known`.
class Reader : public TomlReader {
public:
    Reader(const fs::path& file, const toml::table& table, const std::string& name,
           const std::vector<std::string>& known)
        : TomlReader(file, table, name, ":") {
        allow(known);
        refuse_other_keys();
    }

    double limit(std::string_view key, double otherwise) const {
        constexpr double most = 1e8;  // megabytes, seconds: no machine has more, and counters of nanoseconds hold it
        const toml::node* node = find(key);
        return node ? positive(*node, key, most) : otherwise;
    }
    Vec3 vector(std::string_view key) const {
        const toml::node& node = required(key);
        const toml::array* array = node.as_array();
        if (!array || array->size() != 3) fail(node, fmt::format("'{}' must be three numbers in brackets", key));
        Vec3 value;
        for (std::size_t i = 0; i < 3; ++i) value[Eigen::Index(i)] = number(*array->get(i), key);
        return value;
    }
    std::vector<double> tolerances(std::string_view key) const {
        std::vector<double> values;
        const toml::node* node = find(key);
        if (!node) return values;
        const toml::array* array = node->as_array();
        if (!array || array->empty()) fail(*node, fmt::format("'{}' must be a list of numbers above 0", key));
        for (const toml::node& item : *array) values.push_back(positive(item, key));
        return values;
    }
};

// Keys of `over` replace those of `base`; tables are merged key by key.
void merge(toml::table& base, const toml::table& over) {
    for (const auto& [key, node] : over) {
        toml::table* into = base[key].as_table();
        const toml::table* from = node.as_table();
        if (into && from) {
            merge(*into, *from);
        } else {
            base.insert_or_assign(key, node);
        }
    }
}

// All that there are: the two that every experiment has, and its own.
std::vector<std::string> profiles_of(const toml::table& table) {
    std::set<std::string> known = {"quick", "paper"};
    if (const toml::table* profiles = table["profile"].as_table()) {
        for (const auto& [name, node] : *profiles) known.insert(std::string(name.str()));
    }
    return {known.begin(), known.end()};
}

bool wanted(const Reader& reader, const std::string& profile, const std::vector<std::string>& known) {
    const auto profiles = reader.texts("profiles");
    for (const std::string& name : profiles) {
        if (std::find(known.begin(), known.end(), name) != known.end()) continue;
        reader.fail(*reader.find("profiles"), fmt::format("unknown profile '{}'{}", name, nearest_hint(name, known)));
    }
    return profiles.empty() || std::find(profiles.begin(), profiles.end(), profile) != profiles.end();
}

Motion read_motion(const fs::path& file, const Reader& scene, const toml::node& node, std::string_view key) {
    const toml::table* table = node.as_table();
    if (!table) scene.fail(node, fmt::format("'{}' must be a table such as {{ kind = \"static\" }}", key));
    const auto kind = (*table)["kind"].value_or<std::string>("");
    if (kind == "static") {
        Reader(file, *table, "the motion", {"kind"});
        return Static{};
    }
    if (kind == "translation") {
        Reader reader(file, *table, "the motion", {"kind", "from", "to", "steps", "of"});
        const auto of = reader.text("of", "diagonal");
        if (of != "diagonal" && of != "longest" && of != "absolute")
            reader.fail("'of' must be \"diagonal\", \"longest\" or \"absolute\"");
        using Of = Translation::Of;
        return Translation{reader.vector("from"), reader.vector("to"), reader.count("steps", 1, 10),
                           of == "diagonal"  ? Of::diagonal
                           : of == "longest" ? Of::longest
                                             : Of::absolute};
    }
    if (kind == "rotation") {
        Reader reader(file, *table, "the motion", {"kind", "axis", "degrees", "steps"});
        const Vec3 axis = reader.vector("axis");
        if (axis.isZero(0)) reader.fail("'axis' must not be zero");
        return Rotation{axis, reader.number(reader.required("degrees"), "degrees"), reader.count("steps", 1, 10)};
    }
    if (kind == "poses") {
        Reader reader(file, *table, "the motion", {"kind", "file"});
        return PoseFile{file.parent_path() / reader.text("file")};
    }
    scene.fail(node, fmt::format("unknown motion '{}'{}", kind,
                                 nearest_hint(kind, {"static", "translation", "rotation", "poses"})));
}

ParameterValue read_value(const Reader& reader, const toml::node& node, std::string_view key) {
    if (auto b = node.value_exact<bool>()) return *b;
    if (auto i = node.value_exact<std::int64_t>()) return *i;
    if (auto d = node.value_exact<double>()) return *d;
    if (auto s = node.value_exact<std::string>()) return *s;
    reader.fail(node,
                fmt::format("parameter '{}' must be a number, a text, true, false, or a list of them to sweep", key));
}

// Every combination of the swept values, the last parameter fastest, each checked against the solver's declarations.
std::vector<ParameterMap> read_options(const Reader& reader, const SolverEntry& entry) {
    std::vector<ParameterMap> combinations(1);
    const toml::node* node = reader.find("parameters");
    if (!node) return combinations;
    const toml::table* table = node->as_table();
    if (!table) reader.fail(*node, "'parameters' must be a table");
    for (const auto& [key, value] : *table) {
        std::vector<ParameterValue> values;
        if (const toml::array* list = value.as_array()) {
            for (const toml::node& item : *list) values.push_back(read_value(reader, item, key.str()));
            if (values.empty()) reader.fail(value, fmt::format("the list of parameter '{}' is empty", key.str()));
        } else {
            values.push_back(read_value(reader, value, key.str()));
        }
        std::vector<ParameterMap> next;
        for (const ParameterMap& combination : combinations) {
            for (const ParameterValue& one : values) {
                next.push_back(combination);
                next.back()[std::string(key.str())] = one;
            }
        }
        combinations = std::move(next);
    }
    for (const ParameterMap& combination : combinations) {
        try {
            Options(entry.info.name, entry.info.parameters, combination);
        } catch (const InputError& error) {
            reader.fail(*node, error.what());
        }
    }
    return combinations;
}

int line_of(const toml::node& node) { return int(node.source().begin.line); }

ScenePlan read_scene(const fs::path& file, const Reader& reader) {
    ScenePlan scene;
    scene.name = reader.text("name");
    if (!reader.find("sources") && !reader.find("recording")) {
        if (const toml::node* node = reader.find("targets"))
            reader.fail(*node, "'targets' makes a matrix together with 'sources': give both, or 'source' and 'target'");
        scene.source = reader.text("source");
        scene.target = reader.text("target");
        scene.source_line = line_of(*reader.find("source"));
        scene.target_line = line_of(*reader.find("target"));
    }
    scene.note = reader.text("note", "");
    if (const toml::node* node = reader.find("motion")) scene.motion = read_motion(file, reader, *node, "motion");
    if (const toml::node* node = reader.find("target_motion")) {
        scene.target_motion = read_motion(file, reader, *node, "target_motion");
        if (moves(scene.motion) && moves(scene.target_motion)) {
            const std::size_t a = pose_count(scene.motion), b = pose_count(scene.target_motion);
            if (a != b)
                reader.fail(
                    *node,
                    fmt::format("'motion' has {} poses and 'target_motion' {}: give both as many, or make one static",
                                a, b));
        }
    }
    if (const toml::node* exact = reader.find("exact")) {
        scene.exact = reader.number(*exact, "exact");
        if (scene.exact < 0) reader.fail(*exact, fmt::format("'exact' must not be below 0, as {} is", scene.exact));
        if (moves(scene.motion) || moves(scene.target_motion))
            reader.fail(*exact, "'exact' is the distance of one pose: remove it, or the scene's motions");
    }
    if (const toml::node* node = reader.find("search")) {
        const std::string search = reader.text("search");
        if (search != "nearest")
            reader.fail(*node, fmt::format("'search' must be \"nearest\", not '{}'{}", search,
                                           nearest_hint(search, {"nearest"})));
        if (!reader.find("sources"))
            reader.fail(*node, "'search' is of a matrix: give 'sources' and 'targets', or remove it");
        if (moves(scene.motion) || moves(scene.target_motion))
            reader.fail(*node, "'search' is among shapes that stand still: remove it, or the scene's motions");
        scene.search = true;
    }
    return scene;
}

// A file of poses that cannot be read is an error of the experiment: it is found before anything runs.
void expect_pose_files(const Reader& reader, const ScenePlan& scene) {
    for (const auto& [key, motion] :
         {std::pair{"motion", &scene.motion}, std::pair{"target_motion", &scene.target_motion}}) {
        try {
            if (std::holds_alternative<PoseFile>(*motion)) (void)pose_count(*motion);
        } catch (const InputError& error) {
            reader.fail(*reader.find(key), fmt::format("'{}': {}", key, error.what()));
        }
    }
}

constexpr std::string_view place = "{}";  // of the model's name, in a scene with `each`

bool has_place(const std::string& text) { return text.find(place) != std::string::npos; }

std::string with(std::string text, const std::string& name) {
    for (std::size_t at = text.find(place); at != std::string::npos; at = text.find(place, at + name.size()))
        text.replace(at, place.size(), name);
    return text;
}

std::vector<std::string> names_of_corpus(const Reader& reader, const toml::node& node) {
    if (node.value<std::string>() != "corpus")
        reader.fail(node, "'each' must be \"corpus\" or a list of names of models");
    const fs::path file = corpus_beside(manifest_file());
    if (file.empty()) reader.fail(node, "'each': there is no datasets/corpus.toml beside the manifest: add it");
    return corpus_names(file);
}

// One scene for each model that `each` names.
std::vector<ScenePlan> expand_each(const Reader& reader, const ScenePlan& scene) {
    const toml::node& node = *reader.find("each");
    for (const char* key : {"exact", "sources", "targets"}) {
        if (const toml::node* other = reader.find(key))
            reader.fail(*other, fmt::format("'{}' does not go with 'each': remove one of the two", key));
    }
    if (!has_place(scene.name)) reader.fail(*reader.find("name"), "'name' has no {}, the place of each model's name");
    if (!has_place(scene.source) && !has_place(scene.target))
        reader.fail(node, "neither 'source' nor 'target' has {}, the place of each model's name");
    const bool listed = node.is_array();
    const std::vector<std::string> names = listed ? reader.texts("each") : names_of_corpus(reader, node);
    if (names.empty()) reader.fail(node, "'each' names no model: list some, or remove the scene");
    if (std::set<std::string>(names.begin(), names.end()).size() != names.size())
        reader.fail(node, "'each' names a model twice");
    std::vector<ScenePlan> scenes;
    for (std::size_t i = 0; i < names.size(); ++i) {
        ScenePlan one = scene;
        one.each = scene.name;
        for (std::string ScenePlan::*text :
             {&ScenePlan::name, &ScenePlan::source, &ScenePlan::target, &ScenePlan::note})
            one.*text = with(scene.*text, names[i]);
        one.source_line = one.target_line = line_of(listed ? *node.as_array()->get(i) : node);
        scenes.push_back(std::move(one));
    }
    return scenes;
}

// The frames of a recording that a scene asks for: all, those it lists, or every n-th, the first of all included.
std::vector<bool> frames_asked(const Reader& reader, int count) {
    const toml::node *list = reader.find("frames"), *every = reader.find("every");
    if (list && every) reader.fail(*every, "'every' and 'frames' both choose frames: remove one of the two");
    std::vector<bool> asked(std::size_t(count), false);
    if (!list) {
        const int step = reader.count("every", 1, 1);
        for (std::size_t i = 0; i < asked.size(); i += std::size_t(step)) asked[i] = true;
        return asked;
    }
    const toml::array* frames = list->as_array();
    if (!frames || frames->empty()) reader.fail(*list, "'frames' must be a list of numbers of frames");
    for (const toml::node& item : *frames) {
        const auto frame = item.value_exact<std::int64_t>();
        if (!frame || *frame < 0 || *frame >= count)
            reader.fail(item, fmt::format("'frames': a frame is a whole number from 0 to {}", count - 1));
        asked[std::size_t(*frame)] = true;
    }
    return asked;
}

// One scene for each pair of models of which objects overlap: every pose is that of two objects in a frame.
std::vector<ScenePlan> expand_recording(const fs::path& file, const Reader& reader, const ScenePlan& scene) {
    const toml::node& node = *reader.find("recording");
    for (const char* key :
         {"source", "target", "sources", "targets", "search", "each", "exact", "motion", "target_motion"}) {
        if (const toml::node* other = reader.find(key))
            reader.fail(*other,
                        fmt::format("'{}' does not go with 'recording', which says it: remove one of the two", key));
    }
    Recording recording;
    try {
        recording = read_recording(file.parent_path() / reader.text("recording"));
    } catch (const InputError& error) {
        reader.fail(node, fmt::format("'recording': {}", error.what()));
    }
    const std::vector<bool> asked = frames_asked(reader, recording.frames);
    std::vector<ScenePlan> scenes;
    for (const Recording::Pair& pair : recording.pairs) {
        ScenePlan one = scene;
        one.each = scene.name;
        one.name = fmt::format("{}: {} and {}", scene.name, pair.source, pair.target);
        one.source = pair.source;
        one.target = pair.target;
        one.source_line = one.target_line = line_of(node);
        Recorded source, target;
        for (std::size_t i = 0; i < pair.frames.size(); ++i) {
            if (!asked[std::size_t(pair.frames[i])]) continue;
            one.frames.push_back(pair.frames[i]);
            source.poses.push_back(pair.source_poses[i]);
            target.poses.push_back(pair.target_poses[i]);
        }
        if (one.frames.empty()) continue;
        one.motion = std::move(source);
        one.target_motion = std::move(target);
        scenes.push_back(std::move(one));
    }
    if (scenes.empty())
        reader.fail(node, "'recording': no objects overlap in the frames that are asked for: choose others");
    return scenes;
}

// One scene for each source and each target, source by source, for each model, or for each pair of a recording; else the one that it is.
std::vector<ScenePlan> expand(const fs::path& file, const Reader& reader, const ScenePlan& scene) {
    if (reader.find("recording")) return expand_recording(file, reader, scene);
    for (const char* key : {"every", "frames"})
        if (const toml::node* node = reader.find(key))
            reader.fail(*node, fmt::format("'{}' chooses frames of a 'recording': give one, or remove it", key));
    if (reader.find("each")) return expand_each(reader, scene);
    for (const auto& [key, text] :
         {std::pair{"name", &scene.name}, {"source", &scene.source}, {"target", &scene.target}})
        if (has_place(*text))
            reader.fail(*reader.find(key), fmt::format("'{}' has {{}}, but the scene no 'each'", key));
    if (!reader.find("sources")) return {scene};
    for (const char* key : {"source", "target", "exact"}) {
        if (const toml::node* node = reader.find(key))
            reader.fail(*node,
                        fmt::format("'{}' is of one pair, and 'sources' makes a matrix: remove one of the two", key));
    }
    std::vector<std::string> sources = reader.texts("sources"), targets = reader.texts("targets");
    if (!reader.find("targets")) targets = sources;
    for (const auto& [key, names] : {std::pair{"sources", sources}, std::pair{"targets", targets}}) {
        const toml::node& node = reader.find(key) ? *reader.find(key) : *reader.find("sources");
        if (names.empty()) reader.fail(node, fmt::format("'{}' names no model", key));
        if (std::set<std::string>(names.begin(), names.end()).size() != names.size())
            reader.fail(node, fmt::format("'{}' names a model twice", key));
    }
    const auto line = [&](const char* key, std::size_t i) {
        return line_of(*reader.find(reader.find(key) ? key : "sources")->as_array()->get(i));
    };
    std::vector<ScenePlan> pairs;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        for (std::size_t k = 0; k < targets.size(); ++k) {
            const std::string &source = sources[i], &target = targets[k];
            if (scene.search && source == target) continue;  // at distance 0, which would end the search
            ScenePlan pair = scene;
            pair.source_line = line("sources", i);
            pair.target_line = line("targets", k);
            pair.matrix = scene.name;
            pair.name = fmt::format("{}: {} to {}", scene.name, source, target);
            pair.source = source;
            pair.target = target;
            pairs.push_back(std::move(pair));
        }
    }
    if (pairs.empty())
        reader.fail(*reader.find("search"), "'search' has no two models to compare: name other 'targets'");
    return pairs;
}

Quantity read_quantity(const Reader& reader, Quantity otherwise) {
    const std::string text = reader.text("quantity", std::string(to_string(otherwise)));
    std::vector<std::string> names;
    for (const Quantity quantity : quantities) {
        if (text == to_string(quantity)) return quantity;
        names.emplace_back(to_string(quantity));
    }
    reader.fail(*reader.find("quantity"),
                fmt::format("'quantity' must be directed (h), symmetric (H) or penetration (depth), not '{}'{}", text,
                            nearest_hint(text, names)));
}

SolverPlan read_solver(const Reader& reader, const Experiment& experiment) {
    SolverPlan solver;
    solver.quantity = read_quantity(reader, experiment.quantity);
    solver.threads = reader.count("threads", 1, experiment.threads);
    solver.name = reader.text("name");
    solver.label = reader.text("label", solver.name);
    solver.tolerances = reader.tolerances("tolerances");
    solver.scenes = reader.texts("scenes");
    solver.warm = reader.flag("warm", solver.warm);
    const auto& absent = solvers_not_built();
    if (std::any_of(absent.begin(), absent.end(), [&](const NotBuilt& s) { return s.name == solver.name; })) {
        solver.options.resize(1);  // its parameters are unknown here; its cases become `not_built`
        return solver;
    }
    const SolverEntry* entry = nullptr;
    try {
        entry = &find_solver(solver.name);
    } catch (const InputError& error) {
        reader.fail(*reader.find("name"), error.what());
    }
    solver.options = read_options(reader, *entry);
    if (solver.warm && !entry->info.warm) {
        reader.fail(
            *reader.find("warm"),
            fmt::format("'warm': the solver '{}' carries nothing from one pose to the next: remove it", solver.name));
    }
    return solver;
}

// The pairs of a search make sense together only, and each is a cold case.
void expect_searches(const Reader& reader, const SolverPlan& solver, const std::vector<ScenePlan>& scenes) {
    const auto names = [&](const std::string& name) {
        return std::find(solver.scenes.begin(), solver.scenes.end(), name) != solver.scenes.end();
    };
    for (const ScenePlan& scene : scenes) {
        if (!scene.search) continue;
        if (names(scene.name))
            reader.fail(*reader.find("scenes"), fmt::format("'{}' is a pair of a search: name the whole of it, '{}'",
                                                            scene.name, scene.matrix));
        if (solver.warm && (solver.scenes.empty() || names(scene.matrix)))
            reader.fail(
                *reader.find("warm"),
                fmt::format("'warm' does not go with '{}', a search: remove it, or name other 'scenes'", scene.matrix));
    }
}

const std::vector<std::string> root_keys = {
    "title",    "paper",   "tolerances", "of",      "floor", "cutoff", "budget", "repeats",
    "rounds",   "trace",   "limits",     "profile", "model", "scene",  "solver", "expected_unsound",
    "quantity", "threads", "fields",     "stages"};

// Labels of all solvers of the file count, whatever their profile.
std::vector<std::string> read_expected_unsound(const Reader& root, const std::vector<std::string>& labels) {
    const auto expected = root.texts("expected_unsound");
    for (const std::string& label : expected) {
        if (std::find(labels.begin(), labels.end(), label) != labels.end()) continue;
        root.fail(*root.find("expected_unsound"), fmt::format("'expected_unsound' names no solver of this file: '{}'{}",
                                                              label, nearest_hint(label, labels)));
    }
    return expected;
}

Limits read_limits(const fs::path& file, const Reader& root) {
    Limits limits;
    const toml::node* node = root.find("limits");
    if (!node) return limits;
    if (!node->is_table()) root.fail(*node, "'limits' must be a table");
    Reader reader(file, *node->as_table(), "[limits]", {"case_seconds", "prepare_seconds", "memory_mb"});
    limits.case_seconds = reader.limit("case_seconds", limits.case_seconds);
    limits.prepare_seconds = reader.limit("prepare_seconds", limits.prepare_seconds);
    limits.memory_bytes = std::int64_t(reader.limit("memory_mb", double(limits.memory_bytes >> 20)) * 1048576);
    return limits;
}

toml::table with_profile(const fs::path& file, toml::table table, const std::string& profile) {
    const auto known = profiles_of(table);
    if (std::find(known.begin(), known.end(), profile) == known.end()) {
        throw InputError(
            fmt::format("{}: unknown profile '{}'{}", file.string(), profile, nearest_hint(profile, known)));
    }
    if (const toml::table* over = table["profile"][profile].as_table()) {
        auto keys = root_keys;
        std::erase(keys, "profile");
        Reader(file, *over, fmt::format("[profile.{}]", profile), keys);
        toml::table copy = *over;
        merge(table, copy);
    }
    return table;
}

toml::table parsed(const fs::path& file, const std::string& text, const std::string& profile) {
    try {
        return with_profile(file, toml::parse(text, file.string()), profile);
    } catch (const toml::parse_error& error) {
        throw InputError(fmt::format("{}:{}:{}: {}", file.string(), error.source().begin.line,
                                     error.source().begin.column, error.description()));
    }
}

}  // namespace

std::vector<ModelInfo> models_of(const fs::path& file, const std::string& toml, const std::string& profile) {
    return read_models(file, parsed(file, toml, profile), ModelsOf::experiment);
}

double unit_of(const std::string& of, double diagonal, double longest_side) {
    return of == "diagonal" ? diagonal : of == "longest" ? longest_side : 1;
}

Experiment read_experiment(const fs::path& file, const std::string& profile) {
    Experiment experiment;
    experiment.file = file;
    experiment.stem = file.stem().string();
    experiment.profile = profile;
    if (fs::is_directory(file))
        throw InputError(fmt::format("{}: is a folder: name an experiment file (.toml)", file.string()));
    std::ifstream in(file);
    if (!in)
        throw InputError(
            fmt::format("{}: cannot open it: name an experiment file, such as one below experiments/", file.string()));
    std::ostringstream text;
    text << in.rdbuf();
    experiment.toml = text.str();

    const toml::table table = parsed(file, experiment.toml, profile);
    Reader root(file, table, "", root_keys);
    experiment.models = read_models(file, table, ModelsOf::experiment);
    experiment.title = root.text("title");
    experiment.paper = root.text("paper", "");
    experiment.tolerances = root.tolerances("tolerances");
    experiment.of = root.text("of", experiment.of);
    if (std::find(tolerance_units.begin(), tolerance_units.end(), experiment.of) == tolerance_units.end()) {
        root.fail(*root.find("of"), fmt::format("'of' must be diagonal, longest, absolute or lower, not '{}'{}",
                                                experiment.of, nearest_hint(experiment.of, tolerance_units)));
    }
    experiment.quantity = read_quantity(root, experiment.quantity);
    experiment.floor = root.length("floor", experiment.floor);
    experiment.cutoff = root.length("cutoff", experiment.cutoff);
    experiment.budget = root.count("budget", 0, -1);
    experiment.threads = root.count("threads", 1, experiment.threads);
    experiment.repeats = root.count("repeats", 0, experiment.repeats);
    experiment.rounds = root.count("rounds", 1, experiment.rounds);
    experiment.trace = root.flag("trace", experiment.trace);
    experiment.fields = root.flag("fields", experiment.fields);
    experiment.stages = root.flag("stages", experiment.stages);
    experiment.limits = read_limits(file, root);

    const auto profiles = profiles_of(table);
    std::set<std::string> names, names_of_all;  // of scenes: in this profile, in any
    std::vector<std::string> labels;            // of solvers, in any profile
    for (const char* kind : {"scene", "solver"}) {
        const toml::node* node = root.find(kind);
        const toml::array* array = node ? node->as_array() : nullptr;
        if (!array) throw InputError(fmt::format("{}: no [[{}]] in it: add at least one", file.string(), kind));
        for (const toml::node& item : *array) {
            if (!item.is_table()) root.fail(item, fmt::format("write it as [[{}]]", kind));
            if (std::string_view(kind) == "scene") {
                Reader reader(file, *item.as_table(), "[[scene]]",
                              {"name", "source", "target", "sources", "targets", "search", "each", "note", "exact",
                               "motion", "target_motion", "recording", "every", "frames", "profiles"});
                names_of_all.insert(reader.text("name"));
                const ScenePlan scene = read_scene(file, reader);
                const auto pairs = expand(file, reader, scene);
                for (const ScenePlan& pair : pairs) names_of_all.insert(pair.name);
                if (!wanted(reader, profile, profiles)) continue;
                expect_pose_files(reader, scene);
                experiment.scenes.insert(experiment.scenes.end(), pairs.begin(), pairs.end());
                bool fresh = names.insert(scene.name).second;
                for (const ScenePlan& pair : pairs)
                    fresh = fresh && ((pair.matrix.empty() && pair.each.empty()) || names.insert(pair.name).second);
                if (!fresh)
                    reader.fail(fmt::format("two scenes named '{}' in profile {}: rename one", scene.name, profile));
            } else {
                Reader reader(
                    file, *item.as_table(), "[[solver]]",
                    {"name", "label", "parameters", "tolerances", "scenes", "quantity", "threads", "warm", "profiles"});
                labels.push_back(reader.text("label", reader.text("name")));
                if (!wanted(reader, profile, profiles)) continue;
                SolverPlan solver = read_solver(reader, experiment);
                if (solver.tolerances.empty()) solver.tolerances = experiment.tolerances;
                if (solver.tolerances.empty())
                    reader.fail("no 'tolerances', here or at the top: a tolerance has no default");
                for (const std::string& scene : solver.scenes) {
                    if (names_of_all.contains(scene)) continue;
                    reader.fail(fmt::format("unknown scene '{}'{}", scene,
                                            nearest_hint(scene, {names_of_all.begin(), names_of_all.end()})));
                }
                expect_searches(reader, solver, experiment.scenes);
                // None where all its scenes belong to other profiles; of an empty list, it would run on every scene.
                if (!solver.scenes.empty() && std::none_of(solver.scenes.begin(), solver.scenes.end(),
                                                           [&](const auto& s) { return names.contains(s); }))
                    continue;
                experiment.solvers.push_back(std::move(solver));
            }
        }
    }
    experiment.expected_unsound = read_expected_unsound(root, labels);
    return experiment;
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

}  // namespace hausbench
