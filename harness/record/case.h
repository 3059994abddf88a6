// A case: one question to one solver. Everything that can change its answer goes into its identity.
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
    // For one answer; timed repeats together may take twice as long.
    double case_seconds = 60;
    double prepare_seconds = 120;                       // for loading and preparing
    std::int64_t memory_bytes = std::int64_t(8) << 30;  // resident set of a worker
};

// Units of a tolerance: the diagonal or the longest side of A's box, an absolute length, or the lower bound.
inline const std::vector<std::string> tolerance_units = {"diagonal", "longest", "absolute", "lower"};

// Returns the length of one unit, given the diagonal and the longest side of A's box. Both are measured
// on A as loaded, for every pose and for both directions of H. Returns 1 for `absolute` and `lower`.
double unit_of(const std::string& of, double diagonal, double longest_side);

// Returns the diagonal of the box that holds both.
double diagonal_of_both(const Points& a, const Points& b);

// Returns tolerance * unit, clamped to a finite length above 0.
double tolerance_as_length(double tolerance, double unit);

struct Case {
    std::string identity;  // SHA-256, see identify()
    std::string solver, label;
    std::string profile;   // the profiles of the experiment that request it, joined by commas
    std::string variant;   // the parameters that the experiment varies: "samples=8, seed=1"; empty: none
    ParameterMap options;  // every parameter of the solver
    std::string scene, note, source, target;
    std::string source_hash, target_hash;  // of the shapes; empty for a missing model
    std::int64_t source_elements = 0, target_elements = 0;
    double source_diagonal = 0, source_longest = 0;  // of A's box as loaded, whatever the pose
    int pose_index = 0;
    int frame = -1;          // frame of a recorded simulation; -1: the scene is not a recording
    Pose pose, target_pose;  // of A and of B
    Quantity quantity = Quantity::directed;
    double tolerance = 0;
    std::string tolerance_of;
    double floor = 0, cutoff = std::numeric_limits<double>::infinity();  // lengths, see Query
    std::int64_t budget = -1;                                            // see Query; -1: none
    int threads = 1;                                                     // the most that the solver may use
    // Hash of the files that the solver's command line names (plan/command_files.h); empty: the solver runs no command,
    // or none of its files was found.
    std::string program_sha256;
    Limits limits;
    // A warm case starts from the state that the solver kept from the case of the previous pose; `chain` is the
    // identity of that case. In a search (for the target nearest to each source) a case is not warm, but its cutoff
    // comes from the earlier targets; `chain` is then the identity of the case of the previous target. Empty: first
    // case of its chain.
    bool warm = false;
    std::string chain;
    double exact = unknown;     // the true distance, if the experiment gives it
    std::string family;         // name of a sweep over severity that the scene belongs to
    double severity = unknown;  // position in that sweep
    // 1: the solver promises bounds that hold under rounding; 0: it does not; -1: not built, so unknown.
    int certified = -1;

    double unit() const { return unit_of(tolerance_of, source_diagonal, source_longest); }
    Tolerance resolved_tolerance() const;  // a length, unless it is a fraction of the lower bound
};

// Returns the identity: the hash of the two shapes and of the columns that columns.h marks as part of it.
std::string identify(const Case& asked);

// Returns the solver's name for display: "guthe", or "guthe(samples=8)" if the experiment sweeps a parameter.
std::string shown(const Case& asked);

// Returns the parameters of `one` that are not the same in all of `swept`, such as "samples=8, seed=1".
std::string variant_of(const ParameterMap& one, const std::vector<ParameterMap>& swept);

// Returns the suffix of a scene's name for quantities other than h(A,B): ", H" or ", depth".
std::string suffix_of(Quantity quantity);

// Returns a name for people: "guthe on bunny, pose 0, tolerance 0.001 of diagonal".
std::string name_of(const Case& asked);

}  // namespace hausbench
