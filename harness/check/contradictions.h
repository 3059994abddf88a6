// Finds contradictions within the rows of a result, which reveal a damaged or forged file even if its bounds are right.
#pragma once

#include "algorithms/scene.h"
#include "harness/record/row.h"

#include <functional>
#include <string>
#include <vector>

namespace hausbench {

// Returns the first contradiction found in the row, or an empty string. A row contradicts itself if
// - its status is `ok`, but its gap is above the tolerance and its bounds do not answer its floor or cutoff either;
// - its status belongs to an answer, but a bound is NaN;
// - its identity is not the hash of its case (identify() in case.h);
// - a search lowered its cutoff, but the row belongs to no search;
// - its status does not fit the status that the solver returned;
// - it has bounds, but the result does not list one of its models (`source_hash` or `target_hash` is empty).
std::string contradiction_in(const Row& row);

// Returns an error message if the row gives another size of A (diagonal or longest side) than `source` has, otherwise
// an empty string. A tolerance may be a fraction of this size. A `source_longest` of 0 comes from an older file and is
// not checked.
std::string wrong_size(const Case& spec, const Shape& source);

// Returns an error message if the witness names an element that its shape does not have, otherwise an empty string.
std::string wrong_witness(const Witness& witness, Index source_elements, Index target_elements);

// Returns one line for each row that contradicts itself. After 20 lines, one more gives the number of further rows.
// `load` returns null for a shape that is not available.
std::vector<std::string> contradictions(const std::vector<Row>& rows,
                                        const std::function<const Shape*(const std::string&)>& load);

}  // namespace hausbench
