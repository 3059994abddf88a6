// `hausbench show`: the rows of a result.
#include "commands/row_choice.h"
#include "commands/row_table.h"
#include "commands/summary.h"
#include "commands/verb.h"

namespace hausbench {

namespace {

std::string show(const std::filesystem::path& file, const RowChoice& choice, Form form, bool summary) {
    ResultFile& result = *new ResultFile(read_result(file));  // never freed, as in commands/compare.cpp
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
    static bool csv = false, json = false, markdown = false, summary = false;
    auto* verb = app.add_subcommand("show", "show the rows of a result: bounds, times, memory, status and reason");
    verb->add_option("result", file, "result file (.h5)")->required();
    verb->add_option("--solver", choice.solvers,
                     "only this solver: its label, or \"guthe(samples=8)\"; may be repeated")
        ->allow_extra_args(false);
    verb->add_option("--scene", choice.scenes, "only this scene; may be repeated")->allow_extra_args(false);
    verb->add_option("--where", choice.where,
                     "only rows with COLUMN=VALUE, or COLUMN!=VALUE, such as status=failed; `hausbench list columns` "
                     "names the columns; may be repeated")
        ->allow_extra_args(false);
    verb->add_flag("--summary", summary, "a line for each solver, then each reason that a row is not ok");
    auto* as_csv = verb->add_flag("--csv", csv, "as CSV, with all digits");
    auto* as_json = verb->add_flag("--json", json, "as one JSON object, with all digits")->excludes(as_csv);
    verb->add_flag("--md", markdown, "as a table in Markdown")->excludes(as_csv)->excludes(as_json);
    verb->callback([] {
        const Form form = csv ? Form::csv : json ? Form::json : markdown ? Form::markdown : Form::text;
        print(show(file, choice, form, summary));
    });
}

}  // namespace hausbench
