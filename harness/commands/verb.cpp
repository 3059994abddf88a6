#include "harness/commands/verb.h"

#include "algorithms/plugin.h"
#include "algorithms/printable.h"
#include "datasets/paths.h"
#include "harness/commands/text_table.h"
#include "harness/plan/plugin_code.h"

#include <fmt/format.h>

#include <cstdio>

namespace hausbench {

namespace {

std::vector<std::filesystem::path>& plugin_files() {
    static std::vector<std::filesystem::path> files;
    return files;
}

}  // namespace

const std::vector<std::filesystem::path>& plugins_given() { return plugin_files(); }

CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& meaning, const std::string& example,
                   const std::string& notes) {
    CLI::App* verb = app.add_subcommand(name, meaning);
    verb->footer(example + "\n" + notes);  // help.cpp splits it at the line break
    return verb;
}

void take_results_folder(CLI::App* verb, std::filesystem::path& folder, const std::string& meaning) {
    verb->add_option("--results", folder, meaning)->type_name("FOLDER")->check([](const std::string& name) {
        return name.empty() ? "the name of the folder is empty: name one, or leave the option out" : std::string();
    });
}

void take_plugins(CLI::App* verb) {
    std::vector<std::filesystem::path>& files = plugin_files();
    verb->add_option("--plugin", files, "library with more solvers; may be repeated")
        ->type_name("FILE")
        ->allow_extra_args(false);
    verb->parse_complete_callback([verb] {
        const CLI::Option* here = verb->get_option_no_throw("--in-process");  // for debuggers, which follow one process
        const bool in_copy = !here || here->empty();
        for (const std::filesystem::path& file : plugin_files())
            in_copy ? load_plugin_in_copy(file) : load_plugin(file);
        say(slow_plugins());
    });
}

Catalogue catalogue() { return {manifest_file(), cache_folder(), program_path()}; }

void print(const std::string& text) {
    const std::string shown = printable_lines(text, paper_of_output().colour);
    std::fwrite(shown.data(), 1, shown.size(), stdout);
}

void say(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) fmt::print(stderr, "hausbench: {}\n", printable(line));
}

}  // namespace hausbench
