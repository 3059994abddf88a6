// The summary that `run` prints at its end.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/result/result_file.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace hausbench {

// Returns a table with one line per solver, followed by a line for each reason why rows are not `ok`.
std::string show_summary(const ResultFile& result, const Paper& paper);

// Names of solvers in summaries. If a solver has more than eight variants, such as seeds, they share one name,
// "ohd(60 variants)".
class SummaryNames {
public:
    explicit SummaryNames(const std::vector<Row>& rows);
    std::string of(const Case& spec) const;

private:
    std::map<std::string, std::set<std::string>> variants_;  // by label
};

std::string count_statuses(const std::vector<Row>& rows);  // "24 ok, 3 timeout"

// Describes the reference answers (plan/references.h): how many there are, how many are within their tolerance, how
// many upper bounds are proven, and how many rows are compared with one. Also counts the rows whose interval is
// narrower than their reference, because errors up to the reference's width go unnoticed. Returns an empty string
// without references.
std::string describe_references(const ResultFile& result);

// Returns a warning for each certified solver of a plug-in whose upper bounds were hardly tested: every known distance
// lies in the lower half of the solver's interval. Upper bounds that are wrong on other scenes could then all hold
// here.
std::vector<std::string> describe_tried(const ResultFile& result);

// Returns a warning for each scene whose exact distance, given in the experiment (key `exact`), lies outside the
// reference answer by more than rounding explains.
std::vector<std::string> describe_wrong_exact(const ResultFile& result);

}  // namespace hausbench
