#include "datasets/separate_process.h"

#include "algorithms/error.h"
#include "algorithms/printable.h"
#include "datasets/shape_file.h"
#include "process/child.h"
#include "process/interrupts.h"
#include "process/memory.h"

#include <fmt/format.h>

#include <cstring>
#include <vector>

namespace hausbench {
namespace {

std::string last_line(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
    const std::size_t newline = text.rfind('\n');
    text = newline == std::string::npos ? text : text.substr(newline + 1);
    constexpr std::string_view prefix = "hausbench: ";  // the child puts it before its messages
    // Made printable, because the message may quote bytes of the file.
    return printable(text.starts_with(prefix) ? text.substr(prefix.size()) : text);
}

// The words for a process in error messages.
struct Task {
    std::string subject, doer, cause;  // "a.obj", "the reader", "the file is damaged"
};

// Runs a program, whose path and arguments are `words`, until it ends. Throws InputError if it fails or exceeds a
// limit.
void run(const Task& task, std::vector<std::string> words, const std::function<void()>& waiting, double seconds_limit,
         std::int64_t bytes_limit) {
    const std::string program = words.front();
    if (bytes_limit == 0) bytes_limit = spare_bytes();
    Launch launch;
    launch.command = std::move(words);
    launch.silent = true;
    Child child(std::move(launch));
    const Child::End end = child.wait({seconds_limit, bytes_limit, waiting});
    const auto fail = [&](const std::string& what) { throw InputError(task.subject + ": " + what); };
    if (end == Child::End::interrupt) fail("interrupted while " + task.doer + " worked");
    if (end == Child::End::memory)
        fail(fmt::format("{} was stopped when it took more than {} MB of memory: {}, or too large for this machine",
                         task.doer, bytes_limit / 1'000'000, task.cause));
    if (end == Child::End::time) fail(fmt::format("{} did not finish within {} s", task.doer, seconds_limit));
    if (child.signal())
        fail(fmt::format("{} was killed by {}: {}, or {} cannot process it", task.doer, child.how_it_ended(),
                         task.cause, task.doer == "the reader" ? "its reader" : task.doer));
    const int code = child.exit_code();
    const std::string said = last_line(child.output());
    if (code == 127) throw InputError(program + ": cannot be started");
    if (code == 2 && !said.empty()) throw InputError(said);
    if (code == 4)  // the program's own code for a failed allocation
        fail(fmt::format("{} ran out of memory: {}, or too large for this machine", task.doer, task.cause));
    if (code != 0) fail(fmt::format("{} failed with exit code {}: {}", task.doer, code, said));
}

}  // namespace

LoadedShape load_separately(const std::filesystem::path& program, const std::filesystem::path& file,
                            const LoadOptions& options, const std::function<void()>& waiting, double seconds_limit,
                            std::int64_t bytes_limit) {
    const HoldInterrupts hold;  // declared first, so that Ctrl-C ends this process only after the folder is removed
    const ScratchFolder folder("load");
    const std::filesystem::path out = folder.path() / "shape.h5";
    std::vector<std::string> words = {program.string(), "load"};
    if (!options.format.empty()) words.insert(words.end(), {"--format", options.format});
    if (!options.columns.empty()) words.push_back("--columns=" + options.columns);
    if (options.drop_invalid) words.emplace_back("--drop-invalid");
    words.insert(words.end(), {"--", file.string(), out.string()});  // "--", because a path may begin with a dash
    run({file.string(), "the reader", "the file is damaged"}, std::move(words), waiting, seconds_limit, bytes_limit);
    return read_shape(out);
}

LoadedShape derive_separately(const std::filesystem::path& program, const std::string& operation,
                              const Numbers& numbers, const std::filesystem::path& origin,
                              const std::function<void()>& waiting, double seconds_limit, std::int64_t bytes_limit) {
    const HoldInterrupts hold;
    const ScratchFolder folder("derive");
    const std::filesystem::path out = folder.path() / "shape.h5";
    std::vector<std::string> words = {program.string(), "derive"};
    for (const auto& [name, value] : numbers) words.insert(words.end(), {"--set", fmt::format("{}={:a}", name, value)});
    words.insert(words.end(), {"--", operation, origin.string(), out.string()});
    run({operation, "CGAL", "the mesh is degenerate"}, std::move(words), waiting, seconds_limit, bytes_limit);
    return read_shape(out);
}

}  // namespace hausbench
