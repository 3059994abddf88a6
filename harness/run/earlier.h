// What a result file holds already when a run writes it again: a run of one solver, of one scene or of another profile adds
// to its rows and replaces only those that it was asked for.
#pragma once

#include "plan/plan.h"
#include "result/result_file.h"

#include <set>
#include <string>
#include <vector>

namespace hausbench {

// Adds to `result`, the rows of `plan` in its order, the earlier rows that stay, with their models and their part of the
// ledger. A row stays unless the plan covers it: the plan is of its profile, and either of the whole experiment or of its solver and
// scene. A row of several profiles loses that one; where both have the same case, the row of the plan is that of all of them.
//
// Rows also go where nothing asks for them any more: their scene, solver or tolerance is no longer in the experiment's profile,
// or a model of that name has other bytes now. A case that an interrupted run did not come to keeps its earlier outcome.
// Returns a line for each such reason, and one where rows of other builds stay.
//
// `places` gets where each row belongs: a part of an experiment takes the places that its rows had, and a run of the whole
// stands before what stays.
std::vector<std::string> keep_earlier(ResultFile& result, ResultFile before, const Plan& plan,
                                      std::vector<std::size_t>& places);

}  // namespace hausbench
