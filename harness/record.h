// What a result file holds, in memory: a case that was asked for, what became of it, models, the ledger. columns.h is the table of
// the files' columns; JSON of the same rows goes into journals and pipes.
#pragma once

#include "experiment.h"
#include "fields.h"
#include "solver.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace hausbench {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// What became of a case; results/README.md says when.
enum class RowStatus { ok, timeout, out_of_memory, signal, skipped, failed, unsound, not_built, floor, budget };
std::string_view to_string(RowStatus status);
std::string to_string(const std::map<RowStatus, std::size_t>& counts);  // "24 ok, 3 timeout"

template <class E> inline constexpr int count_of = 0;  // of the values of an enumeration that a column holds by name
template <> inline constexpr int count_of<RowStatus> = 10;
template <> inline constexpr int count_of<Quantity> = 3;
template <> inline constexpr int count_of<Witness::Direction> = 2;
template <> inline constexpr int count_of<Field::Of> = 2;
template <> inline constexpr int count_of<Field::Meaning> = 3;

// What was asked for. Everything that can change the answer goes into `identity`.
struct Case {
    std::string identity;  // SHA-256, see identify()
    std::string solver, label;
    std::string profile;   // of the experiment, that asks for it; several are joined by commas
    std::string variant;   // the parameters that the experiment sweeps: "samples=8, seed=1"; else empty
    ParameterMap options;  // every parameter of the solver
    std::string scene, note, source, target;
    std::string source_hash, target_hash;  // of the shapes; empty for a missing model
    std::int64_t source_elements = 0, target_elements = 0;
    double source_diagonal = 0, source_longest = 0;  // of A's box as loaded, whatever the pose
    int pose_index = 0;
    int frame = -1;          // of a recording; -1: the scene is none
    Pose pose, target_pose;  // of A, of B
    Quantity quantity = Quantity::directed;
    double tolerance = 0;
    std::string tolerance_of;
    double floor = 0, cutoff = std::numeric_limits<double>::infinity();  // lengths, see Query
    std::int64_t budget = -1;                                            // likewise; -1: none
    int threads = 1;                                                     // that the solver may use
    std::string program_sha256;  // see command_files.h; empty: the solver runs no command, or nothing of it was found
    Limits limits;
    // A warm case starts from what the solver kept of the pose before it, whose identity is `chain`; empty at the chain's head. In a
    // search the cutoff comes from the targets before, and `chain` is the identity of the last of them.
    bool warm = false;
    std::string chain;
    double exact = unknown;  // the true distance, where the experiment gives it
    int certified = -1;  // 1: the solver promises bounds that hold under rounding; 0: not; -1: not built, so not known

    double unit() const { return unit_of(tolerance_of, source_diagonal, source_longest); }
    Tolerance resolved_tolerance() const;  // relative to A's box becomes absolute: here and nowhere else
};

std::string identify(const Case& asked);

// The solver as it is shown: "guthe", or "guthe(samples=8)" where the experiment sweeps a parameter.
std::string shown(const Case& asked);

// "samples=8, seed=1": those of `one` that are not the same in all of `swept`.
std::string variant_of(const ParameterMap& one, const std::vector<ParameterMap>& swept);

// What follows a scene's name where the quantity is not h(A,B): ", H" or ", depth".
std::string suffix_of(Quantity quantity);

// For people: "guthe on bunny, pose 0, tolerance 0.001 of diagonal".
std::string name_of(const Case& asked);

struct Repeat {
    int round = 0;
    double wall_seconds = 0, cpu_seconds = 0;  // per solve, see timing.h
    std::int64_t iterations = 1;
};

// The first answer to a case in a round's process, which nothing has warmed up: what a user waits for who asks once.
struct FirstAnswer {
    int round = 0;
    double wall_seconds = 0, cpu_seconds = 0;
    double reported_seconds = unknown;  // see Result
};

struct Preparation {
    int round = 0;
    std::string name;
    double seconds = 0;
    std::int64_t bytes = 0;
    int shared = 0;
};

// What became of it.
using Facts = std::map<std::string, std::string>;

