// Finds the models of a scene, and the poses of both.
#pragma once

#include "catalogue.h"
#include "plan/plan.h"

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
    double source_largest = 0, target_largest = 0;  // |coordinate|, where one of them moves
    std::string missing;                            // why it cannot run, empty if it can
    RowStatus row = RowStatus::skipped;             // the status of its rows then
};

// Finds each model once. Fetched, generated and derived models are made here, which can take a while: `say` hears of each.
class ModelFinder {
public:
    ModelFinder(const Catalogue& catalogue, const SayModel& say) : catalogue_(catalogue), say_(say) {}

    void expect(const ScenePlan& scene);  // before the first is looked for, so that `say` knows how many there are

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

}  // namespace hausbench
