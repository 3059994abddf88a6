// `hausbench show`: the rows of a result, one line each, and the short form with which `run` ends.
#pragma once

#include "result_file.h"
#include "text_table.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace hausbench {

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
