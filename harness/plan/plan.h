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

// The work of one worker process: one solver with its options on one scene, at all poses and tolerances that are run.
// For a matrix (ScenePlan::matrix), a job covers all its pairs, if one scale suits them (jobs.h), and each shape is
// loaded and prepared once.
//
// A *chain* is a list of cases that must be run in order, because each depends on the answers before it: the poses of a
// scene for a warm solver, or the targets of one source in a search. Chains for different tolerances go to different
// jobs, so that the cases of a pair are adjacent in a job.
struct Job {
    struct Pair {
        std::filesystem::path source_file, target_file;
        QuerySet queries;
        std::size_t cases = 0;  // number of cases of the pair, which are adjacent in Job::cases
    };

    std::size_t scene = 0;  // index in the experiment; for a matrix, of its first scene
    std::string label;      // "guthe on bunny"
    std::vector<Pair> pairs;
    std::optional<int> exponent;     // for a matrix: all shapes are scaled by 2^exponent
    std::vector<std::size_t> cases;  // indices into Plan::cases, in the order in which they run
};

// The run from which a case gets its answer, if it is not run itself: the run of the same question with a finer
// tolerance.
struct FromTrace {
    std::size_t of;  // row of the case that is run
    // True: the answer of that run is also the answer here. False: it is the first sample of that run's trace that
    // meets the tolerance.
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
    // Outcomes of the rows that are known without a run: not built, skipped, or failed because of a damaged model.
    std::map<std::size_t, Outcome> decided;
    std::map<std::size_t, FromTrace> traced;  // the rows that are read off the run of another row, see read_off()
    std::vector<Job> jobs;
    std::vector<LedgerEntry> ledger;
    std::vector<ModelRow> models;
    bool leave_nothing_out = false;  // see Choice
    // Makes each repeat longer by this fraction of its CPU time. bench/tracking tests that it detects such a slowdown.
    double planted_slowdown = 0;
    std::shared_ptr<Plan> references;  // plan of the answers to check these against (references.h); null: none
    // True if the plan has every scene and solver of the profile, that is, without --solver and --scene.
    bool whole = true;
    Shard shard = {};

    // Notes that a row is not run but read off another row's run.
    void read_off(std::size_t row, const FromTrace& from);

    // Returns the gaps, upper - lower, at which other rows are read off the trace of this row: absolute lengths, the
    // largest first.
    std::vector<double> marks(std::size_t row) const;

private:
    RowsReadOff<> readers_;
};

// Returns whether the solver's bounds hold under rounding with these options.
bool promises(const SolverEntry& entry, const ParameterMap& given);

// Called before a model is made, with the name of the model, the number of models before it, and the total.
using SayModel = std::function<void(const std::string& name, std::size_t before, std::size_t of)>;

// The part of an experiment to run, and settings from the command line.
struct Choice {
    std::vector<std::string> solvers, scenes;  // --solver and --scene; empty: all
    // Runs every tolerance and builds every structure, to test that leaving some out changes no answer.
    bool leave_nothing_out = false;
    double planted_slowdown = 0;  // see Plan
};

// Makes a plan. Fetches, generates and derives the models of its scenes, which can take a while the first time, so
// `say` is called before each model. Throws InputError for an unknown model (with the nearest name), an unknown solver
// or scene in `choice`, or a case that is requested twice.
Plan make_plan(const Experiment& experiment, const Catalogue& catalogue, const Choice& choice, const SayModel& say);

// Returns the shape of a model that a result recorded; throws InputError if the model is no longer available with the
// recorded bytes.
using ShapeOf = std::function<Shape(const ModelRecord&)>;
using ShapesOf = std::function<ShapeOf(const Experiment&)>;  // returns a ShapeOf that knows the experiment's own models

struct AskedCases {
    std::vector<Case> cases;
    std::set<std::string> unknown;  // scenes with unknown poses, because a moving shape is missing
};

// Returns every case that the experiment asks for if its models are the ones that a result recorded. Models that the
// result did not record count as missing; no model is made. Throws InputError if a case is requested twice.
AskedCases cases_as_recorded(const Experiment& experiment, const std::vector<ModelRecord>& models,
                             const ShapeOf& shape_of);

}  // namespace hausbench
