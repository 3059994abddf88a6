// `hausbench show`: shows the rows of a result.
#include "harness/commands/row_choice.h"
#include "harness/commands/row_table.h"
#include "harness/commands/row_texts.h"
#include "harness/commands/summary.h"
#include "harness/commands/verb.h"
#include "harness/record/columns.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace hausbench {

namespace {

// Returns the metadata of a result: how, where and with which program it was measured.
std::string show_meta(const ResultFile& result, TableForm form) {
    nlohmann::ordered_json all;
    for (const auto& [name, value] : result.texts) all[name] = value;
    for (const auto& [name, value] : result.integers) all[name] = value;
    if (form == TableForm::json) return all.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
    std::string text;
    for (const auto& [name, value] : all.items()) {
        const std::string words = value.is_string() ? value.get<std::string>() : value.dump();
        if (words.find('\n') == std::string::npos)
            text += fmt::format("{:<18} {}\n", name, words);
        else
            text += fmt::format("{}:\n{}\n", name, words);
    }
    return text;
}

std::string show_ledger(const ResultFile& result, TableForm form, const Paper& paper) {
    if (form == TableForm::json) {
        nlohmann::json all = nlohmann::json::array();
        for (const LedgerEntry& entry : result.ledger) all.push_back(row_json(ledger_columns(), entry));
        return all.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
    }
    if (result.ledger.empty()) return "nothing was left out\n";
    TextTable table({{"kind"}, {"subject", false, 0, true}, {"what"}, {"count", true}, {"saved", true, 1}});
    for (const LedgerEntry& entry : result.ledger) {
        const double saved = entry.seconds_saved;
        table.add({{entry.kind, entry.subject, entry.what, std::to_string(entry.count),
                    std::isnan(saved) ? "not measured"
                    : saved < 0       ? "-" + duration_text(-saved)
                                      : duration_text(saved)},
                   entry.reason});
    }
    return table.text(paper);
}

std::string show(const std::filesystem::path& file, const RowChoice& choice, TableForm form, bool summary) {
    const bool part = !summary && looks_only_at(choice, shown_part().columns);
    ResultFile result = part ? read_part(file, shown_part()) : read_result(file);
    const auto rows = chosen_rows(result, choice);
    if (!summary) return show_rows(result, rows, form, paper_of_output());
    std::vector<Row> chosen;
    for (const std::size_t row : rows) chosen.push_back(std::move(result.rows[row]));
    result.rows = std::move(chosen);
    return show_summary(result, paper_of_output());
}

}  // namespace

void add_show(CLI::App& app, int&) {
    static std::filesystem::path file;
    static RowChoice choice;
    static bool csv = false, json = false, markdown = false, summary = false, meta = false, ledger = false;
    auto* verb = add_verb(app, "show", "shows the rows of a result: bounds, times, memory, status and reason",
                          "hausbench show results/zhang2017_table3.h5 --where 'upper>0.1'",
                          "The column prepare is the time to build structures, solve the time of one more answer, as "
                          "repeats measure it. Tables of experiments add prepare and the first answer.");
    verb->add_option("result", file, "result file (.h5)")->type_name("FILE")->required();
    verb->add_option("--solver", choice.solvers,
                     "only this solver: its label, or \"guthe(samples=8)\"; may be repeated")
        ->type_name("LABEL")
        ->allow_extra_args(false);
    verb->add_option("--scene", choice.scenes, "only this scene; may be repeated")
        ->type_name("SCENE")
        ->allow_extra_args(false);
    verb->add_option("--where", choice.where,
                     "only rows like this, such as status=failed or 'upper>0.1' (=, !=, <, <=, >, >=), by a column of "
                     "`hausbench list columns`, or gap, check or answer; may be repeated")
        ->type_name("COLUMN=VALUE")
        ->allow_extra_args(false);
    verb->add_flag("--summary", summary, "a line for each solver, then the reason of each row that is not ok");
    auto* as_meta = verb->add_flag("--meta", meta, "commit, machine, libraries and experiment in place of the rows");
    auto* as_ledger = verb->add_flag("--ledger", ledger, "what was left out, and why")->excludes(as_meta);
    auto* as_csv = verb->add_flag("--csv", csv, "as CSV, with all digits")->excludes(as_meta)->excludes(as_ledger);
    auto* as_json = verb->add_flag("--json", json, "as one JSON object, with all digits")->excludes(as_csv);
    verb->add_flag("--md", markdown, "as a table in Markdown")->excludes(as_csv)->excludes(as_json);
    verb->callback([] {
        const TableForm form = csv        ? TableForm::csv
                               : json     ? TableForm::json
                               : markdown ? TableForm::markdown
                                          : TableForm::text;
        if (meta)
            print(show_meta(read_part(file, {}), form));
        else if (ledger)
            print(show_ledger(read_result(file), form, paper_of_output()));
        else
            print(show(file, choice, form, summary));
    });
}

}  // namespace hausbench
