// `hausbench list`: the solvers, experiments, models and columns that there are.
#include "harness/commands/listing.h"
#include "harness/commands/verb.h"
#include "harness/record/columns.h"

namespace hausbench {

void add_list(CLI::App& app, int&) {
    static bool json = false;
    static std::string what;
    auto* verb = app.add_subcommand("list", "list the solvers, or what is asked for; everything with --json");
    verb->add_option("what", what,
                     "solvers, experiments, models, corpus, or columns (of result files, as JSON); or the name "
                     "of one solver, "
                     "experiment or model");
    verb->add_flag("--json", json, "print everything as one JSON object");
    take_plugins(verb);
    verb->callback([] {
        print(what == "columns" ? columns_json().dump(1) + "\n"
              : json            ? list_as_json().dump(2) + "\n"
                                : list_as_text(what, paper_of_output()));
    });
}

}  // namespace hausbench
