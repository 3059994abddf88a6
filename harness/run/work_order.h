// What a worker reads from its standard input: solver, shapes and cases.
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
    std::filesystem::path folder;  // that relative paths in the options count from
    struct Pair {
        std::filesystem::path source_file, target_file;
        QuerySet queries;
    };
    std::vector<Pair> pairs;
    // A matrix: all shapes are scaled by 2^exponent, and each is loaded and prepared once.
    bool scaled = false;
    int exponent = 0;
    Limits limits;
    int round = 0, repeats = 0;
    Prepare build = Prepare::needed_only;
    double slowdown = 0;          // Plan::planted_slowdown
    std::vector<int> cores = {};  // cores of the worker; empty: any. Not sent to it
    struct Item {
        std::size_t row;
        std::size_t pair;   // items of one pair stand together
        std::size_t chain;  // so do those of one chain, in order; a cold case is a chain of its own
        bool warm;
        Quantity quantity;
        Pose source_pose, target_pose;
        Tolerance tolerance;
        double floor, cutoff;
        std::int64_t budget;  // -1: none
        int threads;
        bool trace;
        std::vector<double> marks;
        std::filesystem::path fields = {};  // file to write them into; empty: not asked for
        bool stages = false;
        bool proof = false;  // with a certificate of its answer, which the worker checks
        // Items of one search share a number and stand together; 0: no search.
        std::size_t search = 0;

        // Of a search whose answers so far have this least upper bound: what is farther away is of no interest. The cutoff stays above
        // the floor: at the floor it would ask another question, which no tolerance ends (Query).
        void narrow(double least_upper);
    };
    std::vector<Item> items;

    // One after the last item of the chain that begins at `first`, of the pair.
    std::size_t chain_end(std::size_t first) const;
    std::size_t pair_end(std::size_t first) const;

    // For each item, how many shapes of its pair no earlier pair has asked for. O(n log n).
    std::vector<int> new_shapes() const;
    std::map<std::filesystem::path, std::string> plugins = {};  // file -> SHA-256
};

// As bytes (CBOR, which holds infinities too), and back.
std::string packed(const WorkOrder& order);
WorkOrder unpacked(const std::string& bytes);

}  // namespace hausbench
