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

// A scene: two shapes, A (`source`) and B (`target`), and their motions. One [[scene]] table may describe several.
struct ScenePlan {
    std::string name, source, target;      // each shape: a model, by name, or a file, by path (own_models.h)
    int source_line = 0, target_line = 0;  // lines of `source` and `target` in the experiment file, for messages
    // Name of the *matrix* to which this scene belongs, a [[scene]] with `sources` and `targets` that makes one scene
    // for each pair of them. Otherwise empty.
    std::string matrix;
    // In a matrix: only the nearest target of each source is wanted. So the targets of a source are run in order, as
    // one chain, in which each answer can lower the cutoff of the next ones (Case::chain).
    bool search = false;
    // Name of the [[scene]] with `each`, with a `recording` or with a list of severities that makes this scene and
    // others like it. Otherwise empty.
    std::string each;
    std::string note;
    std::vector<double> tolerances;  // this scene's own; empty: the solver's
    // Name of the sweep over `severity` to which this scene belongs, otherwise empty.
    std::string family;
    double severity = std::numeric_limits<double>::quiet_NaN();  // its value in that sweep
    // The exact value of the experiment's quantity, if known, otherwise NaN.
    double exact = std::numeric_limits<double>::quiet_NaN();
    // Motions of A and B. If neither is static, they have the same number of poses.
    Motion motion = Static{}, target_motion = Static{};
    std::vector<int> frames;  // for a recording: the number of the frame of each pose; otherwise empty
};

// A [[solver]] table.
struct SolverPlan {
    std::string name, label;
    std::vector<ParameterMap> options;       // one for each combination of swept parameters
    std::vector<double> tolerances;          // this solver's own, otherwise the experiment's
    std::vector<std::string> scenes;         // runs only on these; empty: on all
    Quantity quantity = Quantity::directed;  // this solver's own, otherwise the experiment's
    // This solver's own, otherwise the experiment's. A solver without support for threads runs with one all the same.
    int threads = 1;
    // Each pose starts from the state that the pose before it left, see State.
    bool warm = false;
};

struct Experiment {
    std::string stem, title, paper, profile;
    std::string toml;  // text of the experiment file, verbatim
    std::filesystem::path file;
    std::filesystem::path folder() const { return std::filesystem::absolute(file).parent_path(); }
    std::vector<ModelInfo> models;  // [model.NAME], and models described in scenes
    std::vector<ScenePlan> scenes;
    std::vector<SolverPlan> solvers;
    std::vector<double> tolerances;
    std::string of = "diagonal";  // unit of the tolerances, the floor and the cutoff: one of tolerance_units
    // Distances at which a solver may stop early, see Query. If `of` is "lower", these two are lengths.
    double floor = 0, cutoff = std::numeric_limits<double>::infinity();
    std::int64_t budget = -1;  // see Query; -1: none
    Quantity quantity = Quantity::directed;
    int threads = 1;  // the most that a solver may use, see Query
    int repeats = 5;  // timed repeats per round
    // Number of rounds. A round runs every case, in fresh processes. The order of the solvers is reversed from one
    // round to the next (ABBA), so that none of them always runs first.
    int rounds = 1;
    // Records the bounds over time, for solvers that trace. Answers to coarser tolerances may then be read off the
    // trace of the finest one instead of being run.
    bool trace = false;
    bool fields = false;  // keeps values for each vertex and element of A, see Outcome::fields_sha256
    bool stages = false;  // keeps the seconds of each stage, from a run that is not timed, see Wanted::stages
    // Computes one certified answer for each scene and pose, to check the other answers against (references.h).
    bool reference = true;
    double reference_seconds = 10;  // limit for each of these answers
    Limits limits;
    // Labels of solvers whose wrong answers are a result of the experiment.
    std::vector<std::string> expected_unsound;
};

// Reads an experiment in one profile. Loads the plug-ins that the file names; with PlugIns::refused, it is an error if
// the file names any. For `each = "corpus"`, the names are read from corpus.toml beside the manifest (paths.h).
//
// Throws InputError, with file, line and key, for anything that is unknown (with the nearest known name), missing or
// out of range: keys, solvers, parameters and their values, the file's own models, files of poses. Names of models are
// not checked here but in add_own_models() (own_models.h).
enum class PlugIns { loaded, refused };
Experiment read_experiment(const std::filesystem::path& file, const std::string& profile,
                           PlugIns plug_ins = PlugIns::loaded);

// Returns an experiment named STEM_SOLVER that runs one solver, with default parameters, on the scenes of the
// experiment STEM. Its text is made from the text of the file, without the keys that name other solvers (`solver`,
// `claim`, `expected_unsound`).
Experiment read_experiment_with(const std::filesystem::path& file, const std::string& solver,
                                const std::string& profile);

// Reads the text of the experiment again in another profile.
Experiment in_profile(const Experiment& experiment, const std::string& profile);

// Returns whether an unsound row is a result of the experiment rather than an alarm: the solver declares a published
// error (`known_wrong`), or the experiment lists its label in `expected_unsound`. Always false if the solver promises
// bounds that hold.
bool unsound_expected(const Case& asked, const Experiment& experiment);

// Returns the models that the text of an experiment defines in a profile. Relative paths start from the folder of
// `file`.
std::vector<ModelInfo> models_of(const std::filesystem::path& file, const std::string& toml,
                                 const std::string& profile);

// Returns all experiment files below a folder, sorted by stem. Throws InputError if two have the same stem.
std::vector<std::filesystem::path> experiment_files(const std::filesystem::path& folder);

}  // namespace hausbench
