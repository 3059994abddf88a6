// Hidden verbs. Only this program calls `load`, `derive` and `worker`; the installation and the shell call `describe`.
#include "algorithms/registry.h"
#include "datasets/derive.h"
#include "datasets/load.h"
#include "datasets/paths.h"
#include "datasets/shape_file.h"
#include "harness/commands/help.h"
#include "harness/commands/verb.h"
#include "harness/plan/experiment.h"
#include "harness/run/worker_main.h"

#include <algorithm>
#include <cstdlib>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

void derive_file(const std::string& operation, const std::vector<std::string>& texts, const fs::path& origin,
                 const fs::path& out) {
    Numbers numbers;
    for (const std::string& text : texts) {
        const auto equals = std::min(text.find('='), text.size() - 1);
        // Exact, because the caller writes the numbers in hexadecimal.
        numbers[text.substr(0, equals)] = std::strtod(text.c_str() + equals + 1, nullptr);
    }
    write_shape(out, derive(operation, numbers, read_shape(origin)));
}

// Returns the man page, the bash completion, or the names of solvers, experiments or models, one per line.
std::string described(const CLI::App& program, const std::string& what) {
    if (what == "man") return man_page(program);
    if (what == "bash") return bash_completion(program);
    std::string names;
    if (what == "solvers") {
        for (const SolverEntry& solver : solvers()) names += solver.info.name + "\n";
    } else if (what == "experiments") {
        for (const fs::path& file : experiment_files(experiments_folder())) names += file.stem().string() + "\n";
    } else {
        const Catalogue all = catalogue();
        for (const ModelInfo& model : all.models()) {
            if (!model.of_corpus) names += model.name + "\n";
        }
    }
    return names;
}

}  // namespace

void add_internal_verbs(CLI::App& app, int& code) {
    static fs::path in, out;
    static std::string operation;
    static LoadOptions options;
    static std::vector<std::string> numbers;
    static int events = -1;
    auto* load = app.add_subcommand("load")->group("");
    load->add_option("file", in)->required();
    load->add_option("out", out)->required();
    load->add_option("--format", options.format);
    load->add_option("--columns", options.columns);
    load->add_flag("--drop-invalid", options.drop_invalid);
    load->callback([] { write_shape(out, load_file(in, options)); });
    auto* derive = app.add_subcommand("derive")->group("");
    derive->add_option("operation", operation)->required();
    derive->add_option("origin", in)->required();
    derive->add_option("out", out)->required();
    derive->add_option("--set", numbers);
    derive->callback([] { derive_file(operation, numbers, in, out); });
    auto* worker = app.add_subcommand("worker")->group("");
    worker->add_option("--events", events)->required();
    worker->callback([&code] { code = worker_main(events); });
    static std::string what;
    auto* describe = app.add_subcommand("describe")->group("");
    describe->add_option("what", what)
        ->required()
        ->check(CLI::IsMember({"man", "bash", "solvers", "experiments", "models"}));
    describe->callback([&app] { print(described(app, what)); });
}

}  // namespace hausbench
