// The verbs of the program, each in the file of its name, and functions that they share.
#pragma once

#include "datasets/catalogue.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

// Each function adds a verb to the command line. CLI11 calls the verb's callback, which does the work and sets `code`,
// the exit code, if it is not 0. The parsed arguments are static variables, which is safe because the program parses
// its command line only once.
void add_run(CLI::App& app, int& code);
void add_explain(CLI::App& app, int& code);
void add_list(CLI::App& app, int& code);
void add_measure(CLI::App& app, int& code);
void add_export(CLI::App& app, int& code);
void add_verify(CLI::App& app, int& code);
void add_merge(CLI::App& app, int& code);
void add_compare(CLI::App& app, int& code);
void add_status(CLI::App& app, int& code);
void add_show(CLI::App& app, int& code);
void add_track(CLI::App& app, int& code);
void add_draw(CLI::App& app, int& code);
void add_fetch(CLI::App& app, int& code);

// Adds hidden verbs. The program calls most of them itself, to run readers and solvers in separate processes, so that a
// crash ends only that process.
void add_internal_verbs(CLI::App& app, int& code);

// Adds a verb with its help: a description in one line ("joins results", no full stop), an example, and notes such as
// exit codes.
CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& meaning, const std::string& example,
                   const std::string& notes = "");

// Adds the option --results, a folder, whose help is `meaning`. An empty name is an error.
void take_results_folder(CLI::App* verb, std::filesystem::path& folder, const std::string& meaning);

// Adds the option --plugin. The given libraries are loaded before the verb's callback runs, so that the callback finds
// their solvers.
void take_plugins(CLI::App* verb);
const std::vector<std::filesystem::path>& plugins_given();

Catalogue catalogue();  // the models of the project or the installation

// Print text. Control characters are replaced (printable.h).
void print(const std::string& text);              // to standard output
void say(const std::vector<std::string>& lines);  // to standard error, as messages of the program

}  // namespace hausbench
