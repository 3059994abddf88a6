// Reads and checks an experiment file; CONTRIBUTING.md lists its keys. scene_reader.h and solver_reader.h read its tables.
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
    int source_line = 0, target_line = 0;  // of the experiment's file
    std::string matrix;   // of which it is a pair: the name of the [[scene]] with `sources` and `targets`; else empty
    bool search = false;  // of a matrix: the targets of each source are one chain, see Case::chain
    std::string each;  // of which it is one: the name of the [[scene]] with `each` (and {}) or `recording`; else empty
    std::string note;
    std::vector<double> tolerances;                              // its own; else those of the solver
    std::string family;                                          // of a case in a sweep over `severity`; else empty
    double severity = std::numeric_limits<double>::quiet_NaN();  // where it is in that sweep
    double exact = std::numeric_limits<double>::quiet_NaN();     // the experiment's quantity, where it is known
    Motion motion = Static{}, target_motion = Static{};          // one of them is static, or both have as many poses
    std::vector<int> frames;                                     // of a recording: of each pose; else empty
};

struct SolverPlan {
    std::string name, label;
    std::vector<ParameterMap> options;       // one for each combination of swept parameters
    std::vector<double> tolerances;          // this solver's own, else the experiment's
    std::vector<std::string> scenes;         // only on these; empty: on all
    Quantity quantity = Quantity::directed;  // this solver's own, else the experiment's
    int threads = 1;    // this solver's own, else the experiment's; 1 for a solver that offers no more
    bool warm = false;  // each pose starts from what the pose before it left, see State
};

struct Experiment {
    std::string stem, title, paper, profile;
    std::string toml;  // verbatim
    std::filesystem::path file;
    std::filesystem::path folder() const { return std::filesystem::absolute(file).parent_path(); }
    std::vector<ModelInfo> models;  // its own: [model.NAME], and those that scenes describe in place
    std::vector<ScenePlan> scenes;
    std::vector<SolverPlan> solvers;
    std::vector<double> tolerances;
    std::string of = "diagonal";                                         // one of tolerance_units
    double floor = 0, cutoff = std::numeric_limits<double>::infinity();  // as `of` says; where it is `lower`, lengths
    std::int64_t budget = -1;                                            // see Query; -1: none
    Quantity quantity = Quantity::directed;
    int threads = 1;        // that a solver may use, see Query
    int repeats = 5;        // timed repeats a round
    int rounds = 1;         // fresh processes; the order of solvers is turned round after each (ABBA)
    bool trace = false;     // coarser tolerances are read off the trace of the finest where a solver traces
    bool fields = false;    // values for each vertex and element of A, see Outcome::fields_sha256
    bool stages = false;    // seconds by stage, from a run that is not timed, see Wanted::stages
    bool reference = true;  // one certified answer for each scene and pose to hold the others against, see references.h
    double reference_seconds = 10;  // at most for each of these
    Limits limits;
    std::vector<std::string> expected_unsound;  // labels of solvers whose wrong answers are a result of the experiment
};

// `each = "corpus"` takes the names of corpus.toml beside the manifest (paths.h).
// Throws InputError naming file, line and key for anything unknown (with the nearest known name), missing or out of range:
// keys, solvers, parameters and their values, own models, files of poses; names of models are checked by own_models.h.
// Plug-ins that it names are loaded; with `refused`, naming one is an error.
enum class PlugIns { loaded, refused };
Experiment read_experiment(const std::filesystem::path& file, const std::string& profile,
                           PlugIns plug_ins = PlugIns::loaded);

// The scenes of an experiment for one other solver, with its defaults, as an experiment of its own: STEM_SOLVER, whose text is made from that
// of the file. What names solvers of the file (`solver`, `claim`, `expected_unsound`) is left out.
Experiment read_experiment_with(const std::filesystem::path& file, const std::string& solver,
                                const std::string& profile);

// The same text, in another profile.
Experiment in_profile(const Experiment& experiment, const std::string& profile);

// Whether an unsound row is a result of the experiment and no alarm: the solver declares a published error (`known_wrong`),
// or the experiment names its label in `expected_unsound`. Never where the solver promises bounds that hold.
bool unsound_expected(const Case& asked, const Experiment& experiment);

// The models that the text of an experiment defines in a profile; relative paths count from the folder of `file`.
std::vector<ModelInfo> models_of(const std::filesystem::path& file, const std::string& toml,
                                 const std::string& profile);

// All experiment files below a folder, by stem. Throws InputError if two have the same.
std::vector<std::filesystem::path> experiment_files(const std::filesystem::path& folder);

}  // namespace hausbench
