#include "harness/commands/verify_result.h"

#include "algorithms/error.h"
#include "algorithms/printable.h"
#include "datasets/shape_file.h"
#include "harness/check/contradictions.h"
#include "harness/check/verify.h"
#include "harness/commands/summary.h"
#include "harness/plan/own_models.h"
#include "harness/result/provenance.h"
#include "process/child.h"
#include "process/interrupts.h"
#include "process/memory.h"
#include "process/progress_line.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <map>
#include <new>

namespace hausbench {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

constexpr double most_seconds = 600;  // for all models together
constexpr double most_bytes = 1e9;    // for the shapes of all models that are not in the cache

void expect_measured(const ModelInfo& model, const std::string& measured, const std::string& current) {
    if (current == measured) return;
    if (model.source == "file")
        throw InputError(
            fmt::format("model '{}': {} holds another shape than the one that was measured (SHA-256 {} then, {} "
                        "now): put that file back, or run the experiment again",
                        model.name, (model.folder / model.path).string(), measured, current));
    throw InputError(
        fmt::format("model '{}': SHA-256 {} was measured, {} is here now: check out the manifest that the result was "
                    "made with",
                    model.name, measured, current));
}

// Returns the version of CGAL in a text that a program wrote to `/meta` as its libraries; empty if there is none.
std::string cgal_of(const std::string& libraries) {
    const json all = json::parse(libraries, nullptr, false);
    const json cgal = all.is_object() && all.contains("CGAL") ? all["CGAL"] : json();
    return cgal.is_string() ? cgal.get<std::string>() : "";
}

void send(int pipe, const json& told) {
    const std::string line = told.dump(-1, ' ', false, json::error_handler_t::replace) + '\n';
    for (std::size_t done = 0; done < line.size();) {
        const ssize_t n = ::write(pipe, line.data() + done, line.size() - done);
        if (n < 0 && errno != EINTR) ::_exit(1);  // the reader is gone
        if (n > 0) done += std::size_t(n);
    }
}

// Makes the models of a result in `folder`. Runs in a child process and sends a line for each model, in order: the file
// of its shape, or the reason why it is missing. A derived model counts as missing if another version of CGAL derives
// another shape. Stops at the first model that cannot be made.
int make_shapes(const ResultFile& result, Catalogue catalogue, const fs::path& folder, int pipe) {
    try {
        std::error_code unknown;
        const auto room = fs::space(folder, unknown);
        catalogue.keep_apart(folder, unknown ? most_bytes : std::min(most_bytes, double(room.available) / 2));
        add_own_models(catalogue, result);
        const std::string then = cgal_of(result.texts.at("libraries")), now = cgal_of(this_build().libraries);
        for (const ModelRecord& model : result.models) {
            const auto resolved = catalogue.resolve(model.name);
            if (const auto* absent = std::get_if<MissingModel>(&resolved)) {
                send(pipe, {{"missing", absent->reason}});
                continue;
            }
            const auto& good = std::get<ResolvedModel>(resolved);
            const ModelInfo& info = catalogue.find(model.name);
            if (info.source == "derived" && then != now && good.content_hash != model.sha256) {
                send(pipe, {{"missing", fmt::format("CGAL {} derives another shape than CGAL {} did", now, then)}});
                continue;
            }
            expect_measured(info, model.sha256, good.content_hash);
            send(pipe, {{"file", good.shape_file.string()}});
        }
    } catch (const InputError& error) {
        send(pipe, {{"error", error.what()}});
    } catch (const std::bad_alloc&) {
        send(pipe, {{"error", "there is not enough memory to make the models of the result"}});
    }
    return 0;
}

// Starts a process that runs make_shapes(), and receives its lines. Throws InputError if the process takes too much
// time or memory.
class Maker {
public:
    explicit Maker(Launch launch)
        : most_resident_(resident_of(::getpid()) + spare_bytes()), child_(std::move(launch)) {}

