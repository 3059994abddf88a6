// Fills in the metadata of a run (/meta) and the records of its models.
#pragma once

#include "plan/plan.h"
#include "result/result_file.h"

namespace hausbench {

// What is known before any case ran: the plan, the build, the machine.
void describe_run(ResultFile& result, const Plan& plan, const std::string& started, const std::string& finished);

ModelRecord record_of(const ModelRow& model);

}  // namespace hausbench
