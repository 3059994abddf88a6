// Compares two results of the same experiment, or two solvers of one result.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/result/result_file.h"

#include <string>

namespace hausbench {

// Compares the rows of two results that have the same identity and scene. The text lists differing answers first, then
// for each row the ratio of times (candidate / base), which is called faster or slower only at 95 % confidence.
// Throws InputError if no case is in both results.
std::string compare_results(const ResultFile& base, const ResultFile& candidate);

// Compares two solvers, each given by its label or by its label and parameters: "guthe(samples=8)". Their rows are
// paired by scene, poses, quantity and tolerance, and by swept parameters if both sweep the same ones. The text lists
// first the pairs whose intervals do not overlap, since one of the two must be wrong; then the pairs in which a solver
// has no answer; then the ratios of times, second / first, each the median of the ratios of the rounds. Throws
// InputError if the result lacks a solver, or if the solvers have no case in common.
std::string compare_solvers(const ResultFile& result, const std::string& first, const std::string& second,
                            const Paper& paper);

}  // namespace hausbench
