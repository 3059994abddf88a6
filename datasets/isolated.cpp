#include "isolated.h"

#include "error.h"
#include "scratch.h"
#include "shape_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <vector>

namespace hausbench {
namespace {

struct Outcome {
    int status = 0;  // as waitpid gives it
    bool timed_out = false, too_big = false, interrupted = false;
    std::string errors;  // the end of its standard error
};

constexpr std::size_t errors_kept = 16384;

// Resident set of the process; 0 if it has ended.
std::int64_t resident_bytes(pid_t process) {
    std::ifstream in(fmt::format("/proc/{}/statm", process));
    std::int64_t size = 0, resident = 0;
    in >> size >> resident;
    return resident * ::sysconf(_SC_PAGE_SIZE);
}

// Three quarters of the free memory of the machine or the container: more could make the kernel kill other processes.
std::int64_t spare_bytes() {
    std::int64_t spare = std::numeric_limits<std::int64_t>::max(), number = 0;
    std::string key, unit;
    for (std::ifstream in("/proc/meminfo"); in >> key >> number && std::getline(in, unit);)
        if (key == "MemAvailable:") spare = number * 1024;
    for (const char* file : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"})
        if (std::ifstream in(file); in >> number) spare = std::min(spare, number);  // "max" is not a number
    return spare / 4 * 3;
}

Outcome run(std::vector<std::string> words, double seconds_limit, std::int64_t bytes_limit) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    std::array<int, 2> pipe{};
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
    const pid_t parent = ::getpid(), child = ::fork();
    if (child < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
    if (child == 0) {  // only calls that are safe after a fork of a program with threads
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (::getppid() != parent) ::_exit(127);
        const int nothing = ::open("/dev/null", O_RDWR);
        ::dup2(nothing, STDIN_FILENO);
        ::dup2(nothing, STDOUT_FILENO);
        ::dup2(pipe[1], STDERR_FILENO);
        ::execv(arguments[0], arguments.data());
        ::_exit(127);
    }
    ::close(pipe[1]);

    using Clock = std::chrono::steady_clock;
    const auto deadline = Clock::now() + std::chrono::duration<double>(seconds_limit);
    Outcome outcome;
    bool open = true;
    const auto listen = [&](int milliseconds) {  // true where something came
        if (!open) {
            ::poll(nullptr, 0, std::min(milliseconds, 5));
            return false;
        }
        pollfd watched{pipe[0], POLLIN, 0};
        if (::poll(&watched, 1, milliseconds) <= 0) return false;
        std::array<char, 4096> buffer{};
        const ssize_t count = ::read(pipe[0], buffer.data(), buffer.size());
        if (count <= 0) {
            open = false;
            return false;
        }
        outcome.errors.append(buffer.data(), static_cast<std::size_t>(count));
        if (outcome.errors.size() > errors_kept) outcome.errors.erase(0, outcome.errors.size() - errors_kept);
        return true;
    };
    for (;;) {
        if (!outcome.timed_out && !outcome.too_big && !outcome.interrupted) {
            outcome.interrupted = HoldInterrupts::came();
            outcome.timed_out = Clock::now() >= deadline;
            outcome.too_big = resident_bytes(child) > bytes_limit;
            if (outcome.timed_out || outcome.too_big || outcome.interrupted) ::kill(child, SIGKILL);
        }
        listen(20);
        const pid_t done = ::waitpid(child, &outcome.status, WNOHANG);
        if (done == child || (done < 0 && errno != EINTR)) break;
    }
    while (listen(0)) {
    }  // its last output; the pipe may have no end, since a grandchild may hold it open
    ::close(pipe[0]);
    return outcome;
}

std::string last_line(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
    const std::size_t newline = text.rfind('\n');
    text = newline == std::string::npos ? text : text.substr(newline + 1);
    // It may quote the file, which may contain control characters.
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    constexpr std::string_view prefix = "hausbench: ";  // the program puts it before its messages
    return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
}

// What is done in the process, in the words of errors.
struct Task {
    std::string subject, doer, cause;  // "a.obj", "the reader", "the file is damaged"
};

// Runs the program, which writes a shape to `out`; throws InputError where it does not.
LoadedShape shape_of(const Task& task, std::vector<std::string> words, const std::filesystem::path& out,
                     double seconds_limit, std::int64_t bytes_limit) {
    const std::string program = words.front();
    if (bytes_limit == 0) bytes_limit = spare_bytes();
    const Outcome outcome = run(std::move(words), seconds_limit, bytes_limit);
    const auto fail = [&](const std::string& what) { throw InputError(task.subject + ": " + what); };
    if (outcome.interrupted) fail("interrupted while " + task.doer + " worked");
    if (outcome.too_big)
        fail(fmt::format("{} was stopped when it took more than {} MB of memory: {}, or too large for this machine",
                         task.doer, bytes_limit / 1'000'000, task.cause));
    if (outcome.timed_out) fail(fmt::format("{} did not finish within {} s", task.doer, seconds_limit));
    const std::string said = last_line(outcome.errors);
    if (WIFSIGNALED(outcome.status)) {
        const int number = WTERMSIG(outcome.status);
        fail(fmt::format("{} was killed by signal {} ({}): {}, or {} cannot process it", task.doer, number,
                         ::strsignal(number), task.cause, task.doer == "the reader" ? "its reader" : task.doer));
    }
    const int code = WEXITSTATUS(outcome.status);
    if (code == 127) throw InputError(program + ": cannot be started");
    if (code == 2 && !said.empty()) throw InputError(said);
    if (code == 4)  // the program's own, where an allocation failed
        fail(fmt::format("{} ran out of memory: {}, or too large for this machine", task.doer, task.cause));
    if (code != 0) fail(fmt::format("{} failed with exit code {}: {}", task.doer, code, said));
    return read_shape(out);
}

}  // namespace

LoadedShape load_isolated(const std::filesystem::path& program, const std::filesystem::path& file,
                          const std::string& format, double seconds_limit, std::int64_t bytes_limit) {
    const HoldInterrupts hold;  // destroyed after the folder
    const ScratchFolder folder("load");
    const std::filesystem::path out = folder.path() / "shape.h5";
    std::vector<std::string> words = {program.string(), "load"};
    if (!format.empty()) words.insert(words.end(), {"--format", format});
    words.insert(words.end(), {"--", file.string(), out.string()});  // its name may begin with a dash
    return shape_of({file.string(), "the reader", "the file is damaged"}, std::move(words), out, seconds_limit,
                    bytes_limit);
}

LoadedShape derive_isolated(const std::filesystem::path& program, const std::string& operation, const Numbers& numbers,
                            const std::filesystem::path& origin, double seconds_limit, std::int64_t bytes_limit) {
    const HoldInterrupts hold;
    const ScratchFolder folder("derive");
    const std::filesystem::path out = folder.path() / "shape.h5";
    std::vector<std::string> words = {program.string(), "derive"};
    for (const auto& [name, value] : numbers) words.insert(words.end(), {"--set", fmt::format("{}={:a}", name, value)});
    words.insert(words.end(), {"--", operation, origin.string(), out.string()});
    return shape_of({operation, "CGAL", "the mesh is degenerate"}, std::move(words), out, seconds_limit, bytes_limit);
}

}  // namespace hausbench
