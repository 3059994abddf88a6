// Compares the distances stated in the stability suite with exact arithmetic, or with a reference
// that shares no code with the solvers. Also checks the certificates and witnesses of `cover`.
#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "datasets/catalogue.h"
#include "datasets/shape_file.h"
#include "harness/check/certificate_file.h"
#include "harness/plan/experiment.h"
#include "harness/plan/own_models.h"
#include "harness/record/case.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

namespace hausbench {
namespace {

const std::filesystem::path root = HAUSBENCH_SOURCE;

// Expects that `stated` is at most one double away from the true distance. For points, truth.squared is exact. For
// meshes it is the distance of the farthest vertex of A, which attains h in all scenes except those named below.
void expect_stated(double stated, const Truth& truth, const std::string& scene) {
    const double infinite = std::numeric_limits<double>::infinity();
    const double low = std::nextafter(stated, 0.0), high = std::nextafter(stated, infinite);
    const auto square = [](double x) -> exact::Rational { return exact::Rational(x) * exact::Rational(x); };
    EXPECT_LE(truth.squared, square(high)) << scene;  // a vertex is a lower bound
    if (!scene.starts_with("farthest point inside a face")) {
        EXPECT_GE(truth.squared, square(low)) << scene;
    }
    if (truth.points) return;
    EXPECT_LE(truth.low, Real(high)) << scene;
    EXPECT_GE(truth.high, Real(low)) << scene;
}

TEST(StabilitySuite, StatedDistancesAreThoseOfTheShapes) {
    const TemporaryFolder folder;
    const Experiment experiment =
        read_experiment(root / "experiments" / "stability" / "stability_matrix.toml", "quick");
    Catalogue catalogue(root / "datasets" / "manifest.toml", folder.path(), {});
    add_own_models(catalogue, experiment);
    int checked = 0, too_large = 0, surfaces = 0;
    for (const ScenePlan& scene : experiment.scenes) {
        if (std::isnan(scene.exact)) continue;
        const auto shape = [&](const std::string& name) {
            return read_shape(std::get<ResolvedModel>(catalogue.resolve(name)).shape_file).shape;
        };
        const Scene shapes{shape(scene.source), shape(scene.target)};
        if (kind_of(shapes.source) == ShapeKind::surface) {  // spheres, planes and the like have simple distances
            ++surfaces;
            continue;
        }
        // Skips large scenes, whose exact distances take too long; smaller scenes of the same family are checked.
        if (double(element_count(shapes.source)) * double(element_count(shapes.target)) > 4e4) {
            ++too_large;
            continue;
        }
        expect_stated(scene.exact, truth_of(shapes, 1e-4L), scene.name);
        ++checked;
    }
    EXPECT_GT(checked, 170);
    EXPECT_LT(too_large, 40);
    EXPECT_LT(surfaces, 25);
}

// Returns why the certificate of cover's answer is refused; an empty string if it is accepted.
std::string doubt_of_cover(const Scene& shapes, double tolerance) {
    Query query;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    query.budget = 200'000;
    query.wanted.certificate = true;
    Trace trace;
    Result result = Session(find_solver("cover"), Options("cover", {}, {}), shapes, {}).solve(query, trace);
    if (result.certificates.empty()) return "no certificate: " + result.why_no_certificate;
    CertificateFile content{{"A", content_hash(shapes.source), {}},
                            {"B", content_hash(shapes.target), {}},
                            Quantity::directed,
                            "cover",
                            tolerance,
                            "absolute",
                            result.bounds,
                            result.witness,
                            std::move(result.certificates)};
    state_what_is_proven(content, shapes.source, shapes.target);
    return verify_certificate(content, shapes.source, shapes.target).refusal;
}

TEST(StabilitySuite, AnswersOfCoverAreProven) {
    const TemporaryFolder folder;
    const Experiment experiment =
        read_experiment(root / "experiments" / "stability" / "stability_matrix.toml", "quick");
    Catalogue catalogue(root / "datasets" / "manifest.toml", folder.path(), {});
    add_own_models(catalogue, experiment);
    const SolverInfo& info = find_solver("cover").info;
    int proven = 0;
    for (const ScenePlan& scene : experiment.scenes) {
        if (scene.note.starts_with("not legal")) continue;
        const auto shape = [&](const std::string& name) {
            return read_shape(std::get<ResolvedModel>(catalogue.resolve(name)).shape_file).shape;
        };
        const Scene shapes{shape(scene.source), shape(scene.target)};
        if (!refusal(info, kind_of(shapes.source), kind_of(shapes.target)).empty()) continue;
        const Points& source = points_of(shapes.source);
        const double unit = unit_of(experiment.of, diagonal(source), longest_side(source));
        for (const double tolerance : scene.tolerances.empty() ? experiment.tolerances : scene.tolerances) {
            const double length = tolerance_as_length(tolerance, unit > 0 ? unit : 1);
            EXPECT_EQ(doubt_of_cover(shapes, length), "") << scene.name;
            ++proven;
        }
    }
    EXPECT_GT(proven, 170);
}

}  // namespace
}  // namespace hausbench
