// Runs a plan: starts one worker for each solver and scene, keeps the journal, and writes the result.
#pragma once

#include "harness/plan/plan.h"
#include "harness/result/result_file.h"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace hausbench {

struct RunOptions {
    std::filesystem::path results;  // folder
    bool fresh = false;             // runs requested cases again that an earlier run finished
    bool any_build = false;         // keep rows of other builds of this program
    bool quiet = false;
    int jobs = 1;          // cases at a time; if more than one, times are marked as not comparable
    bool cluster = false;  // marks them so in any case; keeps rows of other machines
    // Runs nothing: takes over the journals of these names in the folder.
    std::vector<std::string> collect = {};
    std::string suffix;  // follows the stem in names of journal and result (shards)
    // Finished cases to run again; null: none. It sees no checks.
    std::function<bool(const Row&)> again;
    ShapesOf shapes_of;  // see earlier.h
};

struct RunSummary {
    std::filesystem::path file;
    ResultFile result;                 // of its rows those that this run was asked for
    std::size_t kept = 0;              // earlier rows that the file has besides, see earlier.h
    std::vector<std::string> unsound;  // a line for each row that should not be
    std::size_t unsound_expected = 0;  // how many were, see plan.h
    // Cases with a round still to run: none, unless it was interrupted or only collected.
    std::size_t open = 0;
    bool interrupted = false;
};

// Resumes by itself: cases in the journal of the same identity and build are not run again. Ctrl-C (SIGINT, SIGTERM) ends
// the worker, writes what there is and leaves a journal to resume from.
RunSummary run_plan(const Plan& plan, const RunOptions& options);

}  // namespace hausbench
