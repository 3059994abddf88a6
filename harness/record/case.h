// A case is a question to a solver. Everything that can change its answer goes into its identity.
#pragma once

#include "algorithms/options.h"
#include "algorithms/solver.h"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct Limits {
    // One answer; timed repeats together may take twice as long.
    double case_seconds = 60;
    double prepare_seconds = 120;                       // for loading and preparing
    std::int64_t memory_bytes = std::int64_t(8) << 30;  // resident set of a worker
};

// The unit of a tolerance: the diagonal or the longest side of A's box, the lower bound, or a length.
inline const std::vector<std::string> tolerance_units = {"diagonal", "longest", "absolute", "lower"};

// Returns the length that 1 stands for if A's box has this diagonal and this longest side. Both belong to A as
// loaded, for every pose and for both directions of H.
double unit_of(const std::string& of, double diagonal, double longest_side);

// Diagonal of the box that contains both.
double diagonal_of_both(const Points& a, const Points& b);

// This fraction of a unit, as a length that is above 0 and finite.
double tolerance_as_length(double tolerance, double unit);

// A question. Everything that can change the answer goes into `identity`.
struct Case {
    std::string identity;  // SHA-256, see identify()
    std::string solver, label;
    std::string profile;   // of the experiment, that asks for it; several are joined by commas
    std::string variant;   // swept parameters: "samples=8, seed=1"; else empty
    ParameterMap options;  // every parameter of the solver
    std::string scene, note, source, target;
    std::string source_hash, target_hash;  // of the shapes; empty for a missing model
    std::int64_t source_elements = 0, target_elements = 0;
    double source_diagonal = 0, source_longest = 0;  // of A's box as loaded, whatever the pose
    int pose_index = 0;
    int frame = -1;          // of a recording; -1: the scene is none
    Pose pose, target_pose;  // of A, of B
    Quantity quantity = Quantity::directed;
    double tolerance = 0;
    std::string tolerance_of;
    double floor = 0, cutoff = std::numeric_limits<double>::infinity();  // lengths, see Query
    std::int64_t budget = -1;                                            // likewise; -1: none
    int threads = 1;                                                     // that the solver may use
    // See command_files.h; empty: the solver runs no command, or no file of it was found.
    std::string program_sha256;
    Limits limits;
    // A warm case starts from the state that the solver kept of the pose before, whose identity is `chain`; empty at
    // the head of the chain. In a search the cutoff comes from the targets before, and `chain` is the identity of the
    // last of them.
    bool warm = false;
    std::string chain;
    double exact = unknown;     // the true distance, where the experiment gives it
    std::string family;         // of a case that is swept over its severity; else empty
    double severity = unknown;  // where it is in that sweep
    // 1: the solver promises bounds that hold under rounding; 0: not; -1: not built, so unknown.
    int certified = -1;

    double unit() const { return unit_of(tolerance_of, source_diagonal, source_longest); }
    Tolerance resolved_tolerance() const;  // a length, unless it is a fraction of the lower bound
};

std::string identify(const Case& asked);

// The solver as it is shown: "guthe", or "guthe(samples=8)" where the experiment sweeps a parameter.
std::string shown(const Case& asked);

// Returns "samples=8, seed=1": the parameters of `one` that are not the same in all of `swept`.
std::string variant_of(const ParameterMap& one, const std::vector<ParameterMap>& swept);

// What follows a scene's name where the quantity is not h(A,B): ", H" or ", depth".
std::string suffix_of(Quantity quantity);

// For people: "guthe on bunny, pose 0, tolerance 0.001 of diagonal".
std::string name_of(const Case& asked);

}  // namespace hausbench
