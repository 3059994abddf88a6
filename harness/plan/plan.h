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

// One worker process: a solver with its options on a scene, through all poses and tolerances that are to be run; or on all pairs
// of a matrix whose scales are near enough, each shape loaded and prepared once. Of warm cases one tolerance only, so that those
// of a pair are one chain, in the order of the poses; likewise of a search, where those of a source are one chain, in the order of the
// targets.
struct Job {
    struct Pair {
        std::filesystem::path source_file, target_file;
        QuerySet queries;
        std::size_t cases = 0;  // how many of them, in the order of `cases`
    };

    std::size_t scene = 0;  // number in the experiment; of a matrix that of its first
    std::string label;      // "guthe on bunny"
    std::vector<Pair> pairs;
    std::optional<int> exponent;     // of a matrix: what all shapes are scaled by
    std::vector<std::size_t> cases;  // rows of Plan::cases, in running order
};

// A case that is not run because the run of another holds its answer.
struct FromTrace {
    std::size_t of;  // row of the case that is run
    // The solver does: the row is the finer run's answer; else a sample of its trace.
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
    std::vector<Case> cases;  // every case asked for
    // Rows that need no run: not built, skipped, failed before they began.
    std::map<std::size_t, Outcome> decided;
    std::map<std::size_t, FromTrace> traced;  // rows read off another row's run, by read_off()
    std::vector<Job> jobs;
    std::vector<LedgerEntry> ledger;
    std::vector<ModelRow> models;
    bool leave_nothing_out = false;
    // Adds this share of its CPU time to each repeat; `track` tests itself with it.
    double planted_slowdown = 0;
    std::shared_ptr<Plan> references;  // answers to check these against (references.h); null: none
    // Holds every scene and solver of the profile: --solver and --scene chose none.
    bool whole = true;
    Shard shard = {};

    void read_off(std::size_t row, const FromTrace& from);

    // Gaps (absolute lengths, the largest first) that the trace of this row must hold.
    std::vector<double> marks(std::size_t row) const;

private:
    RowsReadOff<> readers_;
};

// Whether the solver's bounds hold under rounding with these options.
bool promises(const SolverEntry& entry, const ParameterMap& given);

// The next model, how many came before it, and of how many.
using SayModel = std::function<void(const std::string& name, std::size_t before, std::size_t of)>;

struct Choice {  // --solver, --scene; empty: all
    std::vector<std::string> solvers, scenes;
    // Runs every tolerance and builds every structure, to test that leaving out changes nothing.
    bool leave_nothing_out = false;
    double planted_slowdown = 0;
};

// Fetched, generated and derived models are resolved here, which can take a while the first time: `say` hears of each before
// it is made. Throws InputError for an unknown model (names the nearest) or chosen solver or scene, or a case asked for twice.
Plan make_plan(const Experiment& experiment, const Catalogue& catalogue, const Choice& choice, const SayModel& say);

// The shape of a model that a result recorded; throws InputError if it is not to be had with these bytes.
using ShapeOf = std::function<Shape(const ModelRecord&)>;
using ShapesOf = std::function<ShapeOf(const Experiment&)>;  // with the experiment's own models

struct AskedCases {
    std::vector<Case> cases;
    std::set<std::string> unknown;  // scenes with unknown poses, because a moving shape is missing
};

// Every case that the experiment asks for today if its models are those that a result recorded; others count as missing. No model
// is made. Throws InputError if the experiment asks for a case twice.
AskedCases cases_as_recorded(const Experiment& experiment, const std::vector<ModelRecord>& models,
                             const ShapeOf& shape_of);

}  // namespace hausbench
