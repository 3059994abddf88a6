// The work order that a worker process reads from its standard input: solver, shapes and cases.
#pragma once

#include "algorithms/session/session.h"
#include "harness/plan/plan.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hausbench {

struct WorkOrder {
    std::string solver;
    ParameterMap options;
    std::filesystem::path folder;  // folder from which relative paths in the options start
    struct Pair {
        std::filesystem::path source_file, target_file;
        QuerySet queries;
    };
    std::vector<Pair> pairs;
    // For a matrix: all shapes are scaled by 2^exponent, and each is loaded and prepared once.
    bool scaled = false;
    int exponent = 0;
    Limits limits;
    int round = 0, repeats = 0;
    Prepare build = Prepare::needed_only;
    double slowdown = 0;          // Plan::planted_slowdown
    std::vector<int> cores = {};  // cores of the worker; empty: any. Not sent to the worker

    // A case to answer.
    struct Item {
        std::size_t row;    // index in Plan::cases
        std::size_t pair;   // index in `pairs`; items of one pair are adjacent
        std::size_t chain;  // number of its warm chain, whose items are adjacent; a cold case is a chain of its own
        bool warm;
        Quantity quantity;
        Pose source_pose, target_pose;
        Tolerance tolerance;
        double floor, cutoff;
        std::int64_t budget;  // -1: none
        int threads;
        bool trace;
        std::vector<double> marks;
        std::filesystem::path fields = {};  // file to write the fields to; empty: not requested
        bool stages = false;
        bool proof = false;  // request a certificate of the answer and check it
        // Number of the search, in which the targets of one source are adjacent items; 0: not part of a search.
        std::size_t search = 0;

        // Lowers the cutoff to `least_upper`, the least upper bound among the earlier answers in the search: a target
        // that is farther away is not the nearest. Keeps the cutoff above the floor, because a query with floor and
        // cutoff equal is a yes/no question, in which the tolerance has no effect (see Query).
        void narrow(double least_upper);
    };
    std::vector<Item> items;

    // Return the index one past the last item of the chain, or of the pair, to which item `first` belongs.
    std::size_t chain_end(std::size_t first) const;
    std::size_t pair_end(std::size_t first) const;

    // Returns for each item how many shapes of its pair do not occur in an earlier pair. O(n log n).
    std::vector<int> new_shapes() const;
    std::map<std::filesystem::path, std::string> plugins = {};  // file -> SHA-256
};

// Convert a work order to bytes (CBOR, which can hold infinities) and back.
std::string packed(const WorkOrder& order);
WorkOrder unpacked(const std::string& bytes);

}  // namespace hausbench
