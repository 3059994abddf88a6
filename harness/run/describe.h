// Fills in the metadata of a result file (group /meta) and a record for each model that the run used.
#pragma once

#include "harness/plan/plan.h"
#include "harness/result/result_file.h"

#include <string>

namespace hausbench {

// Fills in the metadata of a result: the plan, the build, the machine, and when the run started and finished.
void describe_run(ResultFile& result, const Plan& plan, const std::string& started, const std::string& finished);

ModelRecord record_of(const ModelRow& model);

}  // namespace hausbench
