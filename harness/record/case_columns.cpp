#include "harness/record/column_of.h"

namespace hausbench {

using namespace columns;

const Columns<Case>& case_columns() {
    // Those of the identity stand first, in the order in which they are hashed.
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

}  // namespace hausbench
