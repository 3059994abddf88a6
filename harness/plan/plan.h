// Turns an experiment into cases and jobs, and decides which cases need not run.
#pragma once

#include "datasets/catalogue.h"
#include "harness/plan/experiment.h"
#include "harness/plan/lookup.h"
#include "harness/plan/shard.h"
#include "harness/record/row.h"

#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace hausbench {

// The cases that one worker process runs: one solver with fixed options on one scene. A job for a matrix
// (ScenePlan::matrix) has all pairs that can share one scale (jobs.h), so that each shape is loaded and prepared once.
//
// A *chain* is a list of cases that must run in order, because each depends on the answers before it: the poses of a
// scene for a warm solver, or the targets of one source in a search. Each tolerance of a chain gets a job of its own,
// so that the cases of a pair are adjacent in a job.
struct Job {
    struct Pair {
        std::filesystem::path source_file, target_file;
        QuerySet queries;
        std::size_t cases = 0;  // number of cases of the pair, which are adjacent in Job::cases
    };

    std::size_t scene = 0;  // index in the experiment's scenes; for a matrix, of its first one
    std::string label;      // "guthe on bunny"
    std::vector<Pair> pairs;
    std::optional<int> exponent;     // for a matrix: all shapes are scaled by 2^exponent
    std::vector<std::size_t> cases;  // indices into Plan::cases, in the order in which they run
};

// A case that is not run. Its answer is read from the run of the same case with a finer tolerance.
struct FromTrace {
    std::size_t of;  // row of the case that is run
    // True: the answer is the same as in that run. False: the answer is the first sample in the trace of that run that
    // meets the coarser tolerance.
    bool ignores_tolerance;
};

// Values of LedgerEntry::what.
inline constexpr const char* coarser_tolerances = "coarser tolerances";
inline constexpr const char* structures_for_each_pose = "structures for each pose";
inline constexpr const char* structures_for_each_pair = "structures for each pair";

// A model that the plan uses.
struct ModelRow {
    const ModelInfo* info;
    ResolvedModel resolved;
};

// Outcome::reason of a case that an interrupted run did not reach.
inline constexpr const char* not_run_yet = "not run: the sweep was interrupted; run it again to resume";

struct Plan {
    Experiment experiment;
    std::vector<Case> cases;  // every requested case; its index is called its row
    // Outcomes of the rows that cannot run: the solver is not built, the case is skipped, or a model is damaged.
    std::map<std::size_t, Outcome> decided;
    std::map<std::size_t, FromTrace> traced;  // the rows that are read off the run of another row, see read_off()
    std::vector<Job> jobs;
    std::vector<LedgerEntry> ledger;
    std::vector<ModelRow> models;
    bool leave_nothing_out = false;    // see Choice
    std::shared_ptr<Plan> references;  // plan of the reference answers (references.h); null: none
    // True if the plan has all scenes and solvers of the profile: neither --scene nor --solver was given.
    bool whole = true;
    Shard shard = {};

    // Records that a row is not run, and that its answer is read off the run of another row.
    void read_off(std::size_t row, const FromTrace& from);

    // Returns the gaps (upper - lower) at which the answers to other rows are read off the trace of this row, largest
    // first.
    std::vector<double> marks(std::size_t row) const;

private:
    RowsReadOff<> readers_;
};

// Called before a model is made, with the name of the model, the number of models before it, and the total.
using SayModel = std::function<void(const std::string& name, std::size_t before, std::size_t of)>;

// The part of an experiment to run, and settings from the command line.
struct Choice {
    std::vector<std::string> solvers, scenes;  // --solver and --scene; empty: all
    // Runs every tolerance and builds every structure, to test that shortcuts change no answer.
    bool leave_nothing_out = false;
};

// Plans the chosen part of an experiment. Fetches or generates the models of its scenes, which can take a while the
// first time, so `say` is called before each model. Throws InputError if a model, or a solver or scene in `choice`, is
// unknown, or if a case is requested twice.
Plan make_plan(const Experiment& experiment, const Catalogue& catalogue, const Choice& choice, const SayModel& say);

// Loads the shape of a model that a result recorded. Throws InputError if the model is missing or its bytes have
// changed.
using ShapeOf = std::function<Shape(const ModelRecord&)>;
using ShapesOf = std::function<ShapeOf(const Experiment&)>;  // returns a ShapeOf that knows the experiment's own models

struct AskedCases {
    std::vector<Case> cases;
    std::set<std::string> unknown;  // scenes with unknown poses, because a moving shape is missing
};

// Returns every case that the experiment requests, with the models as a result recorded them. Makes no models: a model
// that the result did not record counts as missing. Throws InputError if a case is requested twice.
AskedCases cases_as_recorded(const Experiment& experiment, const std::vector<ModelRecord>& models,
                             const ShapeOf& shape_of);

}  // namespace hausbench
