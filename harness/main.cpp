// The program: verbs run, explain, list, measure, export, verify, show, merge, compare; `hausbench VERB --help` says what each takes.
#include "catalogue.h"
#include "certificate_file.h"
#include "columns.h"
#include "combine.h"
#include "compare.h"
#include "derive.h"
#include "error.h"
#include "experiment.h"
#include "explain.h"
#include "export.h"
#include "isolated.h"
#include "list.h"
#include "load.h"
#include "machine.h"
#include "measure.h"
#include "own_models.h"
#include "paths.h"
#include "plan.h"
#include "plugin.h"
#include "progress.h"
#include "row_choice.h"
#include "runner.h"
#include "shape_file.h"
#include "show.h"
#include "worker.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>

namespace {

using namespace hausbench;
namespace fs = std::filesystem;

struct RunArguments {
    fs::path file, results;
    std::string profile = "quick";
    Choice choice;
    std::string shard = "1/1";
    bool fresh = false, any_build = false, quiet = false;
};

Catalogue catalogue() { return {manifest_file(), cache_folder(), program_path()}; }

// The plan points into the catalogue, which therefore lives as long as the program.
Plan plan_of(const RunArguments& arguments) {
    const Experiment experiment = read_experiment(arguments.file, arguments.profile);
    static Catalogue models = catalogue();
    add_own_models(models, experiment);
    Progress progress(arguments.quiet);
    return make_plan(experiment, models, arguments.choice, [&](const std::string& what) { progress.doing(what); });
}

fs::path results_of(const RunArguments& arguments) {
    return arguments.results.empty() ? results_folder() : arguments.results;
}

int run(const RunArguments& arguments) {
    Plan plan = plan_of(arguments);
    const Shard shard = parse_shard(arguments.shard);
    take_shard(plan, shard);
    std::string suffix = arguments.choice.leave_nothing_out ? ".everything" : "";
    if (!shard.whole()) suffix += fmt::format(".shard-{}-of-{}", shard.number, shard.of);
    const RunSummary summary =
        run_plan(plan, {results_of(arguments), arguments.fresh, arguments.any_build, arguments.quiet, suffix});
    const Paper paper = paper_of_output();
    std::fputs(show_summary(summary.result, paper).c_str(), stdout);
    const auto expected = summary.unsound_expected;
    fmt::print("{}: {}{}{}\n", summary.file.string(), count_statuses(summary.result.rows),
               expected ? fmt::format(" ({} of the unsound as expected)", expected) : "",
               summary.kept ? fmt::format("; {} rows of earlier runs are kept", summary.kept) : "");
    for (const std::string& row : summary.unsound) fmt::print(stderr, "hausbench: unsound: {}\n", row);
    if (summary.interrupted) {
        fmt::print(stderr, "interrupted: finished cases are saved; the same command resumes here\n");
        return 130;
    }
    return summary.unsound.empty() ? 0 : 1;
}

ParameterMap parse_parameters(const std::vector<std::string>& texts) {
    ParameterMap parameters;
    for (const std::string& text : texts) {
        const auto equals = text.find('=');
        if (equals == std::string::npos) throw InputError(fmt::format("--set {}: write it as name=value", text));
        const auto value = nlohmann::json::parse(text.substr(equals + 1), nullptr, false);
        ParameterValue& to = parameters[text.substr(0, equals)];
        if (value.is_boolean())
            to = value.get<bool>();
        else if (value.is_number_integer())
            to = value.get<std::int64_t>();
        else if (value.is_number())
            to = value.get<double>();
        else
            to = text.substr(equals + 1);
    }
    return parameters;
}

void derive_file(const std::string& operation, const std::vector<std::string>& texts, const fs::path& origin,
                 const fs::path& out) {
    Numbers numbers;
    for (const std::string& text : texts) {
        const auto equals = std::min(text.find('='), text.size() - 1);
        numbers[text.substr(0, equals)] = std::strtod(text.c_str() + equals + 1, nullptr);  // hexadecimal: exact
    }
    write_shape(out, derive(operation, numbers, read_shape(origin)));
}

// The error in a command line, with the nearest known name for an unknown one.
std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
    const auto verbs = app.get_subcommands();
    const auto unknown = app.remaining(true);
    const std::string help =
        fmt::format("run `hausbench{} --help`", verbs.empty() ? "" : " " + verbs.front()->get_name());
    std::vector<std::string> known;
    if (verbs.empty()) {
        for (const CLI::App* verb : app.get_subcommands(nullptr)) {
            if (!verb->get_group().empty()) known.push_back(verb->get_name());
        }
        if (unknown.empty()) return fmt::format("no verb is given{}; {}", nearest_hint("", known), help);
        return fmt::format("unknown verb '{}'{}; {}", unknown.front(), nearest_hint(unknown.front(), known), help);
    }
    std::string what = error.what();
    if (dynamic_cast<const CLI::ExtrasError*>(&error) && !unknown.empty()) {
        for (const CLI::Option* option : verbs.front()->get_options()) {
            if (!option->get_lnames().empty()) known.push_back("--" + option->get_lnames().front());
        }
        const std::string& word = unknown.front();
        what = word.starts_with("-") ? fmt::format("unknown option {}{}", word, nearest_hint(word, known))
                                     : fmt::format("unexpected '{}'", word);
    }
    return one_line(fmt::format("{}: {}; {}", verbs.front()->get_name(), what, help));
}

