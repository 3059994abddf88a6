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
    bool fresh = false;             // runs requested cases again even if an earlier run finished them
    bool any_build = false;         // keeps answers of other builds of this program
    bool quiet = false;
    int jobs = 1;          // most cases at a time; if more than one, times are marked as not comparable
    bool cluster = false;  // always marks times so; keeps answers of other machines
    // Journals in the folder to take answers from; if there are any, nothing is run.
    std::vector<std::string> collect = {};
    std::string suffix;  // follows the stem in the names of journal and result (shards)
    // Chooses finished cases to run again; null: none. The rows that it gets have not been checked yet.
    std::function<bool(const Row&)> again;
    ShapesOf shapes_of;  // see earlier.h
};

struct RunSummary {
    std::filesystem::path file;
    ResultFile result;                 // with only the rows that this run was asked for
    std::size_t kept = 0;              // earlier rows that the file also contains, see earlier.h
    std::vector<std::string> unsound;  // a line for each unsound row that was not expected
    std::size_t unsound_expected = 0;  // unsound rows that were, see unsound_expected()
    // Cases with a round still to run: 0 unless the run was interrupted or only collected.
    std::size_t open = 0;
    bool interrupted = false;
};

// Runs a plan, or resumes it: cases that the journal holds with the same identity and build are not run again. Ctrl-C
// (SIGINT, SIGTERM) ends the worker, writes the rows so far and leaves a journal to resume from.
RunSummary run_plan(const Plan& plan, const RunOptions& options);

}  // namespace hausbench
