// Fills in the metadata of a run (/meta) and the records of its models.
#pragma once

#include "harness/plan/plan.h"
#include "harness/result/result_file.h"

#include <string>

namespace hausbench {

// Fills in the metadata known before any case runs, which describes the plan, the build and the machine.
void describe_run(ResultFile& result, const Plan& plan, const std::string& started, const std::string& finished);

// Returns the text to append to the name of the build if Plan::planted_slowdown distorts the times, otherwise an empty
// string. `merge` and `compare` refuse results of a build with this text.
std::string planted(const Plan& plan);

ModelRecord record_of(const ModelRow& model);

}  // namespace hausbench
