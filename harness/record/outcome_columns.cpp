#include "harness/record/column_of.h"

namespace hausbench {

using namespace columns;

const Columns<Outcome>& outcome_columns() {
    using Entry = Outcome;
    static const Columns<Entry> all = {
        COLUMN(status,
               "`ok`, `timeout`, `out_of_memory`, `signal`, `skipped`, `failed`, `unsound`, "
               "`not_built`, `floor`, `budget`: see the table below"),
        COLUMN(reason, "one line, where the status is not `ok`"),
        COLUMN(solver_status, "the status that the solver returned: `converged`, `time_limit`, ..."),
        {"answer",
         "what an `ok` row says: `gap` (upper less the larger of lower and floor is within the tolerance), `h <= "
         "floor` or `h > cutoff`; else empty",
         Column<Entry>::Text{[](const Outcome& o) -> std::string {
                                 if (o.status != RowStatus::ok) return "";
                                 return o.solver_status == to_string(Status::below_floor)    ? "h <= floor"
                                        : o.solver_status == to_string(Status::above_cutoff) ? "h > cutoff"
                                                                                             : "gap";
                             },
                             nullptr}},
        COLUMN(
            cutoff_used,
            "the cutoff that the answer was given: in a search the least upper bound of the answers to the targets "
            "before it, if that is less than `cutoff`, but above `floor`; else `cutoff`; infinity: none, or no answer"),
        NAMED("lower", bounds.lower, "lower <= h(A posed, B posed), or H where `quantity` says so"),
        NAMED("upper", bounds.upper, "upper >= that distance"),
        NAMED("witness_source", witness.source_point,
              "a point on A posed: the one that proves the lower bound, or the closest to it"),
        NAMED("witness_target", witness.target_point, "likewise on B posed"),
        NAMED("witness_direction", witness.direction,
              "`source to target`: the point on A proves the lower bound; `target to source`: the one on B, where the "
              "distance is H"),
        NAMED("witness_source_element", witness.source_element, "point or triangle number, -1 unknown"),
        NAMED("witness_target_element", witness.target_element, "likewise"),
        COLUMN(prepare_seconds,
               "all structures together; each round prepares once, and this is the median of the rounds. In a matrix, "
               "what those of its two shapes cost when they were built, for whatever pair"),
        COLUMN(prepare_bytes, "all structures together"),
        COLUMN(solve_seconds,
               "wall time of the first answer of round 0; those of all rounds are in `/answers`. Where `from_trace` is "
               "1 and there is no row in `/answers`, of the sample of the trace"),
        COLUMN(reported_seconds,
               "the time that an outside program reports in round 0 (solver `external`), else NaN; `solve_seconds` and "
               "`/repeats` also include starting it and reading and writing files"),
        COLUMN(peak_bytes,
               "what the solver took, as in `measure`: peak resident set while preparing and solving less the resident "
               "set before preparing; of an outside program its own peak; -1 unknown, as in a matrix, whose pairs "
               "share shapes"),
        COLUMN(
            clock,
            "which of the times in `/answers` and `/repeats` is the time of the case: `cpu` where one thread works "
            "at a time, `wall` where several do (another thread of the process took more than a hundredth of its "
            "CPU time, or CPU time with children is more than 1.1 times wall time, in any round) or an outside program "
            "waits (its CPU time is less than a fifth of its wall time: a daemon or a GPU works, or it sleeps); empty "
            "without an answer. `solve_seconds` is wall time all the same"),
        COLUMN(from_trace, "1: not run; the answer is read from the trace of a finer tolerance"),
        COLUMN(side_by_side,
               "1: `--jobs` or a cluster may have run other cases on the machine at the same time, so the times of "
               "this row "
               "compare with none"),
        COLUMN(extras,
               "JSON object of further numbers that the solver reports, such as `alpha` of `adaptive`; each solver's "
               "file says what they mean"),
        COLUMN(facts, "JSON object of texts that the solver reports, such as `chosen` of `adaptive`"),
        COLUMN(
            proven_upper,
            "upper bound that a certificate of this answer proves, which the harness checked; NaN: none was asked for, "
            "as of all rows but references, or none was accepted (then `certificate` in `facts` says why)"),
        COLUMN(fields_sha256, "of the file that held the row's fields while it was run; empty: it has none"),
        COLUMN(build,
               "as in `/meta`; a resumed file may hold several; for a solver of a plug-in, a hash of the program and "
               "the plug-in"),
        COLUMN(machine, "as in `/meta`"),
    };
    return all;
}

}  // namespace hausbench
