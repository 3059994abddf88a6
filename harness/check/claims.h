// Checks that the rows of a result do not contradict themselves: a forged or damaged file may do so although its
// bounds are right.
#pragma once

#include "algorithms/scene.h"
#include "harness/record/row.h"

#include <functional>
#include <string>
#include <vector>

namespace hausbench {

// Returns a contradiction between the columns of a row: an `ok` whose gap is above the tolerance, an answer whose
// bounds are NaN, an identity that does not fit the case, a cutoff of a search that the case is not in, a status that
// its solver did not end with, or an answer about a model that the result does not list (`source_hash` is empty).
// Empty if there is none.
std::string contradiction_in(const Row& row);

// Likewise for the size of A that the row's tolerance is a fraction of. A `source_longest` of 0 is of an older file.
std::string wrong_size(const Case& asked, const Shape& source);

// Likewise for a witness that names an element that its shape does not have.
std::string wrong_witness(const Witness& witness, Index source_elements, Index target_elements);

// A line for each row that contradicts itself, at most 20 of them and then their number. `load` returns null for a shape that is
// not there.
std::vector<std::string> contradictions(const std::vector<Row>& rows,
                                        const std::function<const Shape*(const std::string&)>& load);

}  // namespace hausbench
