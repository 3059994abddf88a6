// Runs a plan: starts a worker process for each solver and scene, saves the answers in the journal, and writes the
// result.
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
    bool any_build = false;         // keeps answers of other builds and machines
    bool quiet = false;
    int jobs = 1;          // cores to use; if more than one, jobs run side by side and times are marked not comparable
    bool cluster = false;  // marks times as not comparable in any case, and keeps answers of other machines
    // Names of journals in the folder `results`. If any are given, the run only collects their answers.
    std::vector<std::string> collect = {};
    std::string suffix;  // follows the stem in the names of journal and result; tells shards apart
    // Returns whether to run a finished row, which has not been verified yet, again. Null: no row is run again.
    std::function<bool(const Row&)> again;
    ShapesOf shapes_of;  // see earlier.h
};

struct RunSummary {
    std::filesystem::path file;        // the result file
    ResultFile result;                 // its content, but only the rows that this run was asked for
    std::size_t kept = 0;              // number of earlier rows that the file also contains, see earlier.h
    std::vector<std::string> unsound;  // a line for each unsound row, except those counted in unsound_expected
    std::size_t unsound_expected = 0;  // number of unsound rows that are a result, see unsound_expected()
    // Number of cases that still have to run in some round. It is 0 unless the run was interrupted or only collected
    // answers.
    std::size_t open = 0;
    bool interrupted = false;
};

// Runs a plan, or resumes it: a case is not run again if the journal has its answer from the same build. On Ctrl-C
// (SIGINT) or SIGTERM, ends the worker and writes the rows so far.
RunSummary run_plan(const Plan& plan, const RunOptions& options);

}  // namespace hausbench
