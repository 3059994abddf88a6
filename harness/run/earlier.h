// Keeps rows of an earlier result when a run writes the same file again. So a run of one solver, one scene or another
// profile replaces only the rows that it was asked for, and adds its rows to the others.
#pragma once

#include "harness/plan/plan.h"
#include "harness/result/result_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

// `result` holds the rows of `plan` in order, `before` the earlier rows. Moves the earlier rows that stay from `before`
// to `result`, with their models and ledger entries.
//
// A row belongs to one or several profiles, and stays if it stays in at least one of them:
// - From the plan's profile, a row is dropped if the plan *covers* it, because the plan has replaced it. A plan covers
//   all rows of its profile if Plan::whole, otherwise the rows of its own scenes and solvers.
// - In other profiles, and if it is not covered, a row stays if the experiment in its present form still asks for it
//   there: for a case with the same identity, scene and label, on the models that the result recorded. A row also stays
//   if this is unknown, because the poses depend on a shape that is not available.
// - From all profiles, a row is dropped if the plan uses one of its models, but with other bytes.
// If a row stays and the plan has the same case, only the plan's row remains, and it belongs to all these profiles.
// A case of the plan that an interrupted run did not reach gets the outcome of its earlier row.
//
// Returns the lines to print: how many rows were dropped or kept and why, and how many are from other builds.
//
// `places` receives a sort key for each row of `result`, for put_in_order(). If the plan is whole, its rows come first,
// then the earlier ones. Otherwise a row of the plan takes the place of the earlier row that it replaces, and new rows
// come last.
std::vector<std::string> keep_earlier(ResultFile& result, ResultFile before, const Plan& plan,
                                      const ShapesOf& shapes_of, std::vector<std::size_t>& places);

// Does the same with the rows of a result file, if it exists. A file that cannot be read is renamed rather than
// overwritten, since somebody may still want it, and one of the lines says its new name. Throws NewerResult for a file
// that a newer version of the program wrote, and InputError if Ctrl-C ends the reading.
std::vector<std::string> keep_earlier_rows(ResultFile& result, const std::filesystem::path& file, const Plan& plan,
                                           const ShapesOf& shapes_of, std::vector<std::size_t>& places);

// Throws InputError if `file` is the result of another experiment that must not be replaced: its recorded text differs
// from `experiment`, and the experiment file that it names still exists and is not the file of `experiment`. With
// `fresh`, it may be replaced all the same. Throws NewerResult for a file that a newer version of the program wrote.
// Does nothing if the file is damaged.
void refuse_to_replace(const std::filesystem::path& file, const Experiment& experiment, bool fresh);

// Sorts the rows by their places.
void put_in_order(std::vector<Row>& rows, const std::vector<std::size_t>& places);

}  // namespace hausbench
