// The outcome of a case, and the verdicts of its check. An Outcome is the part of a solver's Result (solver.h) that a
// result file keeps, with times, memory and how the process ended.
#pragma once

#include "harness/ask/no_answer.h"
#include "harness/record/case.h"

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// The number of values of enumeration E. Specialised for each enumeration that result files store by name.
template <class E> inline constexpr int count_of = 0;

// How a case ended; results/README.md defines each status.
enum class RowStatus { ok, timeout, out_of_memory, signal, skipped, failed, unsound, not_built, floor, budget };
std::string_view to_string(RowStatus status);
std::string to_string(const std::map<RowStatus, std::size_t>& counts);  // "24 ok, 3 timeout"
template <> inline constexpr int count_of<RowStatus> = 10;

// Converts a solver's status to the status of a row: converged, below_floor and above_cutoff become `ok`.
RowStatus row_status(Status status);

// Converts the reason for a missing answer to the status of a row.
RowStatus row_status(NoAnswer::Why why);

// Returns whether the solver ended by itself (ok, floor or budget), so that running it again would end in the same way.
// Only such answers are timed, and only they may have fields.
bool is_timed(RowStatus status);

struct Repeat {
    int round = 0;
    double wall_seconds = 0, cpu_seconds = 0;  // per solve, see run/timing.h
    std::int64_t iterations = 1;
};

// The time of the first answer to a case in one round, a fresh process. Nothing is warmed up yet, so this is the cost
// of a single query.
struct FirstAnswer {
    int round = 0;
    double wall_seconds = 0, cpu_seconds = 0;
    double reported_seconds = unknown;  // see Result
};

// The time and memory for building one structure, or the solver's private data, in one round.
struct Preparation {
    int round = 0;
    std::string name;
    double seconds = 0;
    std::int64_t bytes = 0;
    int shared = 0;  // 1: was built before, for another pair or the other direction
};

using Facts = std::map<std::string, std::string>;

struct Outcome {
    RowStatus status = RowStatus::skipped;
    std::string reason;
    std::string solver_status;
    double cutoff_used = std::numeric_limits<double>::infinity();  // see run/work_order.h
    Bounds bounds{unknown, unknown};
    Witness witness{Vec3::Constant(unknown), Vec3::Constant(unknown), -1, -1};
    Counters counters;
    // Counters that this program does not know, from a file that another version wrote.
    std::map<std::string, std::uint64_t> other_counters;
    std::map<std::string, double> extras;  // numbers that the solver reports
    Facts facts;                           // texts that the solver reports
    double prepare_seconds = unknown;
    std::int64_t prepare_bytes = -1;
    double solve_seconds = unknown;
    double reported_seconds = unknown;
    std::int64_t peak_bytes = -1;
    // The clock that gives the time of the case, "cpu" or "wall" (run/timing.h). Empty without an answer.
    std::string clock;
    std::vector<Preparation> preparation;
    std::vector<FirstAnswer> answers;
    std::vector<Repeat> repeats;
    int repeats_asked = 0;  // per round; fewer are made if time runs out
    bool stages_asked = false;
    std::vector<TraceSample> trace;
    double proven_upper = unknown;  // by a checked certificate of this answer; NaN: none
    std::string fields_sha256;  // hash of the file with the row's fields, in the folder of the journal (field_file.h)
    bool from_trace = false;
    // True if other work of the run may have shared the machine, so that the times are not comparable.
    bool side_by_side = false;
    std::string build, machine;
};

bool same_answer(const Outcome& a, const Outcome& b);  // same status and bounds; NaN equals NaN

// The result of re-checking a bound (check/verify.h).
enum class Verdict {
    // lower: proven by its witness; upper: not below any verified lower bound; of statistics: not refuted by samples
    holds,
    unsound,      // lower: above what its witness shows; upper: below a verified lower bound
    no_witness,   // the solver gives none, so the lower bound cannot be re-checked
    not_checked,  // no bounds, or the shapes are not available
};
std::string_view to_string(Verdict verdict);
template <> inline constexpr int count_of<Verdict> = 4;

struct Check {
    Verdict lower = Verdict::not_checked, upper = Verdict::not_checked;
    std::string reason;  // set if something is unsound
    Verdict fields = Verdict::not_checked;
};

}  // namespace hausbench
