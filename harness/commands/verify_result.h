// Checks every row of a result again.
#pragma once

#include "datasets/catalogue.h"
#include "harness/result/result_file.h"

#include <string>
#include <vector>

namespace hausbench {

// Checks every row again (verify.h) on the models of the catalogue. Returns a line for each model that is not
// available, whose rows become `not checked`, and a line for each row that contradicts itself (contradictions.h). Throws
// InputError if a model does not have the recorded SHA-256.
std::vector<std::string> verify_result(ResultFile& result, const Catalogue& catalogue);

// Returns a table that counts, for each solver, the rows that hold, are unsound, have no witness or were not checked;
// then lists the unsound rows.
std::string describe_checks(const ResultFile& result);
bool any_unsound(const ResultFile& result);

}  // namespace hausbench
