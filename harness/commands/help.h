// Texts that follow from the description of the verbs: help, the man page and the completion of the shell.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace hausbench {

// Prints a verb's help: what it does, usage, an example, each argument with its meaning, and notes. The lines are at most as wide as the
// terminal, and at most 100 characters. An argument's type name is what its value stands for ("FILE"), or its values ("here|slurm").
class Help : public CLI::FormatterBase {
public:
    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
};

// The manual page hausbench(1), in the macros of man(7).
std::string man_page(const CLI::App& program);

// A script for bash that completes verbs, options, values, and the names of solvers, experiments and models.
std::string bash_completion(const CLI::App& program);

}  // namespace hausbench
