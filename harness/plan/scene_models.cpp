#include "harness/plan/scene_models.h"

#include "algorithms/error.h"
#include "datasets/shape_file.h"

#include <fmt/format.h>

namespace hausbench {

namespace {

// Fills in the poses and largest coordinates of both shapes, if one of them moves. A shape that stands still has the
// identity at every pose of the other. scene_reader.cpp has checked that two moving shapes have equally many poses.
void move(const ScenePlan& scene, SceneModels& models, const ReadShape& read) {
    if (!moves(scene.motion) && !moves(scene.target_motion)) return;
    const auto side = [&](const Motion& motion, const std::string& name, const auto& model, Pose ScenePose::*pose) {
        const Shape shape = read(name, std::get<ResolvedModel>(model));
        if (moves(motion)) {
            const auto moved = poses_of(motion, shape);
            models.poses.resize(moved.size());
            for (std::size_t p = 0; p < moved.size(); ++p) models.poses[p].*pose = moved[p];
        }
        return kind_of(shape) == ShapeKind::surface ? 0.0 : magnitude(points_of(shape));
    };
    models.source_largest = side(scene.motion, scene.source, models.source, &ScenePose::source);
    models.target_largest = side(scene.target_motion, scene.target, models.target, &ScenePose::target);
}

}  // namespace

std::variant<ResolvedModel, MissingModel> ModelFinder::find(const std::string& name) {
    if (const auto position = resolved_.find(name); position != resolved_.end()) return position->second;
    // A model that cannot be made is tried again in its next scene, but announced only once.
    if (begun_.insert(name).second) say_(name, begun_.size() - 1, expected_.size());
    auto result = catalogue_.resolve(name);
    if (const auto* good = std::get_if<ResolvedModel>(&result)) rows_.push_back({&catalogue_.find(name), *good});
    return resolved_[name] = std::move(result);
}

void ModelFinder::expect(const ScenePlan& scene) { expected_.insert({scene.source, scene.target}); }

SceneModels ModelFinder::find(const ScenePlan& scene) {
    return models_of(
        scene, [this](const std::string& name) { return find(name); },
        [](const std::string&, const ResolvedModel& model) { return read_shape(model.shape_file).shape; });
}

RecordedModels::RecordedModels(const std::vector<ModelRecord>& records, ShapeOf shape_of)
    : shape_of_(std::move(shape_of)) {
    for (const ModelRecord& record : records) records_[record.name] = &record;
}

SceneModels RecordedModels::find(const ScenePlan& scene) const {
    const auto resolved = [&](const std::string& name) -> std::variant<ResolvedModel, MissingModel> {
        const auto at = records_.find(name);
        if (at == records_.end()) return MissingModel{"the result has no such model"};
        const ModelRecord& record = *at->second;
        ResolvedModel model;
        model.content_hash = record.sha256;
        for (const ShapeKind kind : {ShapeKind::points, ShapeKind::mesh, ShapeKind::surface})
            if (to_string(kind) == record.kind) model.kind = kind;
        model.elements = Index(record.elements);
        model.vertices = Index(record.vertices);
        model.diagonal = record.diagonal;
        model.longest_side = record.longest_side;
        return model;
    };
    return models_of(scene, resolved,
                     [&](const std::string& name, const ResolvedModel&) { return shape_of_(*records_.at(name)); });
}

SceneModels models_of(const ScenePlan& scene, const FindModel& find, const ReadShape& read) {
    SceneModels models{MissingModel{}, MissingModel{}, {ScenePose{}}, 0, 0, "", RowStatus::skipped};
    try {
        models.source = find(scene.source);
        models.target = find(scene.target);
        for (const auto* side : {&models.source, &models.target}) {
            if (const auto* missing = std::get_if<MissingModel>(side)) models.missing = missing->reason;
        }
        if (models.missing.empty()) move(scene, models, read);
    } catch (const InputError& error) {  // a damaged file fails its own scenes, not the whole run
        models.missing = error.what();
        models.row = RowStatus::failed;
    }
    return models;
}

}  // namespace hausbench
