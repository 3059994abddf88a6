// Finds the two models of a scene, and lists the poses of both.
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

// FindModel looks up a model by name. ReadShape loads the shape of a model; it is called only if a shape of the scene
// moves.
using FindModel = std::function<std::variant<ResolvedModel, MissingModel>(const std::string& name)>;
using ReadShape = std::function<Shape(const std::string& name, const ResolvedModel&)>;

// Finds the models and poses of a scene. If `find` or `read` throws InputError, its message becomes the reason why the
// scene cannot run.
SceneModels models_of(const ScenePlan& scene, const FindModel& find, const ReadShape& read);

// Finds the models of scenes. Fetches, generates or derives each model once, which can take a while, so `say` is called
// first.
class ModelFinder {
public:
    ModelFinder(const Catalogue& catalogue, const SayModel& say) : catalogue_(catalogue), say_(say) {}

    // Counts the models of a scene. Call this for all scenes before the first find(), so that `say` gets the right
    // total.
    void expect(const ScenePlan& scene);

    SceneModels find(const ScenePlan& scene);

    const std::vector<ModelRow>& rows() const { return rows_; }

private:
    std::variant<ResolvedModel, MissingModel> find(const std::string& name);

    const Catalogue& catalogue_;
    const SayModel& say_;
    std::set<std::string> expected_, begun_;
    std::map<std::string, std::variant<ResolvedModel, MissingModel>> resolved_;
    std::vector<ModelRow> rows_;
};

// Finds the models of scenes among the models that a result recorded. Makes no models: a model that was not recorded
// counts as missing.
class RecordedModels {
public:
    RecordedModels(const std::vector<ModelRecord>& records, ShapeOf shape_of);

    SceneModels find(const ScenePlan& scene) const;

private:
    std::map<std::string, const ModelRecord*> records_;
    ShapeOf shape_of_;
};

}  // namespace hausbench
