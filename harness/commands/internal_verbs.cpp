// Hidden verbs. Only this program calls `load`, `derive` and `worker`; the installation and the shell call `describe`, and
// Python programs call `vet` and `shapes` before they open HDF5 files.
#include "algorithms/registry.h"
#include "datasets/derive.h"
#include "datasets/load.h"
#include "datasets/paths.h"
#include "datasets/shape_file.h"
#include "harness/commands/help.h"
#include "harness/commands/verb.h"
#include "harness/plan/experiment.h"
#include "harness/result/guard.h"
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

// Returns a line for each file: why it must not be opened (problem_of); empty if it may be.
std::string vetted(const std::vector<fs::path>& files) {
    std::string lines;
    for (const fs::path& file : files) lines += problem_of(file) + "\n";
    return lines;
}

// Returns a line for each file: the content hash of the shape in it, or why it cannot be read (content_hash_in).
std::string content_hashes(const std::vector<fs::path>& files) {
    std::string lines;
    for (const fs::path& file : files) lines += content_hash_in(file) + "\n";
    return lines;
}

// Adds the verbs that tell Python programs about files, one line of standard output for each.
void add_verbs_for_python(CLI::App& app) {
    static std::vector<fs::path> files;
    const auto add = [&](const char* name, std::string (*about)(const std::vector<fs::path>&)) {
        auto* verb = app.add_subcommand(name)->group("");
        verb->add_option("files", files);
        verb->callback([about] { print(about(files)); });
    };
    add("vet", vetted);
    add("shapes", content_hashes);
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
    add_verbs_for_python(app);
}

}  // namespace hausbench
