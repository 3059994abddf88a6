// Help, man page and shell completion, all generated from the definitions of the verbs.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace hausbench {

// Formats the help of the program or of a verb: description, usage, example, arguments and notes. Lines fit the
// terminal and have at most 100 characters. The type name of an argument says what its value means ("FILE") or lists
// its values ("here|slurm").
class Help : public CLI::FormatterBase {
public:
    std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
};

// Returns the manual page hausbench(1), written with the macros of man(7).
std::string man_page(const CLI::App& program);

// Returns a bash script that completes verbs, options, values, and the names of solvers, experiments and models.
std::string bash_completion(const CLI::App& program);

}  // namespace hausbench
