// Keeps rows of an earlier result when a run writes the same file again: a run of one solver, one scene or another
// profile adds to these rows and replaces only those that it was asked for.
#pragma once

#include "harness/plan/plan.h"
#include "harness/result/result_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

// Adds to `result`, which holds the rows of `plan` in order, the earlier rows that stay, with their models and their
// part of the ledger.
//
// An earlier row that the plan covers is dropped. A plan covers, in its profile, either the whole experiment or its
// own solvers and scenes. A row of several profiles only loses that profile; if another of its profiles has the same
// case, the row of the plan becomes a row of all these profiles. Any other row stays if and only if the experiment in
// its present form, in the row's profile, asks for a case with the row's identity, scene and label on the models that
// the result recorded. A row is also dropped if a model of the plan has other bytes than the row was measured on. A
// row whose poses depend on a model that is not available stays. A case that an interrupted run did not reach keeps
// its earlier outcome.
//
// Returns a line for each reason for which rows were dropped or kept, and one if rows of other builds stay.
//
// `places` receives the sort key of each row: if the plan is a part of the experiment, its rows take the places that
// they had before; if it is the whole, its rows come before the rows that stay.
std::vector<std::string> keep_earlier(ResultFile& result, ResultFile before, const Plan& plan,
                                      const ShapesOf& shapes_of, std::vector<std::size_t>& places);

// Does the same with the rows of a file, if it exists. A file that cannot be read is renamed rather than overwritten,
// since somebody may still want it, and a line gives its new name. Throws NewerResult for a file of a newer program,
// and InputError if Ctrl-C ends the reading.
std::vector<std::string> keep_earlier_rows(ResultFile& result, const std::filesystem::path& file, const Plan& plan,
                                           const ShapesOf& shapes_of, std::vector<std::size_t>& places);

// Throws InputError if `file` is the result of another experiment: the recorded text differs from `experiment`, and
// the recorded experiment file still exists and is not the file of `experiment`. With `fresh` it may be replaced.
// Throws NewerResult for a file of a newer program; a damaged file passes.
void refuse_to_replace(const std::filesystem::path& file, const Experiment& experiment, bool fresh);

// Sorts the rows by their places.
void put_in_order(std::vector<Row>& rows, const std::vector<std::size_t>& places);

}  // namespace hausbench
