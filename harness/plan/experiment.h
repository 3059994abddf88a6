// Reads and checks an experiment file. docs/experiments.md lists its keys; scene_reader.h and solver_reader.h read its
// [[scene]] and [[solver]] tables.
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

// Two shapes, A (`source`) and B (`target`), and their motions. One [[scene]] table may describe several scenes.
struct ScenePlan {
    std::string name, source, target;      // each shape is given by a model's name or a file's path (own_models.h)
    int source_line = 0, target_line = 0;  // lines of the two names in the experiment file, for error messages
    // Name of the matrix that this scene belongs to; empty if none. A *matrix* is a [[scene]] table with `sources` and
    // `targets`, which makes one scene for each pair of them.
    std::string matrix;
    // Searches a matrix for the nearest target of each source. The targets are run in order, so that each answer can
    // lower the cutoff for the next (Case::chain).
    bool search = false;
    // Name of the [[scene]] table that made this scene, if it made several by `each`, `recording` or a list of
    // severities; otherwise empty.
    std::string each;
    std::string note;
    std::vector<double> tolerances;  // empty: the tolerances of the solver
    // Name of the sweep over `severity` that this scene belongs to; empty if none.
    std::string family;
    double severity = std::numeric_limits<double>::quiet_NaN();  // NaN: none
    // The exact value of the experiment's quantity; NaN if unknown.
    double exact = std::numeric_limits<double>::quiet_NaN();
    // Motions of A and B. If both move, they have the same number of poses.
    Motion motion = Static{}, target_motion = Static{};
    std::vector<int> frames;  // the frame number of each pose; empty if the scene is not from a recording
};

// A [[solver]] table.
struct SolverPlan {
    std::string name, label;
    std::vector<ParameterMap> options;       // one for each combination of swept parameters
    std::vector<double> tolerances;          // by default, the tolerances of the experiment
    std::vector<std::string> scenes;         // runs only on these; empty: on all
    Quantity quantity = Quantity::directed;  // by default, the quantity of the experiment
    std::vector<Statistic> statistics;       // for Quantity::distribution: each is a case of its own
    WeighBy weigh = WeighBy::area;
    // Most threads to use (default: the experiment's). A solver without support for threads runs with one.
    int threads = 1;
    // Starts each pose from the solver state that the previous pose left (see State).
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
    std::vector<Statistic> statistics;
    WeighBy weigh = WeighBy::area;
    int threads = 1;  // most threads that a solver may use, see Query
    int repeats = 5;  // timed repeats per round
    // Number of rounds. Each round runs every case in fresh processes, copies of a program that it starts anew for each
    // scene. Every other round runs the solvers in reverse order (ABBA), so that no solver always runs first.
    int rounds = 1;
    // Records how the bounds improve over time, if the solver supports it. Answers to coarser tolerances can then be
    // read off this trace instead of being run.
    bool trace = false;
    bool fields = false;  // keeps values for each vertex and element of A, see Outcome::fields_sha256
    bool stages = false;  // keeps the seconds of each stage of a solver, from an extra, untimed run (Wanted::stages)
    // Computes one certified answer for each scene and pose, to check the other answers against (references.h).
    bool reference = true;
    double reference_seconds = 10;  // time limit for each of these answers
    Limits limits;
    // Labels of solvers whose wrong answers are a finding of the experiment, not an alarm.
    std::vector<std::string> expected_unsound;
};

// Reads an experiment in one profile, and loads the plug-ins that the file names. With PlugIns::refused, a file that
// names plug-ins is an error.
//
// Throws InputError, with the file and the line, if a key, solver or parameter is unknown, missing or out of range, or
// if a pose file cannot be read. The names of models are checked later, by add_own_models() (own_models.h).
enum class PlugIns { loaded, refused };
Experiment read_experiment(const std::filesystem::path& file, const std::string& profile,
                           PlugIns plug_ins = PlugIns::loaded);

// Reads an experiment, and replaces its solvers with the solver named `solver`, with default parameters. The result is
// named STEM_SOLVER. Its text lacks the keys `claim` and `expected_unsound`, which name the replaced solvers.
Experiment read_experiment_with(const std::filesystem::path& file, const std::string& solver,
                                const std::string& profile);

// Parses the text of an experiment again, in another profile.
Experiment in_profile(const Experiment& experiment, const std::string& profile);

// Returns whether a wrong answer to this case is expected, not an alarm: the solver is known to be wrong
// (SolverInfo::known_wrong), or the experiment lists its label in `expected_unsound`. A solver that promises valid
// bounds is never expected to be wrong.
bool unsound_expected(const Case& spec, const Experiment& experiment);

// Returns the models that the text of an experiment defines in a profile. Relative paths start from the folder of
// `file`.
std::vector<ModelInfo> models_of(const std::filesystem::path& file, const std::string& toml,
                                 const std::string& profile);

// Returns all experiment files (.toml) in a folder and its subfolders, sorted by stem. Throws InputError if two have
// the same stem.
std::vector<std::filesystem::path> experiment_files(const std::filesystem::path& folder);

}  // namespace hausbench
