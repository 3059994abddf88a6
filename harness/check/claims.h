// Checks that the rows of a result are consistent. A forged or damaged file may contradict itself even if its
// bounds are right.
#pragma once

#include "algorithms/scene.h"
#include "harness/record/row.h"

#include <functional>
#include <string>
#include <vector>

namespace hausbench {

// Returns one contradiction between columns of the row, or "" if there is none. Contradictions are:
// - the status `ok`, but a gap above the tolerance, and no answer to a floor or cutoff either;
// - the status of an answer, but bounds that are NaN;
// - an identity that is not the hash of the case (identify() in case.h);
// - a cutoff lowered by a search, but a row that belongs to no search;
// - a status that does not fit the status that the solver returned;
// - an answer for a model that the result does not list (`source_hash` or `target_hash` is empty).
std::string contradiction_in(const Row& row);

// Returns an error if the row gives another size of A (diagonal or longest side) than `source` has, or "". The row's
// tolerance may be a fraction of that size. A `source_longest` of 0 comes from an older file and is not checked.
std::string wrong_size(const Case& asked, const Shape& source);

// Returns an error if the witness names an element that its shape does not have, or "".
std::string wrong_witness(const Witness& witness, Index source_elements, Index target_elements);

// Returns one line for each row that contradicts itself: at most 20, then the number of the others. `load` returns
// null for a shape that is not available.
std::vector<std::string> contradictions(const std::vector<Row>& rows,
                                        const std::function<const Shape*(const std::string&)>& load);

}  // namespace hausbench
