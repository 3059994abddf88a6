// Files that people write: experiments, the manifest, surfaces. The first byte chooses which; the rest is the file.
#include "catalogue.h"
#include "memory_file.h"
#include "plan/experiment.h"
#include "surface_file.h"
#include "target.h"

namespace hausbench::fuzz {
namespace {

void read(std::uint32_t kind, const std::filesystem::path& file) {
    if (kind < 2) {
        const Experiment experiment = read_experiment(file, kind == 0 ? "quick" : "paper");
        expect(!experiment.scenes.empty() && !experiment.solvers.empty(), "an experiment without a scene or a solver");
        for (const SolverPlan& solver : experiment.solvers) expect(!solver.options.empty(), "a solver without options");
        for (const double tolerance : experiment.tolerances) expect(tolerance > 0, "a tolerance that is not positive");
        expect(experiment.repeats >= 0 && experiment.rounds >= 1 && experiment.threads >= 1,
               "a count that is too small");
    } else if (kind == 2) {
        const Catalogue catalogue(file, "/nowhere", "/nowhere");
        for (const ModelInfo& model : catalogue.models())
            expect(catalogue.has(model.name), "a model that is not there");
    } else {
        const AlgebraicSurface surface = read_surface_file(file);
        expect(surface.box.allFinite() && (surface.box.row(0).array() < surface.box.row(1).array()).all(),
               "a box without volume");
    }
}

void experiments(std::string_view bytes) {
    if (bytes.empty()) return;
    const MemoryFile file(bytes.substr(1));
    try {
        read(static_cast<std::uint8_t>(bytes[0]) % 4U, file.path());
    } catch (const InputError& error) {
        expect_one_line(error);
    }
}

}  // namespace
}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(experiments)
