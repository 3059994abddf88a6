// Checks that the rows of a result are consistent. A forged or damaged file may contradict itself even if its
// bounds are right.
#pragma once

#include "algorithms/scene.h"
#include "harness/record/row.h"

#include <functional>
#include <string>
#include <vector>

namespace hausbench {

// Returns one contradiction between columns of the row, or "" if there is none: an `ok` whose gap is above the
// tolerance, an answer whose bounds are NaN, an identity that does not fit the case, a cutoff narrowed by a search
// in a row that belongs to none, a status that does not fit the solver's own, or an answer for a model that the
// result does not list (`source_hash` or `target_hash` is empty).
std::string contradiction_in(const Row& row);

// Likewise for the size of A, of which the row's tolerance may be a fraction. A `source_longest` of 0 means an
// older file.
std::string wrong_size(const Case& asked, const Shape& source);

// Likewise for a witness that names an element out of range.
std::string wrong_witness(const Witness& witness, Index source_elements, Index target_elements);

// Returns one line for each row that contradicts itself: at most 20, then the number of the others. `load` returns
// null for a shape that is not available.
std::vector<std::string> contradictions(const std::vector<Row>& rows,
                                        const std::function<const Shape*(const std::string&)>& load);

}  // namespace hausbench
