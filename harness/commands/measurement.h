// `hausbench measure A B`: the distance between any two files.
#pragma once

#include "datasets/load.h"
#include "harness/record/row.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hausbench {

inline constexpr double question_seconds = 10;  // default time limit with a cutoff

struct MeasureRequest {
    std::filesystem::path source, target;
    // Empty: cover for meshes, scan for point sets, surface_enclosure for surfaces.
    std::string solver;
    ParameterMap options;
    double tolerance = 1e-6;
    std::string of = "diagonal";   // one of tolerance_units
    bool tolerance_given = false;  // tolerance or `of` was given; an error if it means nothing
    bool symmetric = false;        // H = max of both directions
    bool penetration = false;      // the penetration depth, instead of a distance
    // Asks "is the distance above this length?"; the tolerance then does not end the solve.
    std::optional<double> cutoff;
    int threads = 1;
    double time_limit = std::numeric_limits<double>::infinity();  // for preparing, and for solving
    std::filesystem::path fields = {};                            // file to write them to; empty: none
    double resolution = 0.1;                                      // of the fields, relative to the distance
    std::filesystem::path certificate = {};                       // likewise
    bool in_process = false;                                      // solve in this process: for debuggers

    Quantity quantity() const {
        return penetration ? Quantity::penetration : symmetric ? Quantity::symmetric : Quantity::directed;
    }
};

struct MeasuredShape {
    std::filesystem::path file;
    LoadReport report;
    ShapeKind kind{};
    Index elements = 0, vertices = 0;
    double diagonal = 0;
    double float32_spacing = 0;     // of float32 at its largest coordinate
    std::vector<Index> parts = {};  // of a mesh: the connected part of each triangle
};

// A shape that was written with its fields.
struct DrawnFile {
    std::filesystem::path file;
    Bounds bounds;  // of the distance that it shows
    double largest = 0;
    std::int64_t vertices = 0, pieces = 0;
    bool resolved = true;  // false: it would take more pieces
};

// Why there is no answer: the process that solved was killed or ended. `status` is that of a row (record/outcome.h).
struct NoAnswer {
    RowStatus status = RowStatus::failed;
    std::string reason;
};

struct Measured {
    std::string solver;
    bool certified = false;  // the bounds hold under rounding, with the options given
    MeasuredShape source, target;
    double tolerance_absolute = 0;  // NaN: a fraction of the lower bound
    // The unit asked for, or its substitute if that means nothing: `diagonal of both`, `absolute`.
    std::string tolerance_of;
    double unit = 1;    // the length of which the tolerance is a fraction
    double extent = 0;  // the diagonal of the box of both shapes
    Result result;
    // The directions of H: h(A,B), h(B,A), with witnesses as in the result.
    std::optional<Result> forward, backward;
    double forward_seconds = 0, backward_seconds = 0;
    double prepare_seconds = 0, solve_seconds = 0;
    std::int64_t peak_bytes = -1;
    std::optional<NoAnswer> failed;
    // Upper bound that the written certificate proves; empty: none was written.
    std::optional<double> proven;
    std::string why_not_proven = {};  // one line: why not, where a certificate was asked for
    // One line: why the written certificate may prove nothing; empty: it was checked.
    std::string doubt = {};
    std::vector<DrawnFile> drawn = {};  // A; with --symmetric B too
    std::string why_not_drawn = {};     // one line: why not all were written
    std::vector<std::string> warnings = {};
};

// Loads the files, solves in a process of its own and waits for it, no longer than the time limit and a grace for preparing, and as
// long again for solving, and again for writing what was asked for beside the answer. A solver that crashes, hangs, ends the process or throws is an answer too: `failed`. Throws InputError for
// anything wrong with the files, the solver, its parameters or the tolerance.
Measured measure(const MeasureRequest& request);

// Whether the proof, of a second run, is of a larger upper bound than that of the answer: by more than proves_the_bound() allows.
bool proves_less(const Measured& measured);

// How long past a time limit the process is waited for.
double grace_of(double time_limit);

// Empty where the solver said anything at all: not where it stalled at [0, infinity], or failed.
std::string no_answer(const Measured& measured);

// 0, or 1 without an answer, or without the certificate that was asked for, or if its check refuses it. Of a question with a cutoff: 0 if the distance is at most that, 1 if it is above, 3 if that is open.
int exit_code(const Measured& measured, const MeasureRequest& request);

nlohmann::json to_json(const Measured& measured, const MeasureRequest& request);
// Text for a person; ends in a newline.
std::string describe(const Measured& measured, const MeasureRequest& request);

}  // namespace hausbench
