// A case: one query to one solver. Everything that can change its answer goes into its identity, a hash.
#pragma once

#include "algorithms/options.h"
#include "algorithms/solver.h"
#include "harness/ask/tolerance.h"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

struct Limits {
    // Time limit for one answer. All timed repeats together may take twice as long.
    double case_seconds = 60;
    double prepare_seconds = 120;                       // for loading and preparing
    std::int64_t memory_bytes = std::int64_t(8) << 30;  // resident set of a worker
};

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
    std::string statistic;          // for Quantity::distribution, as statistic_of() reads it; otherwise empty
    WeighBy weigh = WeighBy::area;  // likewise
    double tolerance = 0;
    std::string tolerance_of;
    double floor = 0, cutoff = std::numeric_limits<double>::infinity();  // lengths, see Query
    std::int64_t budget = -1;                                            // see Query; -1: none
    int threads = 1;                                                     // the most that the solver may use
    // Hash of the files that the solver's command line names (plan/command_files.h). Empty if the solver runs no
    // command, or if none of the files was found.
    std::string program_sha256;
    Limits limits;
    // Whether the solver starts from the state that it kept at the previous pose.
    bool warm = false;
    // Identity of the previous case: if `warm`, the case of the previous pose; in a search for the nearest target, the
    // case of the previous target, whose answer may lower the cutoff. Empty: no such case.
    std::string chain;
    double exact = unknown;     // the true distance, if the experiment gives it
    std::string family;         // name of a sweep over severity that the scene belongs to
    double severity = unknown;  // position in that sweep
    // 1: the solver promises bounds that hold under rounding. 0: it does not. -1: unknown, because it is not built.
    int certified = -1;

    double unit() const { return unit_of(tolerance_of, source_diagonal, source_longest); }
    Tolerance resolved_tolerance() const;  // a length, unless it is a fraction of the lower bound
};

// Returns the identity of a case: the hash of the two shapes and of the columns that columns.h marks as part of the
// identity.
std::string identify(const Case& spec);

// Returns the solver's name for display: "guthe", or "guthe(samples=8)" if the experiment sweeps a parameter.
std::string shown(const Case& spec);

// Returns the parameters of `options` that are not the same in all of `swept`, as text: "samples=8, seed=1".
std::string variant_of(const ParameterMap& options, const std::vector<ParameterMap>& swept);

// Returns the suffix that shows the quantity in a scene's name: ", H", ", depth" or ", mean"; empty for h(A,B).
std::string suffix_of(const Case& spec);

// Returns the same for a statistic; empty for other quantities.
std::string suffix_of_statistic(const Case& spec);

// Returns a readable name: "guthe on bunny, pose 0, tolerance 0.001 of diagonal".
std::string name_of(const Case& spec);

}  // namespace hausbench
