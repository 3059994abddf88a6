// Compares two results of the same experiment, or two solvers of one result.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/result/result_file.h"

#include <set>
#include <string>

namespace hausbench {

// Returns the names of the models that are different shapes in the two results, such as a mesh that another version of
// CGAL simplified.
std::set<std::string> unlike_models(const ResultFile& one, const ResultFile& other);

// Returns whether A or B of a case is one of these models.
bool is_of(const Case& spec, const std::set<std::string>& models);

// Returns the part of a result that compare_results() and compare_solvers() use.
const ResultPart& compared_part();

// Compares the rows of two results that have the same identity and scene. Lists differing answers first, then for each
// row the ratio of times (candidate / base). Calls a ratio faster or slower only at 95 % confidence. Counts the rows of
// models that are different shapes in the two results, which it does not compare. Throws InputError if the results have
// no case in common.
std::string compare_results(const ResultFile& base, const ResultFile& candidate);

// Compares two solvers of one result, each named by its label alone or with parameters: "guthe(samples=8)". Pairs their
// rows by scene, poses, quantity and tolerance, and by swept parameters if both sweep the same ones. Lists first the
// pairs whose intervals do not overlap (one of the two must be wrong), then pairs in which a solver has no answer, then
// ratios of times (second / first), each the median over the rounds. Throws InputError if the result lacks a solver, or
// if the solvers have no case in common.
std::string compare_solvers(const ResultFile& result, const std::string& first, const std::string& second,
                            const Paper& paper);

}  // namespace hausbench
