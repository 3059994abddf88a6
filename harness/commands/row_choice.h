// Chooses rows of a result by solver, scene and values of columns, for the options --solver, --scene and --where of
// `show`.
#pragma once

#include "harness/result/result_file.h"

#include <functional>
#include <string>
#include <vector>

namespace hausbench {

// Conditions on rows; an empty list accepts every row. An entry of `where` is COLUMN=VALUE or COLUMN!=VALUE, for any
// column of /cases, or gap, check or answer; for numbers also COLUMN<VALUE, <=, > and >=, which NaN never meets.
struct RowChoice {
    std::vector<std::string> solvers;  // labels, alone or with parameters: "guthe(samples=8)"
    std::vector<std::string> scenes, where;
};

// Returns a function that tells whether a row meets all of these conditions. Throws InputError for a malformed
// condition; `option` is its name in messages.
std::function<bool(const Row&)> row_test(const std::vector<std::string>& where, const std::string& option = "--where");

// Returns the numbers of the chosen rows, in the order of the file. Throws InputError for a solver, scene or column
// that the result does not have.
std::vector<std::size_t> chosen_rows(const ResultFile& result, const RowChoice& choice);

}  // namespace hausbench