void say(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) fmt::print(stderr, "hausbench: {}\n", line);
}

int verify_rows_of(const std::vector<fs::path>& files) {
    if (files.size() != 1) throw InputError("verify: takes one result file; a proof is checked with --certificate");
    ResultFile result = read_result(files.front());
    const auto missing = verify_result(result, catalogue());
    std::fputs(describe_checks(result).c_str(), stdout);
    say(missing);
    return any_unsound(result) || !missing.empty() ? 1 : 0;
}

int verify_proof(const std::vector<fs::path>& files) {
    if (files.size() != 1 && files.size() != 3)
        throw InputError("verify --certificate: name the certificate alone, or the certificate, A and B");
    CertificateFile content = read_certificate(files.front());
    if (files.size() == 3) content.source.file = files[1].string(), content.target.file = files[2].string();
    for (const std::string& file : {content.source.file, content.target.file}) {
        if (!fs::exists(file))
            throw InputError(one_line(fmt::format("{}: its model {} is not there: name A and B after the certificate",
                                                  files.front().string(), file)));
    }
    const LoadedShape source = load_isolated(program_path(), content.source.file);
    const LoadedShape target = load_isolated(program_path(), content.target.file);
    const CertificateVerdict verdict = verify_certificate(content, source.shape, target.shape);
    std::fputs(describe(content, verdict).c_str(), stdout);
    return verdict.accepted ? 0 : 1;
}

