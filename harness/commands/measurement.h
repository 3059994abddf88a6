// `hausbench measure A B`: bounds the distance between any two files.
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
    bool tolerance_given = false;  // --tolerance or --of was given; it is then an error if the unit is 0 for A
    bool symmetric = false;        // H(A,B) = max(h(A,B), h(B,A))
    bool penetration = false;      // the penetration depth instead of a distance
    // Asks only "is the distance above this length?"; a gap within the tolerance then does not end the solve.
    std::optional<double> cutoff;
    int threads = 1;
    // In seconds; preparing and solving each may take this long.
    double time_limit = std::numeric_limits<double>::infinity();
    std::filesystem::path fields = {};       // file to write the fields to; empty: none
    double resolution = 0.1;                 // largest error of the fields between vertices, as a fraction of h
    std::filesystem::path certificate = {};  // file to write the certificate to; empty: none
    bool in_process = false;                 // solves in this process, for debuggers

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
    double float32_spacing = 0;     // spacing of float32 numbers at its largest coordinate
    std::vector<Index> parts = {};  // for a mesh: the connected part of each triangle
};

// A file that --fields wrote: A, cut into pieces, with the distance to B at each vertex; or B with the distance to A.
struct DrawnFile {
    std::filesystem::path file;
    Bounds bounds;       // of h(A,B), or of h(B,A) in the file of B
    double largest = 0;  // the largest distance of a vertex
    std::int64_t vertices = 0, pieces = 0;
    bool resolved = true;  // false: the resolution needs more pieces than are written
};

// The reason for a missing answer: the solving process was killed, or it ended without an answer. `status` has the
// meaning of a row's status (record/outcome.h).
struct NoAnswer {
    RowStatus status = RowStatus::failed;
    std::string reason;
};

struct Measured {
    std::string solver;
    bool certified = false;  // the bounds hold under rounding, with the options given
    MeasuredShape source, target;
    double tolerance_absolute = 0;  // the tolerance as a length; NaN if it is a fraction of the lower bound
    // The requested unit of the tolerance; if that length is 0 for A, `diagonal of both` or `absolute` instead.
    std::string tolerance_of;
    double unit = 1;    // the length of which the tolerance is a fraction
    double extent = 0;  // the diagonal of the box of both shapes
    Result result;
    // With --symmetric: h(A,B) and h(B,A). In both, as in `result`, the source point of the witness is on A.
    std::optional<Result> forward, backward;
    double forward_seconds = 0, backward_seconds = 0;
    double prepare_seconds = 0, solve_seconds = 0;
    std::int64_t peak_bytes = -1;
    std::optional<NoAnswer> failed;
    // Upper bound that the written certificate proves; empty if none was written.
    std::optional<double> proven;
    std::string why_not_proven = {};  // one line: why not, if a certificate was requested
    // One line that says why the written certificate may prove nothing; empty if its check passed.
    std::string doubt = {};
    std::vector<DrawnFile> drawn = {};  // A; with --symmetric also B
    std::string why_not_drawn = {};     // one line: why not all fields were written
    std::vector<std::string> warnings = {};
};

// Loads the files, then solves in a process of its own. Preparing, solving, and writing or checking each requested file
// may each take the time limit and a grace period (grace_of()); then the process is killed. If a solver crashes, hangs,
// ends the process or throws, measure() still returns, with `failed` set. Throws InputError for anything wrong with the
// files, the solver, its parameters or the tolerance.
Measured measure(const MeasureRequest& request);

// Returns whether the certificate proves only a larger upper bound than the answer has, by more than proves_the_bound()
// allows. This is possible because the certificate comes from a second run, which may have had less time.
bool proves_less(const Measured& measured);

// Returns how long to wait for the process beyond a time limit, in seconds.
double grace_of(double time_limit);

// Returns the reason for a missing answer: the solver failed, its bounds are impossible, or it stalled at [0,
// infinity]. Empty if there is an answer.
std::string no_answer(const Measured& measured);

// Returns the exit code. Without a cutoff: 0; 1 if the answer, the requested fields or the requested certificate are
// missing, or if the check refuses the certificate. With a cutoff: 0 if the distance is at most the cutoff, 1 if it
// is above, 3 if neither is proven.
int exit_code(const Measured& measured, const MeasureRequest& request);

nlohmann::json to_json(const Measured& measured, const MeasureRequest& request);
// Returns text for a person, which ends in a newline.
std::string describe(const Measured& measured, const MeasureRequest& request);

}  // namespace hausbench
