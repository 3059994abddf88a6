// The summary that `run` prints at its end.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/result/result_file.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace hausbench {

// Returns a line for each solver, then each reason why a row is not `ok`.
std::string show_summary(const ResultFile& result, const Paper& paper);

// The names of solvers in summaries: a sweep of many values, such as seeds, becomes one name, "ohd(60 variants)".
class SummaryNames {
public:
    explicit SummaryNames(const std::vector<Row>& rows);
    std::string of(const Case& asked) const;

private:
    std::map<std::string, std::set<std::string>> variants_;  // by label
};

std::string count_statuses(const std::vector<Row>& rows);  // "24 ok, 3 timeout"

// Returns text that counts the reference answers, those that are closed and proven, and the rows that were checked
// against one. It also names rows that are narrower than their reference: they can be refuted only to within its
// width. Empty if the result has no references.
std::string describe_references(const ResultFile& result);

// Returns a line for each certified solver of a plug-in whose upper bounds were tested little or not at all: every
// known distance lies in the lower half of the solver's interval, so upper bounds that are wrong elsewhere could all
// hold here.
std::vector<std::string> describe_tried(const ResultFile& result);

// Returns a line for each scene whose `exact` in the experiment lies outside its reference answer by more than
// rounding.
std::vector<std::string> describe_wrong_exact(const ResultFile& result);

}  // namespace hausbench
