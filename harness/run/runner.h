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
    bool fresh = false;             // forget what an earlier run finished of what this one is asked for
    bool any_build = false;         // keep rows of other builds of this program
    bool quiet = false;
    int jobs = 1;                           // at a time; of more than one, rows say that their times compare with none
    bool cluster = false;                   // they say so in any case, and rows of other machines stay
    std::vector<std::string> collect = {};  // runs nothing: takes over the journals of these names in the folder
    std::string suffix;                     // after the stem in the names of journal and result (shards)
    std::function<bool(const Row&)> again;  // which finished cases are run again; null: none. It sees no checks
    ShapesOf shapes_of;                     // see earlier.h
};

struct RunSummary {
    std::filesystem::path file;
    ResultFile result;                 // of its rows those that this run was asked for
    std::size_t kept = 0;              // earlier rows that the file has besides, see earlier.h
    std::vector<std::string> unsound;  // a line for each row that should not be
    std::size_t unsound_expected = 0;  // how many were, see plan.h
    std::size_t open = 0;  // cases that some round has still to run: none, unless it was interrupted or only collected
    bool interrupted = false;
};

// Resumes by itself: cases in the journal of the same identity and build are not run again. Ctrl-C (SIGINT, SIGTERM) ends
// the worker, writes what there is and leaves a journal to resume from.
RunSummary run_plan(const Plan& plan, const RunOptions& options);

}  // namespace hausbench
