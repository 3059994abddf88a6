#include "harness/commands/summary.h"

#include "algorithms/plugin.h"
#include "harness/commands/row_texts.h"
#include "harness/record/row_times.h"
#include "process/child.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>

namespace hausbench {

SummaryNames::SummaryNames(const std::vector<Row>& rows) {
    for (const Row& row : rows) variants_[row.spec.label].insert(row.spec.variant);
}

std::string SummaryNames::of(const Case& spec) const {
    constexpr std::size_t most = 8;
    const std::size_t count = variants_.at(spec.label).size();
    return count > most ? fmt::format("{}({} variants)", spec.label, count) : shown(spec);
}

std::string count_statuses(const std::vector<Row>& rows) {
    std::map<RowStatus, std::size_t> counts;
    for (const Row& row : rows) ++counts[row.outcome.status];
    return to_string(counts);
}

std::string describe_references(const ResultFile& result) {
    if (result.references.empty()) return "";
    std::size_t closed = 0, proven = 0, held = 0, narrower = 0;
    for (const Row& reference : result.references) {
        closed += reference.outcome.status == RowStatus::ok;
        proven += !std::isnan(reference.outcome.proven_upper);
    }
    const Row* widest = nullptr;
    for (const Row& row : result.rows) {
        if (std::isnan(row.reference.lower) || std::isnan(row.outcome.bounds.lower)) continue;
        ++held;
        if (!(row.reference.gap() > row.outcome.bounds.gap()) ||
            row.reference.gap() <= row.spec.resolved_tolerance().gap(row.reference.lower))
            continue;
        ++narrower;
        if (!widest || row.reference.gap() > widest->reference.gap()) widest = &row;
    }
    std::string text = fmt::format(
        "reference answers: {}, {} within their tolerance, {} proven; {} of {} rows are compared with one\n",
        result.references.size(), closed, counted(proven, "upper bound"), held, result.rows.size());
    if (widest)
        text +=
            fmt::format("  {} rows can be refuted only to within the width of their reference, at most {:.3g} ({})\n",
                        narrower, widest->reference.gap(), name_of(widest->spec));
    return text;
}

namespace {

// Statistics on how well the upper bounds of a solver were tested.
struct Tried {
    std::size_t answers = 0, held = 0;  // answers with bounds; those with a known distance
    // Largest (distance - lower) / (upper - lower) of an answer with a known distance.
    double share = 0;
};

}  // namespace

std::vector<std::string> describe_tried(const ResultFile& result) {
    std::map<std::string, Tried> tried;
    for (const Row& row : result.rows) {
        const Bounds& bounds = row.outcome.bounds;
        // Prefers the reference answer to the distance given in the experiment, because it was checked.
        const double distance = std::isnan(row.reference.lower) ? row.spec.exact : row.reference.lower;
        const bool exact = bounds.gap() == 0 && !std::isnan(distance);  // the known distance then tests both bounds
        if (row.spec.certified != 1 || !plugin_of(row.spec.solver) || exact || !(bounds.gap() >= 0) ||
            !std::isfinite(bounds.upper) || row.outcome.status == RowStatus::unsound)
            continue;
        Tried& trial = tried[row.spec.solver];
        ++trial.answers;
        if (std::isnan(distance)) continue;
        ++trial.held;
        trial.share = std::max(trial.share, (distance - bounds.lower) / bounds.gap());
    }
    std::vector<std::string> lines;
    for (const auto& [solver, trial] : tried) {
        if (trial.share >= 0.5) continue;
        const std::string answers = counted(trial.held ? trial.held : trial.answers, "answer");
        const std::string why =
            trial.held == 0 ? fmt::format("not tried at all: no reference answer is known for its {}", answers)
            : trial.share > 0
                ? fmt::format(
                      "tried little: in {} the distance lies at most {:.2g} of the way from its "
                      "lower to its upper bound",
                      answers, trial.share)
                : fmt::format("tried little: in {} the distance lies nowhere above its own lower bound", answers);
        lines.push_back(
            fmt::format("the upper bounds of {} were {}, so upper bounds that are wrong on other scenes would hold "
                        "here. Scenes made "
                        "to show it: `hausbench run stability_matrix --with {} --plugin {}`",
                        solver, why, solver, shell_quoted(plugin_of(solver)->file.string())));
    }
    return lines;
}

std::vector<std::string> describe_wrong_exact(const ResultFile& result) {
    constexpr double rounding = 1e-12;         // allowed error of `exact`, as a fraction of the diagonal of A
    std::map<std::string, std::string> lines;  // by scene
    for (const Row& row : result.rows) {
        const double exact = row.spec.exact, slack = rounding * row.spec.source_diagonal;
        if (std::isnan(exact) || !(exact < row.reference.lower - slack || exact > row.reference.upper + slack))
            continue;
        lines.emplace(row.spec.scene,
                      fmt::format("scene '{}': the experiment says that the distance is exactly {:.17g}, "
                                  "the reference answer is [{:.17g}, {:.17g}]",
                                  row.spec.scene, exact, row.reference.lower, row.reference.upper));
    }
    std::vector<std::string> out;
    for (const auto& [scene, line] : lines) out.push_back(line);
    return out;
}

namespace {

// Replaces every number with "#", so that reasons that differ only in numbers become equal.
std::string without_numbers(const std::string& text) {
    static const std::regex number(R"([-+]?\d[\d.]*(e[-+]?\d+)?)");
    return std::regex_replace(text, number, "#");
}

// Groups rows by a key. The groups are in the order of their first rows.
class Groups {
public:
    void add(const std::string& key, const Row& row) {
        const auto [at, fresh] = number_.emplace(key, groups_.size());
        if (fresh) groups_.emplace_back();
        groups_[at->second].push_back(&row);
    }
    const std::vector<std::vector<const Row*>>& all() const { return groups_; }

private:
    std::map<std::string, std::size_t> number_;
    std::vector<std::vector<const Row*>> groups_;
};

// Returns whether all rows have the same scene and tolerance. Otherwise the median time and the largest gap mean
// nothing.
bool of_one_question(const std::vector<Row>& rows) {
    return std::all_of(rows.begin(), rows.end(), [&](const Row& row) {
        return row.spec.scene == rows.front().spec.scene && row.spec.tolerance == rows.front().spec.tolerance &&
               row.spec.statistic == rows.front().spec.statistic;
    });
}

TextTable::Row summary_line(const std::string& name, const std::vector<const Row*>& rows, bool with_numbers) {
    std::map<RowStatus, std::size_t> counts;
    std::vector<double> times;
    double gap = unknown;
    Colour colour = Colour::none;
    for (const Row* row : rows) {
        ++counts[row->outcome.status];
        if (const Estimate time = time_of(row->outcome); time.n > 0) times.push_back(time.value);
        gap = std::fmax(gap, gap_of(row->outcome));
        if (row->outcome.status != RowStatus::ok) colour = colour_of(row->outcome.status);
    }
    TextTable::Row line{{name, std::to_string(rows.size()), to_string(counts)}, "", colour};
    if (with_numbers) {
        line.cells.push_back(times.empty() ? "" : duration_text(median(times).value));
        line.cells.push_back(gap_text(gap));
    }
    return line;
}

}  // namespace

std::string show_summary(const ResultFile& result, const Paper& paper) {
    const SummaryNames names(result.rows);
    Groups solvers, reasons;
    for (const Row& row : result.rows) {
        solvers.add(names.of(row.spec), row);
        if (row.outcome.status != RowStatus::ok)
            reasons.add(fmt::format("{} {} {}", row.spec.label, to_string(row.outcome.status),
                                    without_numbers(row.outcome.reason)),
                        row);
    }
    std::vector<TextTable::Column> columns{{"solver", false, 0, true}, {"rows", true}, {"status", false, 0, true}};
    const bool with_numbers = of_one_question(result.rows);
    if (with_numbers) columns.insert(columns.end(), {{"median solve", true, 1}, {"largest gap", true, 2}});
    TextTable table(std::move(columns));
    for (const auto& rows : solvers.all()) table.add(summary_line(names.of(rows.front()->spec), rows, with_numbers));
    std::string out = table.text(paper);
    std::vector<const Row*> all;
    for (const Row& row : result.rows) all.push_back(&row);
    if (const std::string apart = apart_text(all, Programs(result.texts)); !apart.empty())
        out += wrapped(apart, 0, paper.width);
    for (const auto& rows : reasons.all()) {
        const Row& first = *rows.front();
        const std::string where = fmt::format("{}{}, pose {}, tolerance {:g}", first.spec.scene, suffix_of(first.spec),
                                              first.spec.pose_index, first.spec.tolerance);
        const std::string which =
            rows.size() == 1 ? where : fmt::format("{} rows like this; the first: {}", rows.size(), where);
        out += wrapped(fmt::format("{}: {}: {} ({})", rows.size() == 1 ? shown(first.spec) : first.spec.label,
                                   to_string(first.outcome.status), first.outcome.reason, which),
                       0, paper.width);
    }
    return out;
}

}  // namespace hausbench
