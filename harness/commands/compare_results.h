// Compares two results of the same experiment.
#pragma once

#include "harness/result/result_file.h"

#include <string>

namespace hausbench {

// Rows of the same identity side by side: differing answers first, then the ratio of times (candidate / base), which is called
// faster or slower only at 95 % confidence. Throws InputError where no case is in both.
std::string compare_results(const ResultFile& base, const ResultFile& candidate);

}  // namespace hausbench
