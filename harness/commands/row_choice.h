// Chooses rows of a result by solver, scene and column values (options --solver, --scene and --where of `show`).
#pragma once

#include "harness/result/result_file.h"

#include <functional>
#include <set>
#include <string>
#include <vector>

namespace hausbench {

// Conditions on rows; an empty list accepts every row. An entry of `where` is COLUMN=VALUE or COLUMN!=VALUE, for any
// column of /cases, or for gap, check or answer. Columns of numbers also allow <, <=, > and >=, which NaN never meets.
struct RowChoice {
    std::vector<std::string> solvers;  // labels, alone or with parameters: "guthe(samples=8)"
    std::vector<std::string> scenes, where;
};

// Returns a function that tests whether a row meets all conditions. Throws InputError for a malformed condition;
// `option` is the option's name in the message.
std::function<bool(const Row&)> row_test(const std::vector<std::string>& where, const std::string& option = "--where");

// Returns whether all columns that the choice looks at are among `columns`. gap, check and answer are computed from
// others, so they never are.
bool looks_only_at(const RowChoice& choice, const std::set<std::string>& columns);

// Returns the indices of the chosen rows, in the order of the file. Throws InputError for a solver, scene or column
// that the result does not have.
std::vector<std::size_t> chosen_rows(const ResultFile& result, const RowChoice& choice);

}  // namespace hausbench