int dispatch(int argc, char** argv) {
    CLI::App app(
        "Certified benchmark harness for Hausdorff distances: h(A,B) = max over A of the distance to B (one-sided, "
        "Pompeiu-Hausdorff).");
    app.require_subcommand(1);
    app.set_version_flag("--version", version_text);  // hashes the program, so only where it is asked for
    int code = 0;

    std::vector<fs::path> plugin_files;
    const auto takes_plugins = [&](CLI::App* verb) {  // loaded before anything looks for a solver
        verb->add_option("--plugin", plugin_files, "a plug-in library with additional solvers; may be repeated")
            ->allow_extra_args(false);
        verb->parse_complete_callback([&] {
            for (const fs::path& file : plugin_files) load_plugin(file);
            say(slow_plugins());
        });
    };

    RunArguments run_arguments;
    auto* run_verb = app.add_subcommand(
        "run",
        "run an experiment and write its results; resumes an interrupted run; exit code 1 if a row is unsound that the "
        "experiment does not expect to be");
    run_verb->add_option("experiment", run_arguments.file, "experiment file (.toml)")->required();
    run_verb->add_option("--profile", run_arguments.profile, "quick: minutes; paper: the papers' full sizes")
        ->capture_default_str();
    run_verb
        ->add_option("--solver", run_arguments.choice.solvers,
                     "only this solver (its label in the experiment); may be repeated")
        ->allow_extra_args(false);
    run_verb->add_option("--scene", run_arguments.choice.scenes, "only this scene; may be repeated")
        ->allow_extra_args(false);
    run_verb->add_option("--results", run_arguments.results,
                         "folder for the result file (default: results of the project, or of the working directory)");
    run_verb
        ->add_option("--shard", run_arguments.shard, "run only part i of n, written i/n; join the parts with `merge`")
        ->capture_default_str();
    run_verb->add_flag("--fresh", run_arguments.fresh, "start over: discard the finished cases of an earlier run");
    run_verb->add_flag("--any-build", run_arguments.any_build,
                       "keep rows that were measured by another build or on another machine");
    run_verb->add_flag(
        "--leave-nothing-out", run_arguments.choice.leave_nothing_out,
        "run every tolerance and build every structure, into STEM.everything.h5: to check that no answer "
        "changes");
    run_verb->add_flag("--quiet", run_arguments.quiet, "show no progress");
    takes_plugins(run_verb);
    run_verb->callback([&] { code = run(run_arguments); });

    RunArguments explain_arguments;
    auto* explain_verb = app.add_subcommand(
        "explain", "show what a run would prepare, run and leave out, with reasons and an estimate of the time");
    explain_verb->add_option("experiment", explain_arguments.file, "experiment file (.toml)")->required();
    explain_verb->add_option("--profile", explain_arguments.profile, "as for run")->capture_default_str();
    explain_verb->add_option("--solver", explain_arguments.choice.solvers, "as for run")->allow_extra_args(false);
    explain_verb->add_option("--scene", explain_arguments.choice.scenes, "as for run")->allow_extra_args(false);
    explain_verb->add_option("--results", explain_arguments.results,
                             "folder with earlier results, for the estimate of the time (default: results of the "
                             "project)");
    takes_plugins(explain_verb);
    explain_verb->callback([&] {
        const Plan plan = plan_of(explain_arguments);
        std::fputs(explain(plan, results_of(explain_arguments)).c_str(), stdout);
    });

    bool list_json = false;
    std::string listed;
    auto* list_verb = app.add_subcommand("list", "list the solvers, or what is asked for; everything with --json");
    list_verb->add_option("what", listed,
                          "solvers, experiments, models, or columns (of result files, as JSON); or the name of one "
                          "solver, experiment or model");
    list_verb->add_flag("--json", list_json, "print everything as one JSON object");
    takes_plugins(list_verb);
    list_verb->callback([&] {
        const std::string text = listed == "columns" ? columns_json().dump(1) + "\n"
                                 : list_json         ? list_as_json().dump(2) + "\n"
                                                     : list_as_text(listed, paper_of_output());
        std::fputs(text.c_str(), stdout);
    });

    MeasureRequest request;
    std::vector<std::string> parameters;
    bool measure_json = false;
    auto* measure_verb = app.add_subcommand("measure",
                                            "bound the distance from A to B (meshes or point sets in any common "
                                            "format, or algebraic surfaces as .surface.toml)");
    measure_verb->add_option("A", request.source, "source file: h(A,B) = max over a in A of the distance from a to B")
        ->required();
    measure_verb->add_option("B", request.target, "target file")->required();
    measure_verb->add_option(
        "--solver", request.solver,
        "see `hausbench list` (default: cover for meshes, scan for points, surface_enclosure for surfaces)");
    measure_verb
        ->add_option("--tolerance", request.tolerance, "largest gap between lower and upper bound, in the unit of --of")
        ->capture_default_str();
    measure_verb
        ->add_option(
            "--of", request.of,
            "diagonal, longest: a fraction of the diagonal or of the longest side of A's box; absolute: a length in "
            "the files' unit; lower: a fraction of the lower bound")
        ->capture_default_str()
        ->check([](const std::string& of) {
            return std::find(tolerance_units.begin(), tolerance_units.end(), of) != tolerance_units.end()
                       ? ""
                       : fmt::format("unknown unit '{}'{}", of, nearest_hint(of, tolerance_units));
        });
    measure_verb->add_flag("--symmetric", request.symmetric,
                           "h(A,B), h(B,A), each to the full tolerance, and H(A,B), the larger of the two");
    measure_verb->add_flag("--penetration", request.penetration,
                           "instead of a distance, how deep two closed meshes are in each other: the deepest pair of "
                           "points, of the volume that they have in common");
    measure_verb->add_option("--set", parameters, "a solver parameter, name=value; may be repeated");
    measure_verb->add_option("--cutoff", request.cutoff,
                             "only ask whether the distance is above this length: exit code 0 if it is at most that, 1 "
                             "if it is above, 3 if that is open; --time-limit is then 10 unless it is given");
    measure_verb->add_option("--time-limit", request.time_limit,
                             "seconds for preparing, and as many for solving; the bounds hold also when it is reached. "
                             "A solver that goes on is "
                             "killed after a tenth more, and at least 1 s");
    measure_verb->add_flag("--in-process", request.in_process,
                           "solve in this process, for debuggers: a solver that hangs or crashes then takes it along");
    measure_verb->add_option("--threads", request.threads, "that the solver may use, where it offers that")
        ->check(CLI::Range(1, 1024));
    measure_verb->add_option(
        "--fields", request.fields,
        "write A with the distance of each vertex to B and its nearest element, and what the solver knows of each "
        "element, into this file: .ply (MeshLab, CloudCompare) or .vtk (ParaView); with --symmetric too they are "
        "those of h(A,B)");
    measure_verb->add_option(
        "--certificate", request.certificate,
        "write a proof of the upper bound, from a second run, into this file, for `verify --certificate`");
    measure_verb->add_flag("--json", measure_json, "print one JSON object");
    takes_plugins(measure_verb);
    measure_verb->callback([&] {
        request.options = parse_parameters(parameters);
        request.tolerance_given = measure_verb->count("--tolerance") + measure_verb->count("--of") > 0;
        const Measured measured = measure(request);
        constexpr auto replace = nlohmann::json::error_handler_t::replace;  // output of a program may not be UTF-8
        std::fputs((measure_json ? to_json(measured, request).dump(-1, ' ', false, replace) + "\n"
                                 : describe(measured, request))
                       .c_str(),
                   stdout);
        code = exit_code(measured, request);
        if (const std::string why = no_answer(measured); !why.empty())
            fmt::print(stderr, "hausbench: solver '{}' gave no answer: {}\n", measured.solver, why);
    });

    std::string exported;
    fs::path export_to;
    auto* export_verb =
        app.add_subcommand("export", "write a model as OFF, OBJ or PLY with all digits, for other programs");
    export_verb->add_option("model", exported, "a model of datasets/manifest.toml, or any mesh file")->required();
    export_verb->add_option("file", export_to, "file to write: .off, .obj or .ply")->required();
    export_verb->callback([&] { fmt::print("{}\n", export_model(catalogue(), exported, export_to)); });

    std::vector<fs::path> verified;
    bool certificate = false;
    auto* verify_verb = app.add_subcommand(
        "verify",
        "check every row of a result independently of the solvers (surfaces: with the same interval bounds of "
        "polynomials); exit code 1 if a row is unsound or its model is unavailable. Or, with --certificate, check the "
        "proof that `measure --certificate` wrote: exit code 0 if it is accepted, 1 if it is refused");
    verify_verb
        ->add_option("files", verified, "a result (.h5); or a certificate, and A and B if they are not where they were")
        ->required();
    verify_verb->add_flag("--certificate", certificate, "the file is a certificate");
    verify_verb->callback([&] { code = certificate ? verify_proof(verified) : verify_rows_of(verified); });

    fs::path merged;
    std::vector<fs::path> parts;
    bool any_build = false;
    auto* merge_verb = app.add_subcommand(
        "merge", "join several results of one experiment, such as shards; exit code 1 if a shard is missing");
    merge_verb->add_option("out", merged, "result file to write (.h5)")->required();
    merge_verb->add_option("results", parts, "result files (.h5)")->required();
    merge_verb->add_flag("--any-build", any_build, "merge even if builds or machines differ");
    merge_verb->callback([&] {
        if (parts.size() < 2)
            throw InputError(
                "merge: needs at least two results: name the file to write first, then two or more results");
        std::error_code none;
        const auto is_merged = [&](const fs::path& part) { return fs::equivalent(part, merged, none); };
        if (fs::exists(merged, none) && std::none_of(parts.begin(), parts.end(), is_merged)) {
            throw InputError(
                fmt::format("{}: exists and is not one of the results to merge: name a new file first, or remove it",
                            merged.string()));
        }
        ResultFile result = merge_results(parts, any_build);
        say(verify_result(result, catalogue()));  // a lower bound in one part may refute an upper bound in another
        write_result(merged, result);
        fmt::print("{}: {} cases of {} results\n", merged.string(), result.rows.size(), parts.size());
        if (const std::string missing = missing_shards(result); !missing.empty()) say({missing}), code = 1;
    });

    std::vector<fs::path> compared;
    std::vector<std::string> two_solvers;
    auto* compare_verb = app.add_subcommand(
        "compare",
        "compare two results case by case: differing answers first, then ratios of times with intervals; or, with "
        "--solver, two solvers of one result");
    compare_verb->add_option("results", compared, "two result files (.h5), the base first; or one with --solver")
        ->required();
    compare_verb
        ->add_option("--solver", two_solvers,
                     "two solvers of one result, paired by scene, pose and tolerance: labels, or \"guthe(samples=8)\"")
        ->expected(2);
    compare_verb->callback([&] {
        if (compared.size() != (two_solvers.empty() ? 2 : 1))
            throw InputError(two_solvers.empty() ? "compare: name two results, or two solvers of one with --solver A B"
                                                 : "compare: --solver compares two solvers of one result: name one");
        // Never freed: the program ends, and freeing 100,000 rows one by one takes a tenth of reading them.
        const auto read = [&](std::size_t i) -> const ResultFile& { return *new ResultFile(read_result(compared[i])); };
        std::fputs((two_solvers.empty() ? compare_results(read(0), read(1))
                                        : compare_solvers(read(0), two_solvers[0], two_solvers[1], paper_of_output()))
                       .c_str(),
                   stdout);
    });

    fs::path shown_file;
    RowChoice shown_rows;
    bool csv = false, shown_json = false, markdown = false, summary = false;
    auto* show_verb = app.add_subcommand("show", "show the rows of a result: bounds, times, memory, status and reason");
    show_verb->add_option("result", shown_file, "result file (.h5)")->required();
    show_verb
        ->add_option("--solver", shown_rows.solvers,
                     "only this solver: its label, or \"guthe(samples=8)\"; may be repeated")
        ->allow_extra_args(false);
    show_verb->add_option("--scene", shown_rows.scenes, "only this scene; may be repeated")->allow_extra_args(false);
    show_verb
        ->add_option("--where", shown_rows.where,
                     "only rows with COLUMN=VALUE, or COLUMN!=VALUE, such as status=failed; `hausbench list columns` "
                     "names the columns; may be repeated")
        ->allow_extra_args(false);
    show_verb->add_flag("--summary", summary, "a line for each solver, then each reason that a row is not ok");
    auto* as_csv = show_verb->add_flag("--csv", csv, "as CSV, with all digits");
    auto* as_json = show_verb->add_flag("--json", shown_json, "as one JSON object, with all digits")->excludes(as_csv);
    show_verb->add_flag("--md", markdown, "as a table in Markdown")->excludes(as_csv)->excludes(as_json);
    show_verb->callback([&] {
        const Form form = csv ? Form::csv : shown_json ? Form::json : markdown ? Form::markdown : Form::text;
        ResultFile& result = *new ResultFile(read_result(shown_file));  // as in compare
        const auto rows = chosen_rows(result, shown_rows);
        if (!summary) {
            std::fputs(show_rows(result, rows, form, paper_of_output()).c_str(), stdout);
            return;
        }
        std::vector<Row> chosen;
        for (const std::size_t row : rows) chosen.push_back(std::move(result.rows[row]));
        result.rows = std::move(chosen);
        std::fputs(show_summary(result, paper_of_output()).c_str(), stdout);
    });

    // Hidden verbs, for the program itself: a crash in a reader or a solver ends only its own process.
    fs::path load_in, load_out;
    std::string load_format;
    auto* load_verb = app.add_subcommand("load")->group("");
    load_verb->add_option("file", load_in)->required();
    load_verb->add_option("out", load_out)->required();
    load_verb->add_option("--format", load_format);
    load_verb->callback([&] { write_shape(load_out, load_file(load_in, load_format)); });
    std::string operation;
    std::vector<std::string> numbers;
    auto* derive_verb = app.add_subcommand("derive")->group("");
    derive_verb->add_option("operation", operation)->required();
    derive_verb->add_option("origin", load_in)->required();
    derive_verb->add_option("out", load_out)->required();
    derive_verb->add_option("--set", numbers);
    derive_verb->callback([&] { derive_file(operation, numbers, load_in, load_out); });
    int events = -1;
    auto* worker_verb = app.add_subcommand("worker")->group("");
    worker_verb->add_option("--events", events)->required();
    worker_verb->callback([&] { code = worker_main(events); });

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help
        throw InputError(complaint(app, error));
    }
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
        throw InputError(fmt::format("cannot write the output: {}", std::strerror(errno)));
    return code;
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGXFSZ, SIG_IGN);  // a file size limit gives a write error, as a full disk does, instead of a signal
    try {
        return dispatch(argc, argv);
    } catch (const hausbench::InputError& error) {
        fmt::print(stderr, "hausbench: {}\n", error.what());
        return 2;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "hausbench: out of memory\n");
        return 4;
    } catch (const std::exception& error) {
        fmt::print(stderr, "hausbench: internal error: {}\n", error.what());
        return 3;
    }
}
