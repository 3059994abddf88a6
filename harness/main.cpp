// The program. `hausbench VERB --help` describes each verb.
#include "algorithms/error.h"
#include "algorithms/printable.h"
#include "algorithms/registry.h"
#include "harness/commands/help.h"
#include "harness/commands/verb.h"
#include "harness/result/provenance.h"
#include "harness/run/external.h"
#include "process/stand_in.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>

namespace {

using namespace hausbench;

// Returns the message for an error in the command line. For an unknown verb or option, it suggests the most similar
// one.
std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
    const auto verbs = app.get_subcommands();
    const auto unknown = app.remaining(true);
    const std::string help =
        fmt::format("run `hausbench{} --help`", verbs.empty() ? "" : " " + verbs.front()->get_name());
    std::vector<std::string> names;
    if (verbs.empty()) {
        for (const CLI::App* verb : app.get_subcommands(nullptr)) {
            if (!verb->get_group().empty()) names.push_back(verb->get_name());
        }
        if (unknown.empty()) return fmt::format("no verb is given{}; {}", nearest_hint("", names), help);
        return fmt::format("unknown verb '{}'{}; {}", unknown.front(), nearest_hint(unknown.front(), names), help);
    }
    std::string what = error.what();
    if (dynamic_cast<const CLI::ExtrasError*>(&error) && !unknown.empty()) {
        for (const CLI::Option* option : verbs.front()->get_options()) {
            if (!option->get_lnames().empty() && !option->get_group().empty())
                names.push_back("--" + option->get_lnames().front());
        }
        const std::string& word = unknown.front();
        what = word.starts_with("-") ? fmt::format("unknown option {}{}", word, nearest_hint(word, names))
                                     : fmt::format("unexpected '{}'", word);
    }
    return one_line(fmt::format("{}: {}; {}", verbs.front()->get_name(), what, help));
}

int run_verb(int argc, char** argv) {
    add_solvers({external_solver()}, "hausbench");
    CLI::App app(
        "hausbench computes certified bounds of Hausdorff distances between meshes, point sets and algebraic surfaces, "
        "and compares programs that compute them.");
    app.footer(
        "`hausbench VERB --help` describes a verb, and `man hausbench` all of them. `hausbench --version` names the "
        "build.");
    app.formatter(std::make_shared<Help>());
    app.require_subcommand(1);
    app.set_version_flag("--version", version_text);  // hashes the program, so it runs only on demand
    int code = 0;
    for (const auto add : {add_measure, add_run, add_explain, add_status, add_show, add_compare, add_verify, add_draw,
                           add_merge, add_list, add_fetch, add_export, add_track, add_internal_verbs})
        add(app, code);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        // CLI11 would print the help for "hausbench nosuch --help".
        const bool wrong_verb = app.get_subcommands().empty() && !app.remaining().empty();
        if (error.get_exit_code() != 0 || wrong_verb) throw InputError(complaint(app, error));
        code = app.exit(error);  // prints the help or the version
    }
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
        throw InputError(fmt::format("cannot write the output: {}", std::strerror(errno)));
    return code;
}

// Prints the error on standard error and, with --json, also as an object on standard output. Returns the exit code.
int give_up(int argc, char** argv, int code, const std::string& what) {
    if (std::find(argv + 1, argv + argc, std::string_view("--json")) != argv + argc)
        fmt::print("{}\n", nlohmann::json{{"error", what}, {"exit_code", code}}.dump(
                               -1, ' ', false, nlohmann::json::error_handler_t::replace));
    fmt::print(stderr, "hausbench: {}\n", what);
    return code;
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGXFSZ, SIG_IGN);  // beyond a file size limit, writing then fails, as on a full disk
    int code = 0;
    try {
        code = run_verb(argc, argv);
    } catch (const InputError& error) {
        code = give_up(argc, argv, 2, printable(error.what()));
    } catch (const std::bad_alloc&) {
        code = give_up(argc, argv, 4, "out of memory");
    } catch (const std::exception& error) {
        code = give_up(argc, argv, 3, "internal error: " + printable(error.what()));
    }
    tell_exit_code(code);  // destructors of plug-ins cannot change it
    return code;
}
