// Compares two results of the same experiment, or two solvers of one result.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/result/result_file.h"

#include <string>

namespace hausbench {

// Compares rows of the same identity: lists differing answers first, then the ratio of times (candidate / base),
// which is called faster or slower only at 95 % confidence. Throws InputError if no case is in both results.
std::string compare_results(const ResultFile& base, const ResultFile& candidate);

// Compares two solvers, each given by its label, also with parameters: "guthe(samples=8)". Their rows are paired by
// scene, poses, quantity and tolerance, and by swept parameters if both sweep the same ones. Lists the pairs whose
// intervals do not overlap first, since one of them is wrong; then pairs in which one has no answer; then ratios of
// times round by round, second / first. Throws InputError if the result lacks a solver, or if they have no case in
// common.
std::string compare_solvers(const ResultFile& result, const std::string& first, const std::string& second,
                            const Paper& paper);

}  // namespace hausbench
