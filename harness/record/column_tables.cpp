#include "harness/record/column_of.h"

#include <cmath>

namespace hausbench {

using namespace columns;

const Columns<Case>& case_columns() {
    // The columns of the identity come first. Do not reorder them: identify() hashes them in this order.
    using Entry = Case;
    static const Columns<Entry> all = {
        COLUMN(solver, "name of the solver in the registry", Identity::always),
        COLUMN(options, "all parameters of the solver, as a JSON object", Identity::always),
        COLUMN(source, "model of shape A", Identity::of_missing),
        COLUMN(target, "model of shape B", Identity::of_missing),
        COLUMN(pose, "pose of A: rotation row by row, then translation", Identity::always),
        COLUMN(tolerance_of,
               "unit of the tolerance: `diagonal` or `longest` (side) of A's box as loaded, whatever the pose; "
               "`lower`: the lower bound; `absolute`: a length",
               Identity::always),
        COLUMN(tolerance, "the tolerance, in that unit", Identity::always),
        NAMED("case_seconds_limit", limits.case_seconds, "limit of the time of one answer", Identity::always),
        NAMED("prepare_seconds_limit", limits.prepare_seconds, "limit of the time for loading and preparing",
              Identity::always),
        NAMED("memory_limit_bytes", limits.memory_bytes, "limit of resident memory", Identity::always),
        COLUMN(floor, "the solver may stop once the distance is known to be at most this length; 0: no such question",
               Identity::where_given),
        COLUMN(cutoff,
               "the solver may stop once the distance is known to be above this length; infinity: no such question",
               Identity::where_given),
        COLUMN(budget, "limit of the solver's own unit of work, which its source file names; -1: none",
               Identity::where_given),
        COLUMN(target_pose, "pose of B, in the same form", Identity::where_given),
        COLUMN(
            quantity,
            "`directed`: h(A,B); `symmetric`: H(A,B); `penetration`: depth of A and B in each other; `distribution`: "
            "the value named by `statistic`",
            Identity::where_given),
        COLUMN(warm, "1: the solver starts from what it kept of the pose before; 0: from nothing",
               Identity::where_given),
        COLUMN(chain,
               "`identity` of the case before: with `warm` that of the pose before, in a search that of the target "
               "before; empty: first of its chain",
               Identity::where_given),
        COLUMN(threads, "threads that the solver may use; 1 if it supports only one", Identity::where_given),
        COLUMN(program_sha256,
               "SHA-256 of the programs and files in the command line of `external`; empty for other solvers",
               Identity::where_given),
        COLUMN(frame, "frame of a recorded simulation; -1: not a recording", Identity::where_given),
        COLUMN(
            statistic,
            "statistic of the distance, such as `mean` or `quantile 0.95 pooled`; `within 0.1`, a share, has no unit. "
            "Empty for other quantities",
            Identity::where_given),
        COLUMN(weigh, "what the statistic counts: `area`, or `number` of vertices", Identity::where_given),
        COLUMN(identity, "SHA-256 of shapes, poses, solver, options, tolerance and limits"),
        COLUMN(label, "name in tables and figures; the solver's unless the experiment gives one"),
        COLUMN(variant,
               "the parameters that the experiment varies, such as `samples=8, seed=1`; empty: it varies none, or the "
               "file is old"),
        COLUMN(profile, "profiles that ask for the case, with commas between; empty in old files: the one in `/meta`"),
        COLUMN(certified,
               "1: the bounds hold under the rounding of the solver's own arithmetic; 0: they hold in exact "
               "arithmetic, or the solver promises less; -1: unknown, because the solver is not built"),
        COLUMN(scene, "name of the scene"),
        NAMED("scene_note", note, "remark of the experiment on the scene, such as which model stands in for which"),
        COLUMN(exact, "true distance, if the experiment knows it; else NaN"),
        COLUMN(family, "name of the sweep over `severity` to which the scene belongs, such as `offset`; empty: none"),
        COLUMN(severity, "value of the scene in that sweep; NaN: none"),
        COLUMN(source_elements, "points or triangles of A"),
        COLUMN(target_elements, "points or triangles of B"),
        COLUMN(source_diagonal, "diagonal of the box of A as loaded"),
        COLUMN(source_longest, "longest side of that box; 0 in old files"),
        COLUMN(pose_index, "number of the pose, from 0"),
        {"tolerance_absolute", "the tolerance as a length; NaN if its unit is `lower`",
         Column<Entry>::Real{1,
                             [](const Case& spec, double* out) {
                                 const Tolerance t = spec.resolved_tolerance();
                                 *out = t.of == Tolerance::Of::absolute ? t.value : unknown;
                             },
                             nullptr}},
    };
    return all;
}

const Columns<Outcome>& outcome_columns() {
    using Entry = Outcome;
    static const Columns<Entry> all = {
        COLUMN(status,
               "`ok`, `timeout`, `out_of_memory`, `signal`, `skipped`, `failed`, `unsound`, "
               "`not_built`, `floor`, `budget`: see the table below"),
        COLUMN(reason, "why the status is not `ok`, in one line"),
        COLUMN(solver_status, "status that the solver returned: `converged`, `time_limit`, ..."),
        {"answer",
         "what an `ok` row answers: `gap`: upper less the larger of lower and floor is within the tolerance; `h "
         "<= floor`; `h > cutoff`. Empty for other rows",
         Column<Entry>::Text{[](const Outcome& o) -> std::string {
                                 if (o.status != RowStatus::ok) return "";
                                 return o.solver_status == to_string(Status::below_floor)    ? "h <= floor"
                                        : o.solver_status == to_string(Status::above_cutoff) ? "h > cutoff"
                                                                                             : "gap";
                             },
                             nullptr}},
        COLUMN(cutoff_used,
               "cutoff that the solver was given. In a search: the least upper bound of the targets before, if it is "
               "below `cutoff` and above `floor`. Infinity: none, or no answer"),
        NAMED("lower", bounds.lower, "lower bound of h(A posed, B posed), or of what `quantity` names"),
        NAMED("upper", bounds.upper, "upper bound of the same"),
        NAMED("witness_source", witness.source_point,
              "a point on A posed: the one that proves the lower bound, or the one closest to it"),
        NAMED("witness_target", witness.target_point, "a point on B posed, likewise"),
        NAMED("witness_direction", witness.direction,
              "`source to target`: the point on A proves the lower bound; `target to source`: the point on B does, "
              "for a distance H"),
        NAMED("witness_source_element", witness.source_element,
              "number of the point or triangle of A that has the witness; -1: unknown"),
        NAMED("witness_target_element", witness.target_element, "the same of B"),
        COLUMN(prepare_seconds,
               "time to build all structures, as the median of the rounds. In a matrix: the time that the structures "
               "of its two shapes took when they were built, for whatever pair"),
        COLUMN(prepare_bytes, "memory of all structures together"),
        COLUMN(solve_seconds,
               "wall time of the first answer of round 0; `/answers` has those of all rounds. If `from_trace` is 1 "
               "and `/answers` has no row: the time of the sample in the trace"),
        COLUMN(reported_seconds,
               "time that an outside program (solver `external`) reports in round 0; else NaN. `solve_seconds` and "
               "`/repeats` also include starting it and exchanging files"),
        COLUMN(peak_bytes,
               "memory of the solver: peak resident set of preparing and solving, less the resident set before. Of an "
               "outside program its own peak. -1: unknown, as in a matrix, whose pairs share shapes"),
        COLUMN(clock,
               "which time in `/answers` and `/repeats` counts. `cpu`: one thread works at a time. `wall`: several do "
               "(in some round another thread took more than 1/100 of the CPU time, or CPU time with children exceeds "
               "1.1 times wall time), or an outside program waits (its CPU time is less than 1/5 of wall time, "
               "because a daemon or a GPU works, or it sleeps). Empty without an answer. `solve_seconds` is always "
               "wall time"),
        COLUMN(from_trace, "1: not run, the answer was read from the trace of a finer tolerance"),
        COLUMN(side_by_side,
               "1: other cases may have run on the machine at the same time (`--jobs` or a cluster), so the times are "
               "not comparable"),
        COLUMN(extras,
               "numbers that the solver reports, such as `alpha` of `adaptive`, as a JSON object; each solver's file "
               "explains them"),
        COLUMN(facts, "texts that the solver reports, such as `chosen` of `adaptive`, as a JSON object"),
        COLUMN(proven_upper,
               "upper bound that a certificate of this answer proves, checked by the harness. NaN: none was asked for "
               "(only references have one), or none was accepted; `facts` then has the reason as `certificate`"),
        COLUMN(fields_sha256, "SHA-256 of the file that held the row's fields during the run; empty: no fields"),
        COLUMN(build,
               "build of the row, as in `/meta`; for a solver of a plug-in, a hash of program and plug-in. A resumed "
               "file may hold several"),
        COLUMN(machine, "machine of the row, as in `/meta`"),
    };
    return all;
}

const Columns<Check>& check_columns() {
    using Entry = Check;
    static const Columns<Entry> all = {
        NAMED("lower_check", lower,
              "check by the harness, not timed: `holds`, `unsound`, `no witness` (so not checked) or `not checked`"),
        NAMED("upper_check", upper, "the same of the upper bound"),
        NAMED("fields_check", fields, "the same of the fields, on 100 vertices and 100 elements of A"),
    };
    return all;
}

namespace {

double middle(const Bounds& bounds) { return bounds.lower + 0.5 * (bounds.upper - bounds.lower); }

template <double (*value)(const Row&)> Column<Row>::Real derived() {
    return {1, [](const Row& row, double* out) { *out = value(row); }, nullptr};
}
double lower_error(const Row& row) { return middle(row.reference) - row.outcome.bounds.lower; }
double upper_error(const Row& row) { return row.outcome.bounds.upper - middle(row.reference); }
double middle_error(const Row& row) { return std::abs(middle(row.outcome.bounds) - middle(row.reference)); }

}  // namespace

const Columns<Row>& row_columns() {
    using Entry = Row;
    static const Columns<Entry> all = {
        NAMED("reference_lower", reference.lower,
              "lower bound of the same distance by the reference answer (a row of `/references`); NaN: none"),
        NAMED("reference_upper", reference.upper, "its upper bound"),
        {"lower_error",
         "middle of the reference's interval less `lower`; differs from the true error by at most half of that "
         "interval",
         derived<lower_error>()},
        {"upper_error", "`upper` less that middle", derived<upper_error>()},
        {"middle_error", "difference of the middle of `lower` and `upper` from that middle", derived<middle_error>()},
    };
    return all;
}

const Columns<ModelRecord>& model_columns() {
    using Entry = ModelRecord;
    static const Columns<Entry> all = {
        COLUMN(name, "name in the catalogue"),
        COLUMN(sha256, "SHA-256 of its float64 coordinates and indices"),
        COLUMN(kind, "`points`, `mesh` or `surface`"),
        COLUMN(polynomial, "of a surface, its polynomial, which is 0 on it; else empty"),
        COLUMN(box, "of a surface, its box: least and greatest x, y and z; else NaN"),
        COLUMN(elements, "points or triangles; 1 for a surface"),
        COLUMN(vertices, "vertices; 2 for a surface, the corners of its box"),
        COLUMN(diagonal, "diagonal of the box of its points"),
        COLUMN(longest_side, "longest side of that box; 0 in old files"),
        COLUMN(precision, "`float64`, or `float32` if the reader rounds to it"),
        COLUMN(unreferenced, "vertices that no triangle uses, which were dropped; -1: unknown"),
        COLUMN(source, "where it comes from"),
        COLUMN(path, "path of the file, or within the package, as the manifest or experiment gives it; else empty"),
        COLUMN(file_sha256, "SHA-256 of that file"),
        COLUMN(licence, "licence, by its SPDX name if it has one"),
        COLUMN(note, "remark in the catalogue"),
    };
    return all;
}

const Columns<FirstAnswer>& answer_columns() {
    using Entry = FirstAnswer;
    static const Columns<Entry> all = {
        COLUMN(round, "round; each runs in fresh processes"),
        COLUMN(wall_seconds, "wall time of the first answer"),
        COLUMN(cpu_seconds,
               "CPU time of the process, all its threads and its ended children, with what the harness spends "
               "meanwhile, such as reading the output of an outside program"),
        COLUMN(reported_seconds, "time that an outside program reports; else NaN"),
    };
    return all;
}

const Columns<Repeat>& repeat_columns() {
    using Entry = Repeat;
    static const Columns<Entry> all = {
        COLUMN(round, "round"),
        COLUMN(wall_seconds, "wall time of one solve"),
        COLUMN(cpu_seconds, "CPU time of one solve, as in `/answers`"),
        COLUMN(iterations, "number of solves in one timing"),
    };
    return all;
}

const Columns<Preparation>& preparation_columns() {
    using Entry = Preparation;
    static const Columns<Entry> all = {
        COLUMN(round, "round"),
        COLUMN(name, "name of the structure; `solver`: what the solver built itself"),
        COLUMN(seconds, "wall time to build it"),
        COLUMN(bytes, "memory of the structure"),
        COLUMN(shared,
               "1: it was already there, for another pair of a matrix or the other direction of H; `seconds` is the "
               "time that it took then"),
    };
    return all;
}

const Columns<TraceSample>& trace_columns() {
    using Entry = TraceSample;
    static const Columns<Entry> all = {
        COLUMN(seconds, "time since solving began"),
        COLUMN(lower, "lower bound"),
        COLUMN(upper, "upper bound"),
    };
    return all;
}

const Columns<FieldRecord>& field_columns() {
    using Entry = FieldRecord;
    static const Columns<Entry> all = {
        COLUMN(name,
               "`distance`: distance of each vertex of A posed to B posed; `nearest`: number of an element of B at "
               "that distance; others come from the solver, whose file explains them"),
        COLUMN(of,
               "what has values: `vertices` of A, then those that cuts added; `elements` of A; or `pieces`, into "
               "which A was cut. A point is both a vertex and an element"),
        COLUMN(meaning,
               "`lower`, `upper`: bound of the largest distance to B posed of a point of the element; `number`: "
               "anything else"),
        COLUMN(begin, "first value in `values`"),
        COLUMN(end, "value after the last"),
    };
    return all;
}

const Columns<LedgerEntry>& ledger_columns() {
    using Entry = LedgerEntry;
    static const Columns<Entry> all = {
        COLUMN(kind,
               "`not_built`, `not_prepared`, `not_run`; `prepared_again`: what could not be left out; `reference`: "
               "the time of the reference answers, as a negative saving"),
        COLUMN(subject, "solver and scene"),
        COLUMN(what,
               "what was left out, such as a structure. `structures for each pose` of a motion counts the poses that "
               "reused structures, because one process prepares once; with `prepared_again`, the poses that could not"),
        COLUMN(reason, "why this was safe; with `prepared_again`, why it had to be built again"),
        COLUMN(count, "number of cases, structures or poses"),
        COLUMN(seconds_saved, "time that it saved; NaN: unknown"),
        COLUMN(profile, "profile of the run"),
    };
    return all;
}

}  // namespace hausbench
