// Runs another program as a solver, given its command line, so that programs by the authors of papers can be compared
// without linking them.
//
// The program gets the tolerance on the command line, and two files: A, moved by its pose, and B. Coordinates have 17
// digits. B is written once, before the clock starts. Regular expressions find the bounds in the program's output. A
// bound that the program does not print is 0 (lower) or infinity (upper). The bounds are not certified. They are bounds
// on h(A,B), or on the one statistic of the query.
//
// The time of a solve includes writing A, starting the program, and the program's reading of both files. The parameter
// `seconds` finds the time that the program itself reports. Relative paths in the command line start from the folder of
// the experiment (`run`) or from the current folder (`measure`). A command line that does not mention the tolerance is
// run once for all tolerances of an experiment.
#include "harness/run/external.h"

#include "algorithms/error.h"
#include "algorithms/solver.h"
#include "harness/run/mesh_file.h"
#include "process/child.h"
#include "process/interrupts.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <regex>
#include <string_view>

namespace hausbench {
namespace {

namespace fs = std::filesystem;

// Finds a number in a program's output with a regular expression that has one group, around the number. The last line
// that matches counts, because programs print their progress first.
class Place {
public:
    explicit Place(const std::string& text) : text_(text), expression_(text, std::regex::ECMAScript) {}

    bool told() const { return !text_.empty(); }  // false if no expression is given

    // Returns the number. Returns nothing if no line matches, or if the last match is not a number.
    std::optional<double> find(const std::string& output) const {
        std::optional<double> last;
        if (!told()) return last;
        constexpr std::size_t longest = 4096;  // std::regex recurses for each character and may exhaust the stack
        for (std::size_t begin = 0; begin < output.size();) {
            const std::size_t end = std::min(output.find('\n', begin), output.size());
            const std::string line = output.substr(begin, std::min(end - begin, longest));
            std::smatch match;
            if (std::regex_search(line, match, expression_)) {
                const std::string number = match[1].str();
                char* rest = nullptr;
                const double value = std::strtod(number.c_str(), &rest);
                last.reset();
                if (rest != number.c_str() && *rest == '\0' && !std::isnan(value)) last = value;
            }
            begin = end + 1;
        }
        return last;
    }

private:
    std::string text_;
    std::regex expression_;
};

std::string command_problem(const std::string& value) {
    for (const char* file : {"{A}", "{B}"}) {
        if (value.find(file) == std::string::npos)
            return fmt::format("does not contain {}: write it where the program takes that file", file);
    }
    return "";
}

std::string expression_problem(const std::string& value) {
    if (value.empty()) return "";
    try {
        if (std::regex(value, std::regex::ECMAScript).mark_count() == 1) return "";
        return "must have one group, ( ), around the number";
    } catch (const std::regex_error& error) {
        return fmt::format("is not a regular expression ({}): see the ECMAScript syntax", error.what());
    }
}

void replace(std::string& text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
}

// How a command ended, and its output.
struct CommandRun {
    Child::End end;
    std::string how_it_ended, output;
    std::int64_t peak_bytes;
};

std::string last_words(const std::string& output) {
    const std::size_t begin = output.find_last_not_of(" \n\r\t");
    if (begin == std::string::npos) return "";
    const std::string text = output.substr(0, begin + 1);
    return "; end of its output: " + text.substr(text.size() - std::min<std::size_t>(text.size(), 400));
}

// Runs a command line in `folder` for at most `seconds`. When it ends, the processes that it started are killed.
CommandRun run_command(const std::string& line, double seconds, const fs::path& folder) {
    Launch launch;
    launch.command = {"/bin/sh", "-c", line};
    launch.folder = folder;
    launch.kept = std::size_t(16) << 20;
    launch.dies_with_parent = true;
    Child child(std::move(launch));
    const Child::End end = child.wait({.seconds = seconds});
    return {end, child.how_it_ended(), child.output(), child.peak_bytes()};
}

class External final : public Solver {
public:
    explicit External(const Options& options)
        : command_(options.text("command")),
          extension_(options.text("format")),
          lower_(options.text("lower")),
          upper_(options.text("upper")),
          seconds_(options.text("seconds")),
          seconds_unit_(options.real("seconds_unit")),
          folder_of_command_(options.folder()) {
        if (!lower_.told() && !upper_.told()) {
            throw InputError(
                "solver 'external': neither 'lower' nor 'upper' is given, so its answer cannot be found: give one or "
                "both");
        }
    }
    void prepare(const Scene& scene, const Prepared&) override {
        scene_ = &scene;
        folder_.emplace("external");
        write_mesh_file(file("B"), scene.target, mesh_format_of(file("B")));
    }

