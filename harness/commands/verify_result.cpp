#include "harness/commands/verify_result.h"

#include "algorithms/printable.h"
#include "harness/check/claims.h"
#include "harness/check/verify.h"
#include "harness/commands/foreign_shapes.h"
#include "harness/commands/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace hausbench {

std::vector<std::string> verify_result(ResultFile& result, const Catalogue& manifest) {
    std::vector<std::string> missing;
    const std::map<std::string, Shape> shapes = foreign_shapes(result, manifest, missing);
    const auto load = [&](const std::string& name) -> const Shape* {
        const auto at = shapes.find(name);
        return at == shapes.end() ? nullptr : &at->second;
    };
    verify_rows(result.rows, result.references, load);
    for (std::string& line : contradictions(result.rows, load)) missing.push_back(std::move(line));
    return missing;
}

bool any_unsound(const ResultFile& result) {
    const auto any = [](const std::vector<Row>& rows) {
        return std::any_of(rows.begin(), rows.end(), [](const Row& row) {
            return row.check.lower == Verdict::unsound || row.check.upper == Verdict::unsound ||
                   row.check.fields == Verdict::unsound;
        });
    };
    return any(result.rows) || any(result.references);
}

std::string describe_checks(const ResultFile& result) {
    std::map<std::string, std::map<Verdict, int>> lower, upper;
    const SummaryNames names(result.rows);
    for (const Row& row : result.rows) {
        const std::string name = printable(names.of(row.asked));
        ++lower[name][row.check.lower];
        ++upper[name][row.check.upper];
    }
    std::size_t width = 16;
    for (const auto& [name, counts] : lower) width = std::max(width, name.size());
    std::string text = fmt::format("{:<{}} {:>8} {:>8} {:>8} {:>11} | {:>8} {:>8} {:>8}\n", "lower bound of", width,
                                   "holds", "unsound", "not ch.", "(no witn.)", "upper ok", "unsound", "not ch.");
    for (auto& [label, l] : lower) {
        auto& u = upper[label];
        const int unchecked = l[Verdict::not_checked] + l[Verdict::no_witness];
        text += fmt::format("{:<{}} {:>8} {:>8} {:>8} {:>11} | {:>8} {:>8} {:>8}\n", label, width, l[Verdict::holds],
                            l[Verdict::unsound], unchecked, fmt::format("({})", l[Verdict::no_witness]),
                            u[Verdict::holds], u[Verdict::unsound], u[Verdict::not_checked]);
    }
    std::map<Verdict, int> fields;
    for (const Row& row : result.rows) {
        if (!row.fields.empty()) ++fields[row.check.fields];
    }
    if (!fields.empty())
        text += fmt::format("fields of cases: {} hold, {} unsound, {} not checked\n", fields[Verdict::holds],
                            fields[Verdict::unsound], fields[Verdict::not_checked]);
    text += describe_references(result);
    for (const auto* rows : {&result.rows, &result.references}) {
        for (const Row& row : *rows) {
            if (!row.check.reason.empty())
                text += fmt::format("unsound: {}: {}\n", name_of(row.asked), printable(row.check.reason));
        }
    }
    return text;
}

}  // namespace hausbench
