#include "harness/record/column_of.h"

#include <cmath>

namespace hausbench {

using namespace columns;

const Columns<Case>& case_columns() {
    // Columns of the identity come first, in the order in which they are hashed.
    using Entry = Case;
    static const Columns<Entry> all = {
        COLUMN(solver, "registry name", Identity::always),
        COLUMN(options, "JSON object of every parameter", Identity::always),
        COLUMN(source, "model of the scene that is A", Identity::of_missing),
        COLUMN(target, "model of the scene that is B", Identity::of_missing),
        COLUMN(pose, "of A: rotation row by row, then translation", Identity::always),
        COLUMN(tolerance_of,
               "what the tolerance is a fraction of: the `diagonal` or the `longest` side of the box of A as loaded, "
               "whatever the pose, or `lower`; or `absolute`: a length",
               Identity::always),
        COLUMN(tolerance, "as asked", Identity::always),
        NAMED("case_seconds_limit", limits.case_seconds, "for one answer", Identity::always),
        NAMED("prepare_seconds_limit", limits.prepare_seconds, "for loading and preparing", Identity::always),
        NAMED("memory_limit_bytes", limits.memory_bytes, "of resident memory", Identity::always),
        COLUMN(floor, "a distance of at most this length is of no interest; 0: none", Identity::where_given),
        COLUMN(cutoff, "a distance above this length is known well enough; infinity: none", Identity::where_given),
        COLUMN(budget, "of the solver's own unit of work, see its file; -1: none", Identity::where_given),
        COLUMN(target_pose, "of B, likewise", Identity::where_given),
        COLUMN(quantity,
               "`directed`: h(A,B); `symmetric`: H(A,B), the larger of h(A,B) and h(B,A); or `penetration`: how deep A "
               "and B are in each other",
               Identity::where_given),
        COLUMN(warm, "1: the solver starts from what it kept of the pose before; 0: from nothing",
               Identity::where_given),
        COLUMN(chain,
               "of a warm case: the `identity` of the case of the pose before it; in a search: of the target before "
               "it; empty at the first",
               Identity::where_given),
        COLUMN(threads, "that the solver may use; 1 for a solver that offers no more", Identity::where_given),
        COLUMN(program_sha256,
               "of the programs and files that the command line of `external` names; empty: there is none",
               Identity::where_given),
        COLUMN(frame, "of a recorded simulation; -1: the scene is none", Identity::where_given),
        COLUMN(identity, "SHA-256 of shapes, poses, solver, options, tolerance, limits"),
        COLUMN(label, "name in figures: that of the solver unless the experiment gives one"),
        COLUMN(variant,
               "the parameters that the experiment sweeps, as in `samples=8, seed=1`; empty where it sweeps none, and "
               "in older files"),
        COLUMN(profile,
               "of the experiment, that asks for the case; several are joined by commas; empty in older files: that of "
               "`/meta`"),
        COLUMN(certified,
               "1: the solver's bounds hold under the rounding of its own arithmetic; 0: they hold in exact "
               "arithmetic, or it promises less; -1: unknown, since the solver is not built"),
        COLUMN(scene, "of the experiment"),
        NAMED("scene_note", note, "the experiment's remark on the scene, such as the model that it stands in for"),
        COLUMN(exact, "the true distance, where the experiment gives it; else NaN"),
        COLUMN(family, "the case of a sweep over severity, such as `offset`; empty: the scene is of none"),
        COLUMN(severity, "of the case, as the experiment gives it, such as the offset; NaN: it has none"),
        COLUMN(source_elements, "points or triangles of A"),
        COLUMN(target_elements, "points or triangles of B"),
        COLUMN(source_diagonal, "length, of the box of A as loaded"),
        COLUMN(source_longest, "length of the longest side of that box; 0 in older files"),
        COLUMN(pose_index, "number in the motions"),
        {"tolerance_absolute", "as a length (NaN for `lower`)",
         Column<Entry>::Real{1,
                             [](const Case& asked, double* out) {
                                 const Tolerance t = asked.resolved_tolerance();
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

const Columns<Check>& check_columns() {
    using Entry = Check;
    static const Columns<Entry> all = {
        NAMED("lower_check", lower,
              "the harness's own check, not timed: `holds`, `unsound`, `no witness` (so not checked), `not checked`"),
        NAMED("upper_check", upper, "likewise"),
        NAMED("fields_check", fields, "likewise, on 100 vertices and 100 elements of A"),
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
              "lower bound of the same distance by the reference answer (a row of `/references`); NaN: there is none"),
        NAMED("reference_upper", reference.upper, "likewise, upper bound"),
        {"lower_error",
         "middle of the reference's interval less `lower`: the true error but for half the width of that interval",
         derived<lower_error>()},
        {"upper_error", "`upper` less that middle", derived<upper_error>()},
        {"middle_error", "how far the middle of `lower` and `upper` is from that middle", derived<middle_error>()},
    };
    return all;
}

const Columns<ModelRecord>& model_columns() {
    using Entry = ModelRecord;
    static const Columns<Entry> all = {
        COLUMN(name, "as in the catalogue"),
        COLUMN(sha256, "of the float64 coordinates and indices"),
        COLUMN(kind, "`points`, `mesh` or `surface`"),
        COLUMN(polynomial, "of a surface: the surface is where it vanishes; else empty"),
        COLUMN(box, "of a surface: from and to in x, y and z; else NaN"),
        COLUMN(elements, "points or triangles; of a surface 1"),
        COLUMN(vertices, "of a surface the two corners of its box"),
        COLUMN(diagonal, "of the box of its points"),
        COLUMN(longest_side, "of that box; 0 in older files"),
        COLUMN(precision, "`float64`, or `float32` if the reader rounds to it"),
        COLUMN(unreferenced, "vertices dropped; -1 unknown"),
        COLUMN(source, "where it comes from"),
        COLUMN(path, "of a file, or in a package, as its table or the experiment gives it; else empty"),
        COLUMN(file_sha256, "of the bytes of that file, or of the one in a package"),
        COLUMN(licence, "SPDX where there is one"),
        COLUMN(note, "the catalogue's remark"),
    };
    return all;
}

const Columns<FirstAnswer>& answer_columns() {
    using Entry = FirstAnswer;
    static const Columns<Entry> all = {
        COLUMN(round, "each in fresh processes"),
        COLUMN(wall_seconds, ""),
        COLUMN(cpu_seconds,
               "of the process, all its threads and its children that ended; it includes what the harness spends "
               "meanwhile, such as reading what an outside program prints"),
        COLUMN(reported_seconds, "the time that an outside program reports, else NaN"),
    };
    return all;
}

const Columns<Repeat>& repeat_columns() {
    using Entry = Repeat;
    static const Columns<Entry> all = {
        COLUMN(round, ""),
        COLUMN(wall_seconds, "of one solve"),
        COLUMN(cpu_seconds, "of one solve, as in `/answers`"),
        COLUMN(iterations, "number of solves in one timing"),
    };
    return all;
}

const Columns<Preparation>& preparation_columns() {
    using Entry = Preparation;
    static const Columns<Entry> all = {
        COLUMN(round, ""),
        COLUMN(name, "of the structure, or `solver` for what the solver built itself"),
        COLUMN(seconds, "wall time"),
        COLUMN(bytes, ""),
        COLUMN(shared,
               "1: it was there already, for another pair of a matrix, or for the other direction of H; `seconds` is "
               "what it cost then"),
    };
    return all;
}

const Columns<TraceSample>& trace_columns() {
    using Entry = TraceSample;
    static const Columns<Entry> all = {
        COLUMN(seconds, "since solve began"),
        COLUMN(lower, ""),
        COLUMN(upper, ""),
    };
    return all;
}

const Columns<FieldRecord>& field_columns() {
    using Entry = FieldRecord;
    static const Columns<Entry> all = {
        COLUMN(name,
               "`distance`: of each vertex of A posed, its distance to B posed, a length; `nearest`: the number of the "
               "element of B that is as near; all others come from the solver, whose file says what they mean"),
        COLUMN(of,
               "`vertices` of A, then those that cuts added; `elements` of A; or `pieces`, into which A was cut; a "
               "point is a vertex and an element"),
        COLUMN(meaning,
               "`lower`, `upper`: a bound of the largest distance to B posed of a point of the element, a length; "
               "`number`: anything else"),
        COLUMN(begin, "first value in `values`"),
        COLUMN(end, "the one after the last"),
    };
    return all;
}

const Columns<LedgerEntry>& ledger_columns() {
    using Entry = LedgerEntry;
    static const Columns<Entry> all = {
        COLUMN(kind,
               "`not_built`, `not_prepared`, `not_run`; `prepared_again`: what could not be left out; `reference`: "
               "what the "
               "reference answers took, as a negative saving"),
        COLUMN(subject, "solver and scene"),
        COLUMN(what,
               "such as a structure. For motions, `structures for each pose` counts the poses that reused structures: "
               "one process prepares once and answers all poses; of kind `prepared_again`, the poses that could not"),
        COLUMN(reason, "why this was safe; of `prepared_again`, why it had to be"),
        COLUMN(count, "cases, structures, or poses"),
        COLUMN(seconds_saved, "NaN if unknown"),
        COLUMN(profile, "in which the experiment was run"),
    };
    return all;
}

}  // namespace hausbench
