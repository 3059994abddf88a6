// Checks every row of a result again.
#pragma once

#include "datasets/catalogue.h"
#include "harness/result/result_file.h"

#include <string>
#include <vector>

namespace hausbench {

// Re-checks every row (verify.h) on the shapes of the catalogue, which must be the measured ones (SHA-256). Returns a
// line for each model that is not available, whose rows become `not checked` whatever the file says, and a line for
// each row that contradicts itself (claims.h). Throws InputError if a model has other bytes now.
std::vector<std::string> verify_result(ResultFile& result, const Catalogue& catalogue);

// Returns a table with the number of rows of each solver that hold, are unsound, have no witness or were not checked;
// then each unsound row.
std::string describe_checks(const ResultFile& result);
bool any_unsound(const ResultFile& result);

}  // namespace hausbench