    json next() {
        std::string line;
        for (;;) {
            if (HoldInterrupts::came()) throw InputError("interrupted while the models of the result were made");
            progress_.draw("making the models of the result");
            const Child::Heard heard = child_.listen(std::chrono::milliseconds(20), line);
            if (heard == Child::Heard::line) return json::parse(line);
            if (heard == Child::Heard::closed)
                throw InputError(fmt::format("the models of the result cannot be made: their process ended with {}",
                                             child_.how_it_ended()));
            if (std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() > most_seconds)
                throw InputError(
                    fmt::format("the models of the result cannot be made within {} s: {}", most_seconds, remedy));
            if (child_.takes_more_than(most_resident_))
                throw InputError(fmt::format("the models of the result take more memory than is free: {}", remedy));
        }
    }

private:
    static constexpr const char* remedy =
        "if you trust the file, make them first with `hausbench explain` of its experiment";

    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    std::int64_t most_resident_;
    ProgressLine progress_;
    Child child_;
};

// Returns the shapes of the result's models by name. Adds a line to `missing` for each model that is not available. The
// result says how its models are made, and may come from a stranger. So a separate process makes them, within limits of
// time, memory and size, and without writing to the cache. Throws InputError beyond a limit, or if a model cannot be
// made or differs from the measured one.
std::map<std::string, Shape> foreign_shapes(const ResultFile& result, const Catalogue& manifest,
                                            std::vector<std::string>& missing) {
    const HoldInterrupts hold;  // destroyed after the folder, so that Ctrl-C leaves no folder behind
    const ScratchFolder folder("verify");
    Launch launch;
    launch.silent = true;
    launch.work = [&](int pipe) { return make_shapes(result, manifest, folder.path(), pipe); };
    Maker maker(std::move(launch));
    std::map<std::string, Shape> shapes;
    for (const ModelRecord& model : result.models) {
        const json told = maker.next();
        if (told.contains("error")) throw InputError(told["error"].get<std::string>());
        if (told.contains("missing"))
            missing.push_back(fmt::format("model '{}' is not here, so its rows are not checked: {}", model.name,
                                          told["missing"].get<std::string>()));
        else
            shapes[model.name] = read_shape(told["file"].get<std::string>()).shape;
    }
    return shapes;
}

}  // namespace

std::vector<std::string> verify_result(ResultFile& result, const Catalogue& manifest) {
    std::vector<std::string> missing;
    const std::map<std::string, Shape> shapes = foreign_shapes(result, manifest, missing);
    const auto load = [&](const std::string& name) -> const Shape* {
        const auto at = shapes.find(name);
        return at == shapes.end() ? nullptr : &at->second;
    };
    ProgressLine progress;
    const std::string doing = fmt::format("checking {} rows", result.rows.size() + result.references.size());
    const auto stop = [&] {
        progress.draw(doing);
        return false;
    };
    verify_rows(result.rows, result.references, load, stop);
    for (std::string& line : contradictions(result.rows, load)) missing.push_back(std::move(line));
    return missing;
}

bool any_unsound(const ResultFile& result) {
    const auto any = [](const std::vector<Row>& rows) {
        return std::any_of(rows.begin(), rows.end(), [](const Row& row) {
            return row.check.lower == Verdict::unsound || row.check.upper == Verdict::unsound ||
                   row.check.fields == Verdict::unsound;
        });
    };
    return any(result.rows) || any(result.references);
}

std::string describe_checks(const ResultFile& result) {
    std::map<std::string, std::map<Verdict, int>> lower, upper;
    const SummaryNames names(result.rows);
    for (const Row& row : result.rows) {
        const std::string name = printable(names.of(row.spec));
        ++lower[name][row.check.lower];
        ++upper[name][row.check.upper];
    }
    std::size_t width = 16;
    for (const auto& [name, counts] : lower) width = std::max(width, name.size());
    std::string text = fmt::format("{:<{}} {:>8} {:>8} {:>8} {:>11} | {:>8} {:>8} {:>8}\n", "lower bound of", width,
                                   "holds", "unsound", "not ch.", "(no witn.)", "upper ok", "unsound", "not ch.");
    for (auto& [label, l] : lower) {
        auto& u = upper[label];
        const int unchecked = l[Verdict::not_checked] + l[Verdict::no_witness];
        text += fmt::format("{:<{}} {:>8} {:>8} {:>8} {:>11} | {:>8} {:>8} {:>8}\n", label, width, l[Verdict::holds],
                            l[Verdict::unsound], unchecked, fmt::format("({})", l[Verdict::no_witness]),
                            u[Verdict::holds], u[Verdict::unsound], u[Verdict::not_checked]);
    }
    std::map<Verdict, int> fields;
    for (const Row& row : result.rows) {
        if (!row.fields.empty()) ++fields[row.check.fields];
    }
    if (!fields.empty())
        text += fmt::format("fields of cases: {} hold, {} unsound, {} not checked\n", fields[Verdict::holds],
                            fields[Verdict::unsound], fields[Verdict::not_checked]);
    text += describe_references(result);
    for (const auto* rows : {&result.rows, &result.references}) {
        for (const Row& row : *rows) {
            if (!row.check.reason.empty())
                text += fmt::format("unsound: {}: {}\n", name_of(row.spec), printable(row.check.reason));
        }
    }
    return text;
}

}  // namespace hausbench
