// Rows of a result, chosen by solver, scene and the values of columns: what --solver, --scene and --where of `show` say.
#pragma once

#include "harness/result/result_file.h"

#include <functional>
#include <string>
#include <vector>

namespace hausbench {

// Which rows: each list is empty for all. A condition is COLUMN=VALUE or COLUMN!=VALUE, of any column of /cases; with numbers also
// COLUMN<VALUE, <=, > and >=, which NaN never meets.
struct RowChoice {
    std::vector<std::string> solvers;  // a label, or with its parameters: "guthe(samples=8)"
    std::vector<std::string> scenes, where;
};

// Whether a row meets all of these conditions. Throws InputError for one that cannot be read; `option` is its name in messages.
std::function<bool(const Row&)> row_test(const std::vector<std::string>& where, const std::string& option = "--where");

// Their numbers, in the order of the file. Throws InputError for a solver, scene or column that the result does not have.
std::vector<std::size_t> chosen_rows(const ResultFile& result, const RowChoice& choice);

}  // namespace hausbench
