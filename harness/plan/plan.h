// Turns an experiment into cases and jobs, and decides what need not run.
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

// The work of one worker process: a solver with its options on a scene, at all poses and tolerances to be run; or on
// all pairs of a matrix whose scales are close enough, with each shape loaded and prepared once. Warm cases of
// different tolerances go to different jobs, so that the cases of a pair form one chain in the order of the poses; so
// do the cases of a search, which form one chain per source in the order of the targets.
struct Job {
    struct Pair {
        std::filesystem::path source_file, target_file;
        QuerySet queries;
        std::size_t cases = 0;  // number of cases of the pair; they follow each other in Job::cases
    };

    std::size_t scene = 0;  // index in the experiment; for a matrix, of its first scene
    std::string label;      // "guthe on bunny"
    std::vector<Pair> pairs;
    std::optional<int> exponent;     // for a matrix: all shapes are scaled by 2^exponent
    std::vector<std::size_t> cases;  // rows of Plan::cases, in running order
};

// How to answer a case that is not run, because the run of another case holds its answer.
struct FromTrace {
    std::size_t of;  // row of the case that is run
    // If true, the row gets the finer run's answer, otherwise a sample of its trace.
    bool ignores_tolerance;
};

inline constexpr const char* coarser_tolerances = "coarser tolerances";
inline constexpr const char* structures_for_each_pose = "structures for each pose";
inline constexpr const char* structures_for_each_pair = "structures for each pair";

struct ModelRow {
    const ModelInfo* info;
    ResolvedModel resolved;
};

inline constexpr const char* not_run_yet = "not run: the sweep was interrupted; run it again to resume";

struct Plan {
    Experiment experiment;
    std::vector<Case> cases;  // every requested case
    // Rows that need no run: not built, skipped, or failed in advance.
    std::map<std::size_t, Outcome> decided;
    std::map<std::size_t, FromTrace> traced;  // rows read off another row's run, by read_off()
    std::vector<Job> jobs;
    std::vector<LedgerEntry> ledger;
    std::vector<ModelRow> models;
    bool leave_nothing_out = false;
    // Adds this fraction of its CPU time to each repeat; `track` tests itself with it.
    double planted_slowdown = 0;
    std::shared_ptr<Plan> references;  // answers to check these against (references.h); null: none
    // Whether the plan holds every scene and solver of the profile, because --solver and --scene chose none.
    bool whole = true;
    Shard shard = {};

    void read_off(std::size_t row, const FromTrace& from);

    // Returns the gaps (absolute lengths, the largest first) that the trace of this row must contain.
    std::vector<double> marks(std::size_t row) const;

private:
    RowsReadOff<> readers_;
};

// Returns whether the solver's bounds hold under rounding with these options.
bool promises(const SolverEntry& entry, const ParameterMap& given);

// Receives the name of the next model, the number of models before it, and the total.
using SayModel = std::function<void(const std::string& name, std::size_t before, std::size_t of)>;

struct Choice {  // --solver, --scene; empty: all
    std::vector<std::string> solvers, scenes;
    // Runs every tolerance and builds every structure, to test that leaving them out changes nothing.
    bool leave_nothing_out = false;
    double planted_slowdown = 0;
};

// Makes a plan, which includes fetching, generating and deriving models; this can take a while the first time, so
// `say` is called before each model. Throws InputError for an unknown model (with the nearest name), an unknown
// solver or scene in `choice`, or a case that is requested twice.
Plan make_plan(const Experiment& experiment, const Catalogue& catalogue, const Choice& choice, const SayModel& say);

// Returns the shape of a model that a result recorded; throws InputError if it is not available with these bytes.
using ShapeOf = std::function<Shape(const ModelRecord&)>;
using ShapesOf = std::function<ShapeOf(const Experiment&)>;  // including the experiment's own models

struct AskedCases {
    std::vector<Case> cases;
    std::set<std::string> unknown;  // scenes with unknown poses, because a moving shape is missing
};

// Returns every case that the present experiment asks for if its models are the ones that a result recorded; other
// models count as missing. Makes no model. Throws InputError if a case is requested twice.
AskedCases cases_as_recorded(const Experiment& experiment, const std::vector<ModelRecord>& models,
                             const ShapeOf& shape_of);

}  // namespace hausbench
