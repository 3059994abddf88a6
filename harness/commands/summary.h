// The summary that `run` prints at its end.
#pragma once

#include "harness/commands/text_table.h"
#include "harness/result/result_file.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace hausbench {

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

// Says how many reference answers there are, how many are closed and proven, and how many rows are compared with one; with the rows that are
// narrower than their reference, which can be refuted to within its width alone. Empty if the result has none.
std::string describe_references(const ResultFile& result);

// For each certified solver of a plug-in, a line if its upper bounds were tried little or not at all: no distance is known to lie farther than
// half of the way from its lower to its upper bound, so upper bounds that are wrong elsewhere could all hold here.
std::vector<std::string> describe_tried(const ResultFile& result);

// A line for each scene whose `exact` in the experiment is outside its reference answer, rounding aside.
std::vector<std::string> describe_wrong_exact(const ResultFile& result);

}  // namespace hausbench
