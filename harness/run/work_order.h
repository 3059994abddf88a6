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
    // True for a matrix: all shapes are scaled by 2^exponent, and each is loaded and prepared once.
    bool scaled = false;
    int exponent = 0;
    Limits limits;
    int round = 0, repeats = 0;
    Prepare build = Prepare::needed_only;
    std::vector<int> cores = {};  // cores of the worker; empty: any. Not sent to the worker

    // A case to answer.
    struct Item {
        std::size_t row;    // index in Plan::cases
        std::size_t pair;   // index in `pairs`; items of one pair are adjacent
        std::size_t chain;  // number of its warm chain, whose items are adjacent; a cold case is a chain of its own
        bool warm;
        Query query;  // if it wants a certificate, that is checked
        bool trace;
        std::vector<double> marks;
        std::filesystem::path fields = {};  // file to write the fields to; empty: not requested
        bool stages = false;
        // Number of the search that the case belongs to; 0: none. A search compares one source with several targets;
        // its items are adjacent.
        std::size_t search = 0;

        // Lowers the cutoff to `least_upper`, the smallest upper bound among the earlier answers in the search, because
        // a target that is farther away is not the nearest. The cutoff stays above the floor: if both were equal, the
        // query would be a yes/no question, which ignores the tolerance (see Query).
        void narrow(double least_upper);
    };
    std::vector<Item> items;

    // Return the end of the chain, or of the pair, to which item `first` belongs: the index after its last item.
    std::size_t chain_end(std::size_t first) const;
    std::size_t pair_end(std::size_t first) const;

    // Returns for each item how many shapes of its pair do not occur in an earlier pair.
    std::vector<int> new_shapes() const;
    std::map<std::filesystem::path, std::string> plugins = {};  // file -> SHA-256
};

// Returns the query of a case.
Query query_of(const Case& spec);

// Convert a work order to bytes and back. The format is CBOR, because JSON cannot hold infinities.
std::string packed(const WorkOrder& order);
WorkOrder unpacked(const std::string& bytes);

}  // namespace hausbench
