// The distances that the stability suite states are those of its shapes: each is held against exact arithmetic, or against a reference
// that shares no code with the solvers.
#include "catalogue.h"
#include "plan/experiment.h"
#include "plan/own_models.h"
#include "shape_file.h"
#include "temporary_folder.h"
#include "truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

namespace hausbench {
namespace {

const std::filesystem::path root = HAUSBENCH_SOURCE;

// The double next to the true distance is what a scene may state.
void expect_stated(double stated, const Truth& truth, const std::string& scene) {
    const double infinite = std::numeric_limits<double>::infinity();
    const double low = std::nextafter(stated, 0.0), high = std::nextafter(stated, infinite);
    const auto square = [](double x) -> exact::Rational { return exact::Rational(x) * exact::Rational(x); };
    EXPECT_LE(truth.squared, square(high)) << scene;  // of points the distance, of meshes that of a vertex
    if (truth.points) {
        EXPECT_GE(truth.squared, square(low)) << scene;
        return;
    }
    EXPECT_LE(truth.low, Real(high)) << scene;
    EXPECT_GE(truth.high, Real(low)) << scene;
}

TEST(StabilitySuite, StatedDistancesAreThoseOfTheShapes) {
    const TemporaryFolder folder;
    const Experiment experiment =
        read_experiment(root / "experiments" / "stability" / "stability_matrix.toml", "quick");
    Catalogue catalogue(root / "datasets" / "manifest.toml", folder.path(), {});
    add_own_models(catalogue, experiment);
    int checked = 0, too_large = 0;
    for (const ScenePlan& scene : experiment.scenes) {
        if (std::isnan(scene.exact)) continue;
        const auto shape = [&](const std::string& name) {
            return read_shape(std::get<ResolvedModel>(catalogue.resolve(name)).shape_file).shape;
        };
        const Scene shapes{shape(scene.source), shape(scene.target)};
        if (kind_of(shapes.source) == ShapeKind::surface) continue;
        // What makes these hard is their number, and the smaller ones of the same family are checked.
        if (double(element_count(shapes.source)) * double(element_count(shapes.target)) > 4e4) {
            ++too_large;
            continue;
        }
        expect_stated(scene.exact, truth_of(shapes, 1e-4L), scene.name);
        ++checked;
    }
    EXPECT_GT(checked, 170);
    EXPECT_LT(too_large, 40);
}

}  // namespace
}  // namespace hausbench
