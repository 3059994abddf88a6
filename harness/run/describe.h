// Fills in the metadata of a run (/meta) and the records of its models.
#pragma once

#include "harness/plan/plan.h"
#include "harness/result/result_file.h"

#include <string>

namespace hausbench {

// What is known before any case ran: the plan, the build, the machine.
void describe_run(ResultFile& result, const Plan& plan, const std::string& started, const std::string& finished);

// What follows the name of the build where times are not those of the solvers (Plan::planted_slowdown): merge and compare refuse such
// results. Else nothing.
std::string planted(const Plan& plan);

ModelRecord record_of(const ModelRow& model);

}  // namespace hausbench