struct Outcome {
    RowStatus status = RowStatus::skipped;
    std::string reason;
    std::string solver_status;
    double cutoff_used = std::numeric_limits<double>::infinity();  // see Item::narrow() in worker.h
    Bounds bounds{unknown, unknown};
    Witness witness{Vec3::Constant(unknown), Vec3::Constant(unknown), -1, -1};
    Counters counters;
    std::map<std::string, std::uint64_t> other_counters;  // of a file from a program that counts more
    std::map<std::string, double> extras;                 // numbers that the solver reports of itself
    Facts facts;                                          // and texts
    double prepare_seconds = unknown;
    std::int64_t prepare_bytes = -1;
    double solve_seconds = unknown;
    double reported_seconds = unknown;
    std::int64_t peak_bytes = -1;
    std::string clock;  // "cpu" or "wall": which is the time of the case, see timing.h; empty where there was no answer
    std::vector<Preparation> preparation;
    std::vector<FirstAnswer> answers;
    std::vector<Repeat> repeats;
    int repeats_asked = 0;  // of the round; there are fewer where time ran out
    bool stages_asked = false;
    std::vector<TraceSample> trace;
    std::string fields_sha256;  // of the file that holds them, beside the journal; see field_file.h
    bool from_trace = false;
    std::string build, machine;
};

// What re-checking found, see verify.h.
enum class Verdict {
    holds,        // lower: proven by its witness; upper: above every verified lower bound
    unsound,      // lower above what its witness shows, or upper below a verified lower bound
    no_witness,   // the solver gives none: nothing to re-check the lower bound by
    not_checked,  // no bounds, or the shapes are not available
};
std::string_view to_string(Verdict verdict);
template <> inline constexpr int count_of<Verdict> = 4;

struct Check {
    Verdict lower = Verdict::not_checked, upper = Verdict::not_checked;
    std::string reason;  // where something is unsound
    Verdict fields = Verdict::not_checked;
};

// One row of a result file.
struct Row {
    Case asked;
    Outcome outcome;
    Check check;
    Fields fields = {};  // where the experiment asks for them
};

// One row of /fields: the values of a case's field stand in one piece of the values of all.
struct FieldRecord {
    std::string name;
    Field::Of of = Field::Of::vertices;
    Field::Meaning meaning = Field::Meaning::number;
    std::int64_t begin = 0, end = 0;
};

inline constexpr std::array<double, 6> no_box{unknown, unknown, unknown, unknown, unknown, unknown};

// One row of /models. The polynomial and the box are those of an algebraic surface.
struct ModelRecord {
    std::string name, sha256, kind, precision, source, licence, note, polynomial;
    std::int64_t elements = 0, vertices = 0, unreferenced = -1;
    double diagonal = 0, longest_side = 0;
    std::array<double, 6> box = no_box;  // from, to in x, y and z
    std::string path = {}, file_sha256 = {};
};

// What was left out, and why.
struct LedgerEntry {
    std::string kind;  // not_built | not_prepared | not_run | prepared_again
    std::string subject, what, reason;
    std::int64_t count = 1;
    double seconds_saved = unknown;  // known only afterwards, and not for all
    std::string profile = {};        // of the experiment, as run
};

// The status of a row for a solver's own status: converged, below_floor and above_cutoff are `ok`.
RowStatus row_status(Status status);

// The solver ended by itself and would end so again: its answer is timed, and may have fields.
bool is_timed(RowStatus status);

nlohmann::json to_json(const Outcome& outcome);
Outcome outcome_from_json(const nlohmann::json& json);

ParameterValue parameter_of(const nlohmann::json& value);
nlohmann::json options_json(const ParameterMap& options);

nlohmann::json extras_json(const std::map<std::string, double>& extras);
std::map<std::string, double> extras_of(const nlohmann::json& object);

// JSON has no NaN or infinity: these become texts.
nlohmann::json number(double value);
double number(const nlohmann::json& json);

// Twelve numbers: the rotation row by row, then the translation.
nlohmann::json pose_json(const Pose& pose);
Pose pose_of(const nlohmann::json& values);

}  // namespace hausbench
