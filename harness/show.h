// `hausbench show`: the rows of a result, one line each, and the short form with which `run` ends.
#pragma once

#include "result_file.h"
#include "text_table.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace hausbench {

// Which rows: each list is empty for all. A condition is COLUMN=VALUE or COLUMN!=VALUE, of any column of /cases.
struct RowChoice {
    std::vector<std::string> solvers;  // a label, or with its parameters: "guthe(samples=8)"
    std::vector<std::string> scenes, where;
};

// Their numbers, in the order of the file. Throws InputError for a solver, scene or column that the result does not have.
std::vector<std::size_t> chosen_rows(const ResultFile& result, const RowChoice& choice);

enum class Form { text, csv, json, markdown };
std::string show_rows(const ResultFile& result, const std::vector<std::size_t>& rows, Form form, const Paper& paper);

// A line for each solver, then each reason that a row is not `ok`.
std::string show_summary(const ResultFile& result, const Paper& paper);

// Solvers as summaries name them: a sweep of many values, such as of seeds, is one line, "ohd(60 variants)".
class SummaryNames {
public:
    explicit SummaryNames(const std::vector<Row>& rows);
    std::string of(const Case& asked) const;

private:
    std::map<std::string, std::set<std::string>> variants_;  // of each label
};

std::string count_statuses(const std::vector<Row>& rows);  // "24 ok, 3 timeout"

// "1.3 ms"; empty for NaN.
std::string duration_text(double seconds);

}  // namespace hausbench
