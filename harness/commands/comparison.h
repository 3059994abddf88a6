// Compares two results of the same experiment, or two solvers of one result.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/result/result_file.h"

#include <string>

namespace hausbench {

// Rows of the same identity side by side: differing answers first, then the ratio of times (candidate / base), which is called
// faster or slower only at 95 % confidence. Throws InputError where no case is in both.
std::string compare_results(const ResultFile& base, const ResultFile& candidate);

// Each is a label, or a label with its parameters, "guthe(samples=8)": paired by scene, poses, quantity
// and tolerance, and, where both sweep the same parameters, by these. First the pairs whose intervals do not overlap, since
// one of them is wrong; then those where one has no answer; then ratios of times round by round, second / first. Throws InputError
// for a solver that the result does not have, or where no case is of both.
std::string compare_solvers(const ResultFile& result, const std::string& first, const std::string& second,
                            const Paper& paper);

}  // namespace hausbench
