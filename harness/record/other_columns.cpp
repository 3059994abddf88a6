#include "harness/record/column_of.h"

#include <cmath>

namespace hausbench {

using namespace columns;

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
