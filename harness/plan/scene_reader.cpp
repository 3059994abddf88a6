#include "harness/plan/scene_reader.h"

#include "algorithms/error.h"
#include "datasets/corpus.h"
#include "datasets/paths.h"
#include "harness/plan/recording.h"
#include "harness/plan/severity.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

namespace hausbench {

namespace {

Motion read_motion(const ExperimentTable& scene, const toml::node& node, std::string_view key) {
    const toml::table* motion = node.as_table();
    if (!motion) scene.fail(node, fmt::format("'{}' must be a table such as {{ kind = \"static\" }}", key));
    const auto kind = (*motion)["kind"].value_or<std::string>("");
    const std::vector<std::string>& kinds = motion_kinds();
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
        scene.fail(node, fmt::format("unknown motion '{}'{}", kind, nearest_hint(kind, kinds)));
    ExperimentTable reader(scene.file(), *motion, {"the motion", motion_keys(kind).keys});
    if (scene.filling()) reader.fill(*scene.filling());
    if (kind == "translation") {
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
        const Vec3 axis = reader.vector("axis");
        if (axis.isZero(0)) reader.fail("'axis' must not be zero");
        return Rotation{axis, reader.number(reader.required("degrees"), "degrees"), reader.count("steps", 1, 10)};
    }
    if (kind == "poses") return PoseFile{scene.file().parent_path() / reader.text("file")};
    return Static{};
}

// Reads the key `exact`: one number, or a list with a number for each severity.
double exact_of(const ExperimentTable& table, const toml::node& node) {
    const toml::array* list = node.as_array();
    if (!list) return table.number(node, "exact");
    const toml::array* severities = table.find("severity") ? table.find("severity")->as_array() : nullptr;
    if (!severities || severities->size() != list->size())
        table.fail(node, "'exact' must be a number, or a list of as many as 'severity' has");
    return table.number(*list->get(table.filling()->index), "exact");
}

}  // namespace

ScenePlan read_scene(const ExperimentTable& table) {
    ScenePlan scene;
    scene.name = table.text("name");
    if (!table.find("sources") && !table.find("recording")) {
        if (const toml::node* node = table.find("targets"))
            table.fail(*node, "'targets' makes a matrix together with 'sources': give both, or 'source' and 'target'");
        scene.source = model_name(table, "source");
        scene.target = model_name(table, "target");
        scene.source_line = line_of(*table.find("source"));
        scene.target_line = line_of(*table.find("target"));
    }
    scene.note = table.text("note", "");
    scene.tolerances = table.tolerances("tolerances");
    scene.family = family_of(table);
    scene.severity = severity_of(table);
    if (const toml::node* node = table.find("motion")) scene.motion = read_motion(table, *node, "motion");
    if (const toml::node* node = table.find("target_motion")) {
        scene.target_motion = read_motion(table, *node, "target_motion");
        if (moves(scene.motion) && moves(scene.target_motion)) {
            const std::size_t a = pose_count(scene.motion), b = pose_count(scene.target_motion);
            if (a != b)
                table.fail(
                    *node,
                    fmt::format("'motion' has {} poses and 'target_motion' {}: give both as many, or make one static",
                                a, b));
        }
    }
    if (const toml::node* exact = table.find("exact")) {
        scene.exact = exact_of(table, *exact);
        if (scene.exact < 0) table.fail(*exact, fmt::format("'exact' must not be below 0, as {} is", scene.exact));
        if (moves(scene.motion) || moves(scene.target_motion))
            table.fail(*exact, "'exact' is the distance of one pose: remove it, or the scene's motions");
    }
    if (const toml::node* node = table.find("search")) {
        const std::string search = table.text("search");
        if (search != "nearest")
            table.fail(*node, fmt::format("'search' must be \"nearest\", not '{}'{}", search,
                                          nearest_hint(search, {"nearest"})));
        if (!table.find("sources"))
            table.fail(*node, "'search' is of a matrix: give 'sources' and 'targets', or remove it");
        if (moves(scene.motion) || moves(scene.target_motion))
            table.fail(*node, "'search' is among shapes that stand still: remove it, or the scene's motions");
        scene.search = true;
    }
    return scene;
}

void expect_pose_files(const ExperimentTable& table, const ScenePlan& scene) {
    for (const auto& [key, motion] :
         {std::pair{"motion", &scene.motion}, std::pair{"target_motion", &scene.target_motion}}) {
        try {
            if (std::holds_alternative<PoseFile>(*motion)) (void)pose_count(*motion);
        } catch (const InputError& error) {
            table.fail(*table.find(key), fmt::format("'{}': {}", key, error.what()));
        }
    }
}

// Expands a [[scene]] that names several models or a recording into one scene for each pair of models.
namespace {

constexpr std::string_view name_place = "{}";  // stands for the model's name in a scene with `each`

bool has_place(const std::string& text) { return text.find(name_place) != std::string::npos; }

std::string with(std::string text, const std::string& name) {
    for (std::size_t at = text.find(name_place); at != std::string::npos; at = text.find(name_place, at + name.size()))
        text.replace(at, name_place.size(), name);
    return text;
}

std::vector<std::string> names_of_corpus(const ExperimentTable& table, const toml::node& node) {
    const std::string each = node.value_or(std::string());
    const bool whole = each == "whole_corpus";
    if (!whole && each != "corpus")
        table.fail(node, "'each' must be \"corpus\", \"whole_corpus\" or a list of names of models");
    const std::filesystem::path file = corpus_beside(manifest_file());
    if (file.empty()) table.fail(node, "'each': there is no datasets/corpus.toml beside the manifest: add it");
    return corpus_names(file, whole);
}

// Returns one scene for each model that `each` names, with the model's name in place of every {}.
std::vector<ScenePlan> expand_each(const ExperimentTable& table, const ScenePlan& scene) {
    const toml::node& node = *table.find("each");
    for (const char* key : {"exact", "sources", "targets"}) {
        if (const toml::node* other = table.find(key))
            table.fail(*other, fmt::format("'{}' cannot be combined with 'each': remove one of the two", key));
    }
    if (!has_place(scene.name)) table.fail(*table.find("name"), "'name' has no {}, the place of each model's name");
    if (!has_place(scene.source) && !has_place(scene.target))
        table.fail(node, "neither 'source' nor 'target' has {}, the place of each model's name");
    const bool listed = node.is_array();
    const std::vector<std::string> names = listed ? table.texts("each") : names_of_corpus(table, node);
    if (names.empty()) table.fail(node, "'each' names no model: list some, or remove the scene");
    if (std::set<std::string>(names.begin(), names.end()).size() != names.size())
        table.fail(node, "'each' names a model twice");
    std::vector<ScenePlan> scenes;
    for (std::size_t i = 0; i < names.size(); ++i) {
        ScenePlan model_scene = scene;
        model_scene.each = scene.name;
        for (std::string ScenePlan::*text :
             {&ScenePlan::name, &ScenePlan::source, &ScenePlan::target, &ScenePlan::note})
            model_scene.*text = with(scene.*text, names[i]);
        model_scene.source_line = model_scene.target_line = line_of(listed ? *node.as_array()->get(i) : node);
        scenes.push_back(std::move(model_scene));
    }
    return scenes;
}

// Returns for each frame of a recording whether the scene uses it: all frames, the frames listed in `frames`, or every
// n-th frame (`every`).
std::vector<bool> frames_asked(const ExperimentTable& table, int count) {
    const toml::node *list = table.find("frames"), *every = table.find("every");
    if (list && every) table.fail(*every, "'every' and 'frames' both choose frames: remove one of the two");
    std::vector<bool> chosen(std::size_t(count), false);
    if (!list) {
        const int step = table.count("every", 1, 1);
        for (std::size_t i = 0; i < chosen.size(); i += std::size_t(step)) chosen[i] = true;
        return chosen;
    }
    const toml::array* frames = list->as_array();
    if (!frames || frames->empty()) table.fail(*list, "'frames' must be a list of numbers of frames");
    for (const toml::node& item : *frames) {
        const auto frame = item.value_exact<std::int64_t>();
        if (!frame || *frame < 0 || *frame >= count)
            table.fail(item, fmt::format("'frames': a frame is an integer from 0 to {}", count - 1));
        chosen[std::size_t(*frame)] = true;
    }
    return chosen;
}

// Returns one scene for each pair of models whose objects overlap. Each pose is one overlap in a chosen frame; a frame
// gives several poses if several objects have these models.
std::vector<ScenePlan> expand_recording(const ExperimentTable& table, const ScenePlan& scene) {
    const toml::node& node = *table.find("recording");
    for (const char* key :
         {"source", "target", "sources", "targets", "search", "each", "exact", "motion", "target_motion"}) {
        if (const toml::node* other = table.find(key))
            table.fail(*other, fmt::format("'{}' cannot be combined with 'recording', which gives the models and their "
                                           "poses: remove one of the two",
                                           key));
    }
    Recording recording;
    try {
        recording = read_recording(table.file().parent_path() / table.text("recording"));
    } catch (const InputError& error) {
        table.fail(node, fmt::format("'recording': {}", error.what()));
    }
    const std::vector<bool> chosen = frames_asked(table, recording.frames);
    std::vector<ScenePlan> scenes;
    for (const Recording::Pair& pair : recording.pairs) {
        ScenePlan pair_scene = scene;
        pair_scene.each = scene.name;
        pair_scene.name = fmt::format("{}: {} and {}", scene.name, pair.source, pair.target);
        pair_scene.source = pair.source;
        pair_scene.target = pair.target;
        pair_scene.source_line = pair_scene.target_line = line_of(node);
        Recorded source, target;
        for (std::size_t i = 0; i < pair.frames.size(); ++i) {
            if (!chosen[std::size_t(pair.frames[i])]) continue;
            pair_scene.frames.push_back(pair.frames[i]);
            source.poses.push_back(pair.source_poses[i]);
            target.poses.push_back(pair.target_poses[i]);
        }
        if (pair_scene.frames.empty()) continue;
        pair_scene.motion = std::move(source);
        pair_scene.target_motion = std::move(target);
        scenes.push_back(std::move(pair_scene));
    }
    if (scenes.empty())
        table.fail(node, "'recording': no objects overlap in the frames that are asked for: choose others");
    return scenes;
}

// Returns one scene for each pair of a source and a target.
std::vector<ScenePlan> expand_matrix(const ExperimentTable& table, const ScenePlan& scene) {
    for (const char* key : {"source", "target", "exact"}) {
        if (const toml::node* node = table.find(key))
            table.fail(*node,
                       fmt::format("'{}' is of one pair, and 'sources' makes a matrix: remove one of the two", key));
    }
    std::vector<std::string> sources = table.texts("sources"), targets = table.texts("targets");
    if (!table.find("targets")) targets = sources;
    for (const auto& [key, names] : {std::pair{"sources", sources}, std::pair{"targets", targets}}) {
        const toml::node& node = table.find(key) ? *table.find(key) : *table.find("sources");
        if (names.empty()) table.fail(node, fmt::format("'{}' names no model", key));
        if (std::set<std::string>(names.begin(), names.end()).size() != names.size())
            table.fail(node, fmt::format("'{}' names a model twice", key));
    }
    const auto line = [&](const char* key, std::size_t i) {
        return line_of(*table.find(table.find(key) ? key : "sources")->as_array()->get(i));
    };
    std::vector<ScenePlan> pairs;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        for (std::size_t k = 0; k < targets.size(); ++k) {
            const std::string &source = sources[i], &target = targets[k];
            if (scene.search && source == target) continue;  // the nearest target of a shape would be the shape itself
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
    if (pairs.empty()) table.fail(*table.find("search"), "'search' has no two models to compare: name other 'targets'");
    return pairs;
}

}  // namespace

std::vector<ScenePlan> expand(const ExperimentTable& table, const ScenePlan& scene) {
    if (table.find("recording")) return expand_recording(table, scene);
    for (const char* key : {"every", "frames"})
        if (const toml::node* node = table.find(key))
            table.fail(*node, fmt::format("'{}' chooses frames of a 'recording': give one, or remove it", key));
    if (table.find("each")) return expand_each(table, scene);
    for (const auto& [key, text] :
         {std::pair{"name", &scene.name}, {"source", &scene.source}, {"target", &scene.target}})
        if (has_place(*text)) table.fail(*table.find(key), fmt::format("'{}' has {{}}, but the scene no 'each'", key));
    if (!table.find("sources")) return {scene};
    return expand_matrix(table, scene);
}

}  // namespace hausbench
