// What a result file holds already when a run writes it again: a run of one solver, of one scene or of another profile adds
// to its rows and replaces only those that it was asked for.
#pragma once

#include "harness/plan/plan.h"
#include "harness/result/result_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

// Adds to `result`, the rows of `plan` in its order, the earlier rows that stay, with their models and their part of the ledger.
//
// A row that the plan covers goes: the plan is of its profile, and either of the whole experiment or of its solver and scene. A row of
// several profiles loses that one; if both have the same case, the row of the plan becomes a row of all these profiles. Any other row
// stays if and only if the experiment as it is today, in the row's profile, asks for a case of its identity (with its scene and
// label) on the models as the result recorded them. A row also goes if a model of the plan has other bytes than the row was
// measured on. Rows whose poses depend on a model that is not available stay. A case that an interrupted run did not reach keeps
// its earlier outcome.
//
// Returns a line for each such reason, and one if rows of other builds stay.
//
// `places` gets the place of each row: a part of an experiment takes the places that its rows had, and a run of the whole stands
// before the rows that stay.
std::vector<std::string> keep_earlier(ResultFile& result, ResultFile before, const Plan& plan,
                                      const ShapesOf& shapes_of, std::vector<std::size_t>& places);

// The same with the rows of a file, if there is one. A file that cannot be read is put aside, as somebody may still want it; a line says where.
// Throws NewerResult for the file of a newer program, and InputError if Ctrl-C ends the reading.
std::vector<std::string> keep_earlier_rows(ResultFile& result, const std::filesystem::path& file, const Plan& plan,
                                           const ShapesOf& shapes_of, std::vector<std::size_t>& places);

// Throws InputError where `file` is the result of another experiment: one of another text, whose file is still there and is not that of
// `experiment`. With `fresh` it may be replaced. Throws NewerResult for the file of a newer program; a damaged file passes.
void refuse_to_replace(const std::filesystem::path& file, const Experiment& experiment, bool fresh);

// Sorts the rows by their places.
void put_in_order(std::vector<Row>& rows, const std::vector<std::size_t>& places);

}  // namespace hausbench
