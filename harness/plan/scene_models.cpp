#include "plan/scene_models.h"

#include "error.h"
#include "shape_file.h"

#include <fmt/format.h>

namespace hausbench {

namespace {

// A static side has the identity beside every pose of the other; two that move have as many poses (scene_reader.cpp).
void move(const ScenePlan& scene, SceneModels& models) {
    if (!moves(scene.motion) && !moves(scene.target_motion)) return;
    const auto side = [&](const Motion& motion, const auto& model, Pose ScenePose::*pose) {
        const Shape shape = read_shape(std::get<ResolvedModel>(model).shape_file).shape;
        if (moves(motion)) {
            const auto moved = poses_of(motion, shape);
            models.poses.resize(moved.size());
            for (std::size_t p = 0; p < moved.size(); ++p) models.poses[p].*pose = moved[p];
        }
        return kind_of(shape) == ShapeKind::surface ? 0.0 : magnitude(points_of(shape));
    };
    models.source_largest = side(scene.motion, models.source, &ScenePose::source);
    models.target_largest = side(scene.target_motion, models.target, &ScenePose::target);
}

}  // namespace

std::variant<ResolvedModel, MissingModel> ModelFinder::find(const std::string& name) {
    if (const auto known = resolved_.find(name); known != resolved_.end()) return known->second;
    // One that cannot be made is looked for again in its next scene, but is one of those that came before.
    if (begun_.insert(name).second) say_(name, begun_.size() - 1, expected_.size());
    auto result = catalogue_.resolve(name);
    if (const auto* good = std::get_if<ResolvedModel>(&result)) found_.push_back({&catalogue_.find(name), *good});
    return resolved_[name] = std::move(result);
}

void ModelFinder::expect(const ScenePlan& scene) { expected_.insert({scene.source, scene.target}); }

SceneModels ModelFinder::find(const ScenePlan& scene) {
    SceneModels models{MissingModel{}, MissingModel{}, {ScenePose{}}, 0, 0, "", RowStatus::skipped};
    try {
        models.source = find(scene.source);
        models.target = find(scene.target);
        for (const auto* side : {&models.source, &models.target}) {
            if (const auto* missing = std::get_if<MissingModel>(side)) models.missing = missing->reason;
        }
        if (models.missing.empty()) move(scene, models);
    } catch (const InputError& error) {  // a damaged file spoils its scenes, not the sweep
        models.missing = error.what();
        models.row = RowStatus::failed;
    }
    return models;
}

}  // namespace hausbench
