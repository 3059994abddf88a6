#include "harness/result/guard.h"

#include "algorithms/error.h"
#include "algorithms/printable.h"
#include "datasets/hdf5.h"
#include "datasets/seal.h"
#include "harness/result/result_file.h"
#include "process/child.h"
#include "process/memory.h"

#include <fmt/format.h>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <new>
#include <stdexcept>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

enum ExitCode { returned = 0, threw = 3, out_of_memory = 4, newer = 5 };

// The work of the copy. Its standard output becomes the text of its end.
int call(const std::function<std::string()>& read) {
    const auto end = [](ExitCode code, const std::string& text) {
        std::fputs(text.c_str(), stdout);
        std::fflush(stdout);
        return int(code);
    };
    try {
        return end(returned, read());
    } catch (const NewerResult& error) {
        return end(newer, error.what());
    } catch (const std::bad_alloc&) {
        return out_of_memory;
    } catch (const std::length_error&) {
        return out_of_memory;
    } catch (const std::exception& error) {
        return end(threw, error.what());
    }
}

// Returns why a file cannot be opened as HDF5; an empty string if it can be tried.
std::string problem_of_kind(const fs::path& file) {
    std::error_code gone;
    const fs::file_status status = fs::status(file, gone);
    if (!fs::exists(status)) return "does not exist";
    if (fs::is_directory(status)) return "is a folder";
    return fs::is_regular_file(status) ? "" : "is not a regular file";
}

// Returns a message without the name of the file at its beginning, on one line.
std::string without_name(const fs::path& file, std::string message) {
    if (message.starts_with(file.string() + ": ")) message.erase(0, file.string().size() + 2);
    return printable(message);
}

}  // namespace

CopyEnd read_in_a_copy(const fs::path& file, const std::function<std::string()>& read) {
    const auto bytes = std::int64_t(fs::file_size(file));
    Launch launch;
    launch.silent = true;  // hides the message of an abort
    launch.work = [&](int) {
        const rlimit nothing{0, 0}, enough{rlim_t(5 + bytes / 1'000'000), rlim_t(6 + bytes / 1'000'000)};
        ::setrlimit(RLIMIT_CORE, &nothing);
        ::setrlimit(RLIMIT_CPU, &enough);  // seconds, as HDF5 loops for ever on some files; it reads 100 MB/s
        return call(read);
    };
    const std::int64_t most = (std::int64_t(1) << 30) + 16 * bytes;  // a damaged count may ask for more
    const ChildLimits limits{.seconds = 60 + double(bytes) / 1e6,    // enough for a slow disk
                             .resident_bytes = resident_of(::getpid()) + std::min(most, spare_bytes())};
    Child copy(std::move(launch));
    const Child::End end = copy.wait(limits);
    if (end == Child::End::interrupt) throw InputError(fmt::format("{}: interrupted while it was read", file.string()));
    if (end == Child::End::time)
        throw std::runtime_error(fmt::format("reading it takes more than {} s", limits.seconds));
    if (end == Child::End::memory || (!copy.signal() && copy.exit_code() == out_of_memory))
        throw std::runtime_error("it asks for more memory than its size justifies");
    if (copy.signal()) throw std::runtime_error(fmt::format("reading it ends with {}", copy.how_it_ended()));
    switch (copy.exit_code()) {
        case returned:
            return {CopyEnd::Kind::returned, copy.output()};
        case threw:
            return {CopyEnd::Kind::threw, copy.output()};
        case newer:
            return {CopyEnd::Kind::newer, copy.output()};
        default:
            throw std::runtime_error(fmt::format("reading it ends with {}", copy.how_it_ended()));
    }
}

std::string problem_of(const fs::path& file) {
    if (std::string problem = problem_of_kind(file); !problem.empty()) return problem;
    try {
        h5::check_seal(file);
        const CopyEnd end = read_in_a_copy(file, [&]() -> std::string {
            h5::File(file, h5::Open::read).expect_self_contained();
            return "";
        });
        return without_name(file, end.text);
    } catch (const std::exception& error) {
        return without_name(file, error.what());
    }
}

std::string content_hash_in(const fs::path& file) {
    if (std::string problem = problem_of_kind(file); !problem.empty()) return problem;
    try {
        const CopyEnd end = read_in_a_copy(file, [&]() -> std::string {
            const h5::File in(file, h5::Open::read);
            return in.has_attribute("", "shape_schema") ? in.text_attribute("", "content_hash") : "";
        });
        return without_name(file, end.text);
    } catch (const std::exception& error) {
        return without_name(file, error.what());
    }
}

}  // namespace hausbench
