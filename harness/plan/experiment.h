// Reads and checks an experiment file; docs/experiments.md lists the keys. scene_reader.h and solver_reader.h read
// its tables.
#pragma once

#include "algorithms/options.h"
#include "algorithms/solver.h"
#include "datasets/catalogue.h"
#include "harness/plan/motion.h"
#include "harness/record/case.h"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace hausbench {

struct ScenePlan {
    std::string name, source, target;      // models, by name, or files, by path (own_models.h)
    int source_line = 0, target_line = 0;  // lines in the experiment's file
    // Name of the [[scene]] with `sources` and `targets` to which this pair belongs, otherwise empty.
    std::string matrix;
    bool search = false;  // in a matrix: the targets of each source form one chain, see Case::chain
    // Name of the [[scene]] with `each` (and {}) or `recording` that expands to this scene, otherwise empty.
    std::string each;
    std::string note;
    std::vector<double> tolerances;  // this scene's own; empty: the solver's
    // Name of the sweep over `severity` to which this scene belongs, otherwise empty.
    std::string family;
    double severity = std::numeric_limits<double>::quiet_NaN();  // its value in that sweep
    // The exact value of the experiment's quantity, if known, otherwise NaN.
    double exact = std::numeric_limits<double>::quiet_NaN();
    // One of them is static, or both have the same number of poses.
    Motion motion = Static{}, target_motion = Static{};
    std::vector<int> frames;  // the frame of each pose of a recording, otherwise empty
};

struct SolverPlan {
    std::string name, label;
    std::vector<ParameterMap> options;       // one for each combination of swept parameters
    std::vector<double> tolerances;          // this solver's own, otherwise the experiment's
    std::vector<std::string> scenes;         // runs only on these; empty: on all
    Quantity quantity = Quantity::directed;  // this solver's own, otherwise the experiment's
    // This solver's own, else the experiment's; 1 if the solver does not support more.
    int threads = 1;
    // Each pose starts from the state that the pose before it left, see State.
    bool warm = false;
};

struct Experiment {
    std::string stem, title, paper, profile;
    std::string toml;  // verbatim
    std::filesystem::path file;
    std::filesystem::path folder() const { return std::filesystem::absolute(file).parent_path(); }
    std::vector<ModelInfo> models;  // [model.NAME], and models described in scenes
    std::vector<ScenePlan> scenes;
    std::vector<SolverPlan> solvers;
    std::vector<double> tolerances;
    std::string of = "diagonal";  // one of tolerance_units
    // In the unit that `of` names; if that is `lower`, as lengths.
    double floor = 0, cutoff = std::numeric_limits<double>::infinity();
    std::int64_t budget = -1;  // see Query; -1: none
    Quantity quantity = Quantity::directed;
    int threads = 1;  // most that a solver may use, see Query
    int repeats = 5;  // timed repeats per round
    int rounds = 1;   // fresh processes; the order of solvers alternates (ABBA)
    // Reads coarser tolerances off the trace of the finest, for solvers that trace.
    bool trace = false;
    bool fields = false;  // values for each vertex and element of A, see Outcome::fields_sha256
    bool stages = false;  // seconds by stage, from a run that is not timed, see Wanted::stages
    // One certified answer for each scene and pose to check the others against (references.h).
    bool reference = true;
    double reference_seconds = 10;  // limit for each of these answers
    Limits limits;
    // Labels of solvers whose wrong answers are a result of the experiment.
    std::vector<std::string> expected_unsound;
};

// Reads an experiment in one profile. `each = "corpus"` takes the names from corpus.toml beside the manifest
// (paths.h). Throws InputError with file, line and key for anything unknown (with the nearest known name), missing or
// out of range: keys, solvers, parameters and their values, own models, files of poses. Names of models are checked
// by own_models.h. Loads the plug-ins that the file names; with `refused`, naming one is an error.
enum class PlugIns { loaded, refused };
Experiment read_experiment(const std::filesystem::path& file, const std::string& profile,
                           PlugIns plug_ins = PlugIns::loaded);

// Returns the scenes of an experiment with another solver and its defaults as an experiment named STEM_SOLVER, whose
// text is made from the text of the file. Keys that name solvers of the file (`solver`, `claim`, `expected_unsound`)
// are left out.
Experiment read_experiment_with(const std::filesystem::path& file, const std::string& solver,
                                const std::string& profile);

// Reads the text of the experiment again in another profile.
Experiment in_profile(const Experiment& experiment, const std::string& profile);

// Returns whether an unsound row is a result of the experiment rather than an alarm: the solver declares a published
// error (`known_wrong`), or the experiment lists its label in `expected_unsound`. Always false if the solver promises
// bounds that hold.
bool unsound_expected(const Case& asked, const Experiment& experiment);

// Returns the models that the text of an experiment defines in a profile. Relative paths count from the folder of
// `file`.
std::vector<ModelInfo> models_of(const std::filesystem::path& file, const std::string& toml,
                                 const std::string& profile);

// Returns all experiment files below a folder, sorted by stem. Throws InputError if two have the same stem.
std::vector<std::filesystem::path> experiment_files(const std::filesystem::path& folder);

}  // namespace hausbench