    Result solve(const Query& query, State*, Trace&) const override {
        Result result;
        for (const Statistic& statistic : query.statistics)
            result.statistics.push_back(is_share(statistic) ? Bounds{0, 1} : Bounds{});
        if (query.statistics.size() > 1) {
            result.note = "the expressions find one statistic, but the query asks for several";
            return result;
        }
        Shape a = scene_->source;
        points_of(a) = posed(points_of(scene_->source), query.source_pose);
        const bool needs_length = command_.find("tolerance}") != std::string::npos;
        if (needs_length && query.tolerance.of == Tolerance::Of::lower) {
            result.note =
                "the command line needs the tolerance as a length, but the query gives a fraction of the lower bound";
            return result;
        }
        write_mesh_file(file("A"), a, mesh_format_of(file("A")));
        std::string line = command_;
        replace(line, "{A}", shell_quoted(file("A").string()));
        replace(line, "{B}", shell_quoted(file("B").string()));
        replace(line, "{tolerance}", fmt::format("{:.17g}", query.tolerance.value));
        replace(line, "{relative_tolerance}", fmt::format("{:.17g}", query.tolerance.value / diagonal(points_of(a))));
        const CommandRun run = run_command(line, query.time_limit, folder_of_command_);
        if (run.end == Child::End::interrupt) {  // removes the files, then ends this process by the signal
            folder_.reset();
            HoldInterrupts::deliver();
        }
        result.outside_bytes = run.peak_bytes;
        fs::remove(file("A"));
        read(run, query, result);
        return result;
    }

private:
    // Returns the path of file A or B. It is absolute because the program runs in another folder.
    fs::path file(const char* name) const {
        return fs::absolute(folder_->path() / (std::string(name) + "." + extension_));
    }

    void read(const CommandRun& run, const Query& query, Result& result) const {
        if (run.end != Child::End::by_itself) {
            result.status = Status::time_limit;
            result.note = "the program did not end in time" + last_words(run.output);
            return;
        }
        if (!run.how_it_ended.empty()) {
            result.note = "the program ended with " + run.how_it_ended + last_words(run.output);
            return;
        }
        const auto lower = lower_.find(run.output), upper = upper_.find(run.output),
                   seconds = seconds_.find(run.output);
        if (seconds) result.reported_seconds = *seconds * seconds_unit_;
        if ((lower_.told() && !lower) || (upper_.told() && !upper)) {
            result.note = fmt::format("the program's output has no number that '{}' matches{}",
                                      lower_.told() && !lower ? "lower" : "upper", last_words(run.output));
            return;
        }
        Bounds bounds;
        if (lower) bounds.lower = *lower;
        if (upper) bounds.upper = *upper;
        if (std::isinf(bounds.lower) || bounds.upper < 0) {
            result.note = fmt::format("the program's bounds [{}, {}] are not an interval of distances", bounds.lower,
                                      bounds.upper);
            return;
        }
        result.bounds = bounds;
        std::optional<Status> answer = query.answer(bounds.lower, bounds.upper);
        if (query.quantity == Quantity::distribution) {
            result.statistics = {bounds};
            answer = query.within_tolerance(result.statistics) ? std::optional(Status::converged) : std::nullopt;
        }
        if (answer) {
            result.status = *answer;
        } else {
            result.status = Status::precision_floor;  // the program ended normally
            result.note = !upper   ? "the program gives no upper bound"
                          : !lower ? "the program gives no lower bound"
                                   : "the program's own interval is wider than the tolerance";
        }
    }

    std::string command_, extension_;
    Place lower_, upper_, seconds_;
    double seconds_unit_;
    fs::path folder_of_command_;
    const Scene* scene_ = nullptr;
    HoldInterrupts hold_;  // destroyed after folder_, so that an interrupt leaves no files behind
    mutable std::optional<ScratchFolder> folder_;
};

}  // namespace

SolverEntry external_solver() {
    SolverInfo info;
    info.name = "external";
    info.title = "external program";
    info.source = info.target = {.points = true, .mesh = true};
    info.original_coordinates = true;
    info.quantities = {Quantity::directed, Quantity::distribution};
    const auto place = [](const char* name, const char* what) -> ParameterSpec {
        return {.name = name, .default_value = std::string(), .description = what, .problem = expression_problem};
    };
    info.parameters = {
        {.name = "command",
         .default_value = std::string(),
         .description =
             "command line of the shell; {A} and {B} become the files, {tolerance} the tolerance as a length, "
             "{relative_tolerance} as a fraction of the diagonal of A as handed over",
         .problem = command_problem,
         .command = true},
        {.name = "format",
         .default_value = std::string("off"),
         .description = "format of the files",
         .choices = {"off", "obj"}},
        place("lower",
              "regular expression (ECMAScript) with one group around the lower bound, tried on each line of the "
              "output; empty: not printed"),
        place("upper", "the same for the upper bound"),
        place("seconds", "the same for the time that the program reports"),
        {.name = "seconds_unit",
         .default_value = 1.0,
         .unit = "s",
         .description = "length of one unit of that time: 1e-3 for milliseconds",
         .least = 1e-12,
         .most = 1e6},
    };
    return {info,
            [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<External>(options); }};
}

}  // namespace hausbench
