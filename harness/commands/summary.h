// The summary that `run` prints at its end.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/result/result_file.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace hausbench {

// Returns a table with a line for each solver; then a line for each reason why rows are not `ok`.
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

// Returns text on the reference answers (plan/references.h): how many there are, how many are within their tolerance,
// how many upper bounds are proven, and how many rows are compared with one. It also counts the rows whose interval is
// narrower than the interval of their reference: the comparison misses errors up to the width of the reference. Empty
// if the result has no references.
std::string describe_references(const ResultFile& result);

// Returns a line for each certified solver of a plug-in whose upper bounds were tested little or not at all: in every
// row with a known distance, the distance lies in the lower half of the solver's interval. Upper bounds that are wrong
// on other scenes could then all hold here.
std::vector<std::string> describe_tried(const ResultFile& result);

// Returns a line for each scene whose true distance according to the experiment (key `exact`) lies outside its
// reference answer by more than rounding explains.
std::vector<std::string> describe_wrong_exact(const ResultFile& result);

}  // namespace hausbench
