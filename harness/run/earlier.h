// Keeps rows of an earlier result when a run writes the same file again. A run of one solver, scene or profile thus
// replaces only the rows that it was asked for.
#pragma once

#include "harness/plan/plan.h"
#include "harness/result/result_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

// Moves the earlier rows that are still valid, with their models and ledger entries, from `before` to `result`, which
// holds the rows of `plan` in order.
//
// A row belongs to one or several profiles, and stays if it stays in at least one of them:
// - In the plan's profile, a row is dropped if the plan *covers* it, that is, has replaced it. A plan covers all rows
//   of its profile if Plan::whole, otherwise the rows of its own scenes and solvers.
// - In other profiles, and if the plan does not cover it, a row stays if the experiment still requests its case: the
//   same identity, scene and label, with the models that the result recorded. A row also stays if this is unknown,
//   because the poses depend on a shape that is not available.
// - In all profiles, a row is dropped if the plan uses one of its models with other bytes.
// If a row stays and the plan has the same case, only the plan's row remains, and it belongs to all these profiles. A
// case of the plan that an interrupted run did not reach gets the outcome of its earlier row.
//
// Returns the lines to print: how many rows were dropped or kept and why, and how many are from other builds.
//
// `places` receives a sort key for each row of `result`, for put_in_order(). If the plan is whole, its rows come first,
// then the earlier ones. Otherwise a row of the plan takes the place of the earlier row that it replaces, and new rows
// come last.
std::vector<std::string> keep_earlier(ResultFile& result, ResultFile before, const Plan& plan,
                                      const ShapesOf& shapes_of, std::vector<std::size_t>& places);

// Like keep_earlier(), but reads the earlier rows from a file; does nothing if the file does not exist. A file that
// cannot be read is renamed, not overwritten, and one of the returned lines gives its new name. Throws NewerResult if a
// newer version of the program wrote the file, and InputError if Ctrl-C ends the reading.
std::vector<std::string> keep_earlier_rows(ResultFile& result, const std::filesystem::path& file, const Plan& plan,
                                           const ShapesOf& shapes_of, std::vector<std::size_t>& places);

// Throws InputError if a run of `experiment` would overwrite the result of another experiment: the text recorded in
// `file` differs, and the experiment file named there still exists and is a different one. Throws NewerResult if a
// newer version of the program wrote `file`. Does nothing with `fresh`, or if `file` is damaged.
void refuse_to_replace(const std::filesystem::path& file, const Experiment& experiment, bool fresh);

// Sorts the rows by the keys in `places`.
void put_in_order(std::vector<Row>& rows, const std::vector<std::size_t>& places);

}  // namespace hausbench
