#include "commands/verify_result.h"

#include "check/verify.h"
#include "commands/summary.h"
#include "error.h"
#include "plan/own_models.h"
#include "shape_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace hausbench {

std::vector<std::string> verify_result(ResultFile& result, const Catalogue& manifest) {
    Catalogue catalogue = manifest;
    add_own_models(catalogue, result);
    std::map<std::string, Shape> shapes;
    std::vector<std::string> missing;
    for (const ModelRecord& model : result.models) {
        const auto resolved = catalogue.resolve(model.name);
        if (const auto* absent = std::get_if<MissingModel>(&resolved)) {
            missing.push_back(
                fmt::format("model '{}' is not here, so its rows are not checked: {}", model.name, absent->reason));
            continue;
        }
        const auto& good = std::get<ResolvedModel>(resolved);
        if (good.content_hash != model.sha256 && catalogue.find(model.name).source == "file") {
            const ModelInfo& info = catalogue.find(model.name);
            throw InputError(
                fmt::format("model '{}': {} holds another shape than the one that was measured (SHA-256 {} then, {} "
                            "now): put that file back, or run the experiment again",
                            model.name, (info.folder / info.path).string(), model.sha256, good.content_hash));
        }
        if (good.content_hash != model.sha256) {
            throw InputError(
                fmt::format("model '{}': SHA-256 {} was measured, {} is here now: check out the manifest that the "
                            "result was made with",
                            model.name, model.sha256, good.content_hash));
        }
        shapes[model.name] = read_shape(good.shape_file).shape;
    }
    verify_rows(result.rows, [&](const std::string& name) -> const Shape* {
        const auto at = shapes.find(name);
        return at == shapes.end() ? nullptr : &at->second;
    });
    return missing;
}

bool any_unsound(const ResultFile& result) {
    return std::any_of(result.rows.begin(), result.rows.end(), [](const Row& row) {
        return row.check.lower == Verdict::unsound || row.check.upper == Verdict::unsound ||
               row.check.fields == Verdict::unsound;
    });
}

std::string describe_checks(const ResultFile& result) {
    std::map<std::string, std::map<Verdict, int>> lower, upper;
    const SummaryNames names(result.rows);
    for (const Row& row : result.rows) {
        ++lower[names.of(row.asked)][row.check.lower];
        ++upper[names.of(row.asked)][row.check.upper];
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
    for (const Row& row : result.rows) {
        if (!row.check.reason.empty()) text += fmt::format("unsound: {}: {}\n", name_of(row.asked), row.check.reason);
    }
    return text;
}

}  // namespace hausbench
