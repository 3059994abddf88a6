// The outcome of a case, and the result of its check. A solver returns a Result (solver.h); an Outcome is the part of
// it that a row of the result file keeps, with times, memory and the end of its process.
#pragma once

#include "harness/record/case.h"

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// Number of values of an enumeration that a column holds by name.
template <class E> inline constexpr int count_of = 0;

// What became of a case; results/README.md says when.
enum class RowStatus { ok, timeout, out_of_memory, signal, skipped, failed, unsound, not_built, floor, budget };
std::string_view to_string(RowStatus status);
std::string to_string(const std::map<RowStatus, std::size_t>& counts);  // "24 ok, 3 timeout"
template <> inline constexpr int count_of<RowStatus> = 10;

// The status of a row for a solver's own status: converged, below_floor and above_cutoff are `ok`.
RowStatus row_status(Status status);

// The solver ended by itself and would end so again: its answer is timed, and may have fields.
bool is_timed(RowStatus status);

struct Repeat {
    int round = 0;
    double wall_seconds = 0, cpu_seconds = 0;  // per solve, see timing.h
    std::int64_t iterations = 1;
};

// The first answer to a case in a round's process, which nothing has warmed up: the waiting time for a single
// question.
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

using Facts = std::map<std::string, std::string>;

struct Outcome {
    RowStatus status = RowStatus::skipped;
    std::string reason;
    std::string solver_status;
    double cutoff_used = std::numeric_limits<double>::infinity();  // see WorkOrder::Item::narrow()
    Bounds bounds{unknown, unknown};
    Witness witness{Vec3::Constant(unknown), Vec3::Constant(unknown), -1, -1};
    Counters counters;
    // Read from a file of a program with more counters.
    std::map<std::string, std::uint64_t> other_counters;
    std::map<std::string, double> extras;  // numbers that the solver reports
    Facts facts;                           // and texts
    double prepare_seconds = unknown;
    std::int64_t prepare_bytes = -1;
    double solve_seconds = unknown;
    double reported_seconds = unknown;
    std::int64_t peak_bytes = -1;
    // "cpu" or "wall": which is the time of the case (timing.h); empty: no answer.
    std::string clock;
    std::vector<Preparation> preparation;
    std::vector<FirstAnswer> answers;
    std::vector<Repeat> repeats;
    int repeats_asked = 0;  // of the round; there are fewer where time ran out
    bool stages_asked = false;
    std::vector<TraceSample> trace;
    double proven_upper = unknown;  // by a checked certificate of this answer; NaN: none
    std::string fields_sha256;      // hash of their file, beside the journal (field_file.h)
    bool from_trace = false;
    // Other work of the run may have shared the machine: its times are not comparable.
    bool side_by_side = false;
    std::string build, machine;
};

bool same_answer(const Outcome& a, const Outcome& b);  // status and bounds, bit for bit

// What re-checking found, see check/verify.h.
enum class Verdict {
    holds,        // lower: proven by its witness; upper: above every verified lower bound
    unsound,      // lower above the distance of its witness, or upper below a verified lower bound
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

}  // namespace hausbench
