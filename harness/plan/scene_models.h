// Finds the two models of a scene and their poses.
#pragma once

#include "datasets/catalogue.h"
#include "harness/plan/plan.h"

#include <functional>
#include <map>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace hausbench {

struct ScenePose {
    Pose source, target;
};

struct SceneModels {
    std::variant<ResolvedModel, MissingModel> source, target;
    std::vector<ScenePose> poses{ScenePose{}};
    double source_largest = 0, target_largest = 0;  // largest |coordinate| of each shape, read only if one moves
    std::string missing;                            // why the scene cannot run; empty if it can
    RowStatus row = RowStatus::skipped;             // status of the scene's rows if it cannot run
};

// FindModel finds a model by name. ReadShape reads its shape, and is called only if a shape of the scene moves.
using FindModel = std::function<std::variant<ResolvedModel, MissingModel>(const std::string& name)>;
using ReadShape = std::function<Shape(const std::string& name, const ResolvedModel&)>;

// Finds the models of a scene with these two functions; an InputError that they throw becomes the reason why the
// scene cannot run.
SceneModels models_of(const ScenePlan& scene, const FindModel& find, const ReadShape& read);

// Finds the models of scenes, each model only once. This may fetch, generate or derive a model, which can take a while,
// so `say` is called before each model.
class ModelFinder {
public:
    ModelFinder(const Catalogue& catalogue, const SayModel& say) : catalogue_(catalogue), say_(say) {}

    // Counts the models of a scene. Call it for all scenes before the first find(), so that `say` knows the total.
    void expect(const ScenePlan& scene);

    SceneModels find(const ScenePlan& scene);

    const std::vector<ModelRow>& found() const { return found_; }

private:
    std::variant<ResolvedModel, MissingModel> find(const std::string& name);

    const Catalogue& catalogue_;
    const SayModel& say_;
    std::set<std::string> expected_, begun_;
    std::map<std::string, std::variant<ResolvedModel, MissingModel>> resolved_;
    std::vector<ModelRow> found_;
};

// Finds the models of scenes among the models that a result recorded. All others count as missing; no model is made.
class RecordedModels {
public:
    RecordedModels(const std::vector<ModelRecord>& records, ShapeOf shape_of);

    SceneModels find(const ScenePlan& scene) const;

private:
    std::map<std::string, const ModelRecord*> records_;
    ShapeOf shape_of_;
};

}  // namespace hausbench
