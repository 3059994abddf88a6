#include "harness/commands/help.h"

#include "harness/commands/text_table.h"
#include "harness/result/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>
#include <vector>

namespace hausbench {

namespace {

constexpr std::size_t widest_line = 100;                     // most characters of a line
constexpr std::size_t verb_column = 12, option_column = 26;  // where the meanings of verbs and of options begin

// An option or positional argument of a verb.
struct Argument {
    std::string name;     // "--tolerance"; for a positional argument "A"
    std::string value;    // "NUMBER" or "here|slurm"; empty for a flag
    std::string meaning;  // includes the default value
    bool positional, required, many;

    std::string shown() const { return positional ? name : value.empty() ? name : name + " " + value; }
    std::string usage() const {
        const std::string text = many ? name + "..." : name;
        return required ? text : "[" + text + "]";
    }
};

Argument argument_of(const CLI::Option& option) {
    const bool positional = option.get_lnames().empty();
    const bool flag = option.get_items_expected_max() == 0;
    const std::string type = option.get_type_name();
    const std::string given = option.get_default_str();
    return {.name = positional ? option.get_name() : "--" + option.get_lnames().front(),
            .value = flag ? "" : type.substr(0, type.find(':')),  // CLI11 appends the validators after a colon
            .meaning = option.get_description() + (given.empty() ? "" : fmt::format(" (default: {})", given)),
            .positional = positional,
            .required = option.get_required(),
            .many = positional && option.get_items_expected_max() > 1};
}

// Returns the visible arguments of a verb except --help, with positional arguments first.
std::vector<Argument> arguments_of(const CLI::App& verb) {
    std::vector<Argument> all;
    for (const CLI::Option* option : verb.get_options()) {
        if (option->get_group().empty() || option == verb.get_help_ptr()) continue;
        all.push_back(argument_of(*option));
    }
    std::stable_partition(all.begin(), all.end(), [](const Argument& argument) { return argument.positional; });
    return all;
}

std::vector<const CLI::App*> verbs_of(const CLI::App& program) {
    std::vector<const CLI::App*> verbs = program.get_subcommands([](const CLI::App*) { return true; });
    std::erase_if(verbs, [](const CLI::App* verb) { return verb->get_group().empty(); });
    return verbs;
}

// A verb's footer, set by add_verb(), is its example, a line break, and its notes.
std::string example_of(const CLI::App& verb) {
    return "Example:  " + verb.get_footer().substr(0, verb.get_footer().find('\n'));
}

std::string notes_of(const CLI::App& verb) {
    const std::string footer = verb.get_footer();
    return footer.substr(std::min(footer.size(), footer.find('\n') + 1));
}

std::string usage_of(const CLI::App& verb) {
    const std::vector<Argument> arguments = arguments_of(verb);
    std::string text = "hausbench " + verb.get_name();
    for (const Argument& argument : arguments) {
        if (argument.positional) text += " " + argument.usage();
    }
    return text + (std::any_of(arguments.begin(), arguments.end(),
                               [](const Argument& argument) { return !argument.positional; })
                       ? " [OPTIONS]"
                       : "");
}

// Returns a name and its meaning in two columns. If the name is too long, the meaning starts on the next line.
std::string entry(const std::string& name, const std::string& meaning, std::size_t column, std::size_t width) {
    std::string lines = wrapped(meaning, column, width);
    std::string head = "  " + name;
    if (head.size() + 2 > column) return head + "\n" + lines;
    return head + lines.substr(head.size());
}

std::string capital(std::string text) {
    if (!text.empty()) text[0] = char(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
}

std::string help_of_verb(const CLI::App& verb, std::size_t width) {
    std::string text = wrapped(fmt::format("{}.", capital(verb.get_description())), 0, width);
    text += fmt::format("\nUsage:    {}\n{}\n\n", usage_of(verb), example_of(verb));
    for (const Argument& argument : arguments_of(verb))
        text += entry(argument.shown(), argument.meaning, option_column, width);
    if (const std::string notes = notes_of(verb); !notes.empty()) text += "\n" + wrapped(notes, 0, width);
    return text;
}

std::string help_of_program(const CLI::App& program, std::size_t width) {
    std::string text = wrapped(program.get_description(), 0, width);
    text += "\nUsage:    hausbench VERB [OPTIONS]\nExample:  hausbench measure scan.ply part.stl\n\n";
    for (const CLI::App* verb : verbs_of(program))
        text += entry(verb->get_name(), verb->get_description(), verb_column, width);
    return text + "\n" + wrapped(program.get_footer(), 0, width);
}

}  // namespace

std::string Help::make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const {
    const std::size_t terminal = paper_of_output().width;
    const std::size_t width = terminal == 0 ? widest_line : std::clamp(terminal, option_column + 20, widest_line);
    return app->get_parent() ? help_of_verb(*app, width) : help_of_program(*app, width);
}

namespace {

// Escapes text for the macros of man(7).
std::string roff(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else
            out += c;
    }
    return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

}  // namespace

std::string man_page(const CLI::App& program) {
    std::string text = fmt::format(".TH HAUSBENCH 1 \"\" \"hausbench {}\" \"User Commands\"\n", this_build().version);
    text += ".SH NAME\nhausbench \\- certified Hausdorff distances, and a benchmark of programs that compute them\n";
    text += ".SH SYNOPSIS\n.B hausbench\n.I VERB\n[\\fIOPTIONS\\fR]\n";
    text += fmt::format(".SH DESCRIPTION\n{}\n.SH VERBS\n", roff(program.get_description()));
    for (const CLI::App* verb : verbs_of(program)) {
        text += fmt::format(".SS {}\n{}.\n.PP\n.B {}\n", roff(verb->get_name()), roff(capital(verb->get_description())),
                            roff(usage_of(*verb)));
        for (const Argument& argument : arguments_of(*verb))
            text += fmt::format(
                ".TP\n\\fB{}\\fR{}\n{}\n", roff(argument.name),
                argument.positional || argument.value.empty() ? "" : " \\fI" + roff(argument.value) + "\\fR",
                roff(argument.meaning));
        if (const std::string notes = notes_of(*verb); !notes.empty()) text += ".PP\n" + roff(notes) + "\n";
        text += ".PP\n" + roff(example_of(*verb)) + "\n";
    }
    text += ".SH EXIT STATUS\n";
    constexpr std::pair<const char*, const char*> codes[] = {
        {"0", "The verb did what it was asked to."},
        {"1", "A check failed: a verb's own section says which."},
        {"2", "The command line or an input is wrong; one line on standard error says where, and what to do."},
        {"3", "An error inside the program; or the question of `measure --cutoff` is open."},
        {"4", "The memory did not suffice."},
        {"130", "Interrupted; finished cases are kept, and the same command goes on."}};
    for (const auto& [code, meaning] : codes) text += fmt::format(".TP\n.B {}\n{}\n", code, roff(meaning));
    text += ".SH ENVIRONMENT\n";
    constexpr std::pair<const char*, const char*> variables[] = {
        {"HAUSBENCH_ROOT",
         "checkout whose experiments and models are meant (default: the one around the current folder)"},
        {"HAUSBENCH_CACHE", "folder of fetched and prepared models"},
        {"PYTHON", "Python for draw, fetch and track (default: /usr/bin/python3)"},
        {"COLUMNS", "width of texts and tables (default: the terminal's)"},
        {"NO_COLOR", "if set, texts have no colour"}};
    for (const auto& [name, meaning] : variables) text += fmt::format(".TP\n.B {}\n{}\n", name, roff(meaning));
    return text;
}

namespace {

// Returns the words that complete a value: a list ("here slurm"), or a shell command that prints it. An empty string
// means that file names complete it.
std::string values_of(const std::string& value) {
    if (value.find('|') != std::string::npos) {
        std::string words = value;
        std::replace(words.begin(), words.end(), '|', ' ');
        return words;
    }
    if (value == "SOLVER") return "$(\"$program\" describe solvers 2>/dev/null)";
    if (value == "EXPERIMENT") return "$(\"$program\" describe experiments 2>/dev/null)";
    if (value == "MODEL") return "$(\"$program\" describe models 2>/dev/null)";
    return "";
}

}  // namespace

std::string bash_completion(const CLI::App& program) {
    std::string verbs, options, values;
    for (const CLI::App* verb : verbs_of(program)) {
        const std::string name = verb->get_name();
        verbs += " " + name;
        std::string option_names, positional;
        for (const Argument& argument : arguments_of(*verb)) {
            const std::string words = values_of(argument.value);
            if (argument.positional) {
                if (positional.empty()) positional = words;
                continue;
            }
            option_names += " " + argument.name;
            if (argument.value.empty()) continue;
            values += fmt::format("            {}\\ {}) words=\"{}\" ;;\n", name, argument.name, words);
        }
        options += fmt::format("        {}) options=\"{} --help\"; words=\"{}\" ;;\n", name,
                               option_names.substr(option_names.empty() ? 0 : 1), positional);
    }
    return fmt::format(
        R"(# Completion of hausbench for bash, written by `hausbench describe bash`. For zsh, first: autoload -U bashcompinit && bashcompinit
_hausbench() {{
    local program=${{COMP_WORDS[0]}} verb=${{COMP_WORDS[1]}} word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}}
    local options="" words="" files=yes
    if ((COMP_CWORD == 1)); then
        COMPREPLY=($(compgen -W "{} --help --version" -- "$word"))
        return
    fi
    case $verb in
{}    esac
    if [[ $word == -* ]]; then
        words=$options files=""
    else
        case $verb\ $before in
{}        esac
    fi
    mapfile -t COMPREPLY < <(compgen -W '$words' -- "$word")  # in single quotes, so that names are not expanded
    if [[ $files ]]; then
        compopt -o filenames 2>/dev/null
        mapfile -t -O "${{#COMPREPLY[@]}}" COMPREPLY < <(compgen -f -- "$word")
    fi
}}
complete -F _hausbench hausbench
)",
        verbs.substr(1), options, values);
}

}  // namespace hausbench
