// Reads files that people write: experiments, manifests, surfaces, poses and recordings. First byte: the
// kind; the rest: the file.
#include "datasets/catalogue.h"
#include "datasets/surface_file.h"
#include "harness/plan/experiment.h"
#include "harness/plan/motion.h"
#include "harness/plan/recording.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/target.h"

#include <algorithm>

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

void read_motion(const std::filesystem::path& file) {
    for (const Pose& pose : poses_of(PoseFile{file}, PointSet{Points::Zero(1, 3)}))
        expect(pose.rotation.allFinite() && pose.translation.allFinite(), "a pose that is not finite");
}

void read_frames(const std::filesystem::path& file) {
    const Recording recording = read_recording(file);
    expect(!recording.pairs.empty(), "a recording that asks for nothing");
    for (const Recording::Pair& pair : recording.pairs) {
        expect(!pair.frames.empty() && pair.source_poses.size() == pair.frames.size() &&
                   pair.target_poses.size() == pair.frames.size(),
               "a frame without its poses");
        expect(std::is_sorted(pair.frames.begin(), pair.frames.end()) && pair.frames.front() >= 0 &&
                   pair.frames.back() < recording.frames,
               "frames that are not of the recording");
        for (const auto* poses : {&pair.source_poses, &pair.target_poses}) {
            for (const Pose& pose : *poses) {
                const Eigen::Matrix3d off = pose.rotation.transpose() * pose.rotation - Eigen::Matrix3d::Identity();
                expect(off.cwiseAbs().maxCoeff() < 1e-14 && pose.translation.allFinite(),
                       "a pose that is not a rotation");
            }
        }
    }
}

void experiments(std::string_view bytes) {
    if (bytes.empty()) return;
    const auto kind = static_cast<std::uint8_t>(bytes[0]);
    const MemoryFile file(bytes.substr(1));
    try {
        if (kind == 'P')
            read_motion(file.path());
        else if (kind == 'R')
            read_frames(file.path());
        else
            read(kind % 4U, file.path());
    } catch (const InputError& error) {
        expect_one_line(error);
    }
}

}  // namespace
}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(experiments)
