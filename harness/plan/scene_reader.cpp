#include "harness/plan/scene_reader.h"

#include "algorithms/error.h"
#include "harness/plan/severity.h"

#include <fmt/format.h>

#include <utility>

namespace hausbench {

namespace {

Motion read_motion(const ExperimentTable& scene, const toml::node& node, std::string_view key) {
    const toml::table* motion = node.as_table();
    if (!motion) scene.fail(node, fmt::format("'{}' must be a table such as {{ kind = \"static\" }}", key));
    const auto read = [&](const std::vector<std::string>& keys) {
        ExperimentTable reader(scene.file(), *motion, "the motion", keys);
        if (scene.filling()) reader.fill(*scene.filling());
        return reader;
    };
    const auto kind = (*motion)["kind"].value_or<std::string>("");
    if (kind == "static") {
        (void)read({"kind"});
        return Static{};
    }
    if (kind == "translation") {
        const ExperimentTable reader = read({"kind", "from", "to", "steps", "of"});
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
        const ExperimentTable reader = read({"kind", "axis", "degrees", "steps"});
        const Vec3 axis = reader.vector("axis");
        if (axis.isZero(0)) reader.fail("'axis' must not be zero");
        return Rotation{axis, reader.number(reader.required("degrees"), "degrees"), reader.count("steps", 1, 10)};
    }
    if (kind == "poses") {
        const ExperimentTable reader = read({"kind", "file"});
        return PoseFile{scene.file().parent_path() / reader.text("file")};
    }
    scene.fail(node, fmt::format("unknown motion '{}'{}", kind,
                                 nearest_hint(kind, {"static", "translation", "rotation", "poses"})));
}

// One number, or one for each severity.
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

}  // namespace hausbench
