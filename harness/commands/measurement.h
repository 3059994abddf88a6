// `hausbench measure A B`: bounds the distance between any two files.
#pragma once

#include "datasets/load.h"
#include "harness/ask/ask.h"
#include "harness/ask/no_answer.h"
#include "harness/commands/named_shape.h"
#include "harness/record/row.h"

#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hausbench {

struct MeasureRequest {
    std::filesystem::path source, target;
    ShapeOptions reading = {};
    std::filesystem::path source_matrix = {}, target_matrix = {};  // files that transform() moves A and B by
    // Empty: cover for meshes, scan for point sets, surface_enclosure for surfaces.
    std::string solver;
    ParameterMap options;
    double tolerance = 1e-6;
    std::string of = "diagonal";   // unit of the tolerance, one of tolerance_units
    bool tolerance_given = false;  // --tolerance or --of was given; a unit of length 0 is then an error
    bool symmetric = false;        // H(A,B) = max(h(A,B), h(B,A))
    bool penetration = false;      // the penetration depth instead of a distance
    // If not empty: bounds these statistics of the distance instead. With `symmetric`, each one also over B and over
    // both shapes (asked_statistics()).
    std::vector<Statistic> statistics = {};
    WeighBy weigh = WeighBy::area;
    double share_tolerance = 1e-3;
    // If set, asks only whether the distance is above this: in the unit `of` if `of_given`, and otherwise a length. A gap
    // within the tolerance then does not end the solve.
    std::optional<double> cutoff;
    bool of_given = false;
    int threads = 1;
    std::uint64_t budget = std::numeric_limits<std::uint64_t>::max();  // as in Query
    // In seconds, for preparing and for solving separately.
    double time_limit = std::numeric_limits<double>::infinity();
    std::filesystem::path fields = {};       // file to write the fields to; empty: none
    double resolution = 0.1;                 // largest error of the fields between vertices, as a fraction of h
    std::filesystem::path certificate = {};  // file to write the certificate to; empty: none
    std::filesystem::path witness = {};      // file to write the witness to; empty: none
    bool in_process = false;                 // solves in this process, for debuggers

    Quantity quantity() const {
        if (penetration) return Quantity::penetration;
        if (!statistics.empty()) return Quantity::distribution;
        return symmetric ? Quantity::symmetric : Quantity::directed;
    }
    bool asks_for_h() const { return quantity() == Quantity::symmetric; }  // for H(A,B), by two directed answers
};

struct MeasuredShape {
    std::filesystem::path file;
    LoadReport report;
    ShapeKind kind{};
    CountedBy counted_by{};
    Index elements = 0, vertices = 0;
    double diagonal = 0;
    std::array<double, 3> extents = {};  // of its box, sorted
    double float32_spacing = 0;          // spacing of float32 numbers at its largest coordinate
    std::vector<Index> parts = {};       // for a mesh: number of the connected part of each triangle
};

// A file written by --fields: A, cut into small triangles (pieces), with the distance to B at each vertex. With
// --symmetric, a second file contains B.
struct DrawnFile {
    std::filesystem::path file;
    Bounds bounds;       // of h(A,B), or of h(B,A) in the file of B
    double largest = 0;  // the largest distance of a vertex
    std::int64_t vertices = 0, pieces = 0;
    bool resolved = true;  // false: the requested resolution needs more pieces than were written
};

struct Measured {
    std::string solver;
    bool certified = false;  // the bounds hold under rounding, with the options given
    MeasuredShape source, target;
    double tolerance_absolute = 0;  // the tolerance as a length; NaN if it is a fraction of the lower bound
    // The unit of the tolerance. If the requested unit is 0 for A, this is `diagonal of both` or `absolute` instead.
    std::string tolerance_of;
    double unit = 1;                    // the length of which the tolerance is a fraction
    std::optional<double> cutoff = {};  // as a length
    double extent = 0;                  // the diagonal of the box of both shapes
    Answer answer;                      // with --symmetric, also those for h(A,B) and h(B,A)
    std::int64_t peak_bytes = -1;
    std::optional<NoAnswer> failed;
    // The upper bound that the written certificate proves; empty if none was written.
    std::optional<double> proven;
    std::string why_not_proven = {};  // one line: why no certificate was written, if one was requested
    // Why the written certificate may prove nothing, in one line; empty if its check passed.
    std::string doubt = {};
    std::vector<DrawnFile> drawn = {};  // the file of A; with --symmetric also the file of B
    std::string why_not_drawn = {};     // one line: why not all fields were written
    bool no_witness = false;            // the witness was asked for, and is not known
    std::vector<std::string> warnings = {};
    std::vector<std::string> notes = {};  // how the files were read, each one line
};

// Loads the files, then solves in a separate process. If a solver crashes, hangs, ends the process or throws, measure()
// still returns, with `failed` set. Preparing, solving, and writing or checking each requested file may each take the
// time limit plus grace_of() (process/listener.h); then the process is killed. Throws InputError if the files, the solver, its parameters or
// the tolerance are wrong.
Measured measure(const MeasureRequest& request);

// Returns whether the certificate proves only a larger upper bound than the answer has, by more than proves_the_bound()
// allows. This can happen because the certificate comes from a second run, which may have had less time.
bool proves_less(const Measured& measured);

// Returns the statistics that `request` asks for of shapes that are counted so. With `symmetric`, first all over A, then all
// over B, and so on; `pooled` only if both shapes are counted by the same.
std::vector<Statistic> asked_statistics(const MeasureRequest& request, CountedBy source, CountedBy target);

// Returns the reason for a missing answer: the solver failed, its bounds are impossible, or it stalled with the bounds
// [0, infinity]. Returns an empty string if there is an answer.
std::string no_answer(const Measured& measured);

// Returns the exit code of `measure`. Without a cutoff, it is 1 if the answer, the requested fields or the requested
// certificate is missing, or if the check refuses the certificate, and otherwise 0. With a cutoff, it is 0 if the
// distance is at most the cutoff, 1 if it is above, and 3 if neither is proven.
int exit_code(const Measured& measured, const MeasureRequest& request);

nlohmann::json to_json(const Measured& measured, const MeasureRequest& request);
std::string describe(const Measured& measured, const MeasureRequest& request);

}  // namespace hausbench
