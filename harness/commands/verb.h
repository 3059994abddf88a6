// The verbs of the program, each in the file of its name, and functions that they share.
#pragma once

#include "datasets/catalogue.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace hausbench {

// Each adds a verb to the command line. CLI11 calls the verb's callback, which does the work and sets `code`, the exit
// code of the program, if it is not 0. The variables that receive the verb's arguments are static in each function;
// this is enough because the program reads its command line once.
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

// Adds hidden verbs, most of which the program calls itself: it runs readers and solvers in processes of their own, so
// that a crash ends only that process.
void add_internal_verbs(CLI::App& app, int& code);

// Adds a verb with its help: a description in one line ("joins results", no full stop), an example, and notes such as
// exit codes.
CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& meaning, const std::string& example,
                   const std::string& notes = "");

// Adds the option --plugin. The given libraries are loaded before the verb's callback runs, so that it finds their
// solvers.
void take_plugins(CLI::App* verb);
const std::vector<std::filesystem::path>& plugins_given();

Catalogue catalogue();  // the models of the project or the installation

// Write text in the characters that printable.h allows.
void print(const std::string& text);              // to standard output
void say(const std::vector<std::string>& lines);  // to standard error, as messages of the program

}  // namespace hausbench
