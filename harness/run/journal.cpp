#include "harness/run/journal.h"

#include "algorithms/error.h"
#include "datasets/hash.h"
#include "harness/record/json.h"
#include "harness/result/provenance.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace hausbench {

using nlohmann::json;

namespace {

constexpr int journal_schema = 4;

std::string checksum(std::string_view text) { return Sha256().add(text.data(), text.size()).hex().substr(0, 16); }

// Returns whether the text is the beginning of a journal's first line, left by a write that did not finish.
bool torn_header(std::string_view text) {
    constexpr std::string_view start = R"({"hausbench_journal":)";
    if (text.find('\n') != std::string_view::npos) return false;
    for (std::size_t i = 0; i < text.size() && i < 17 + start.size(); ++i) {
        const char c = text[i];
        const bool fits = i < 16    ? (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f')
                          : i == 16 ? c == ' '
                                    : c == start[i - 17];
        if (!fits) return false;
    }
    return true;
}

bool is_regular(int descriptor) {
    struct stat status {};
    return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

}  // namespace

Journal::Journal(std::filesystem::path file, bool start_over) : file_(std::move(file)) {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0644);
    if (descriptor_ < 0) {
        throw InputError(fmt::format("{}: cannot write the journal: {}; choose another folder with --results",
                                     file_.string(), std::strerror(errno)));
    }
    if (!is_regular(descriptor_)) {
        ::close(descriptor_);
        throw InputError(fmt::format("{}: is not a regular file: move it away, or choose another folder with --results",
                                     file_.string()));
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        ::close(descriptor_);
        throw InputError(
            fmt::format("{}: another run is writing this result: wait until it ends, or stop it", file_.string()));
    }
    try {
        try {
            read(false);
        } catch (const InputError&) {
            if (!start_over) throw;
            clear();
        }
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

Journal::~Journal() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

Journal::Journal(std::filesystem::path file, ReadOnly) : file_(std::move(file)) {
    descriptor_ = ::open(file_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);  // O_NONBLOCK: at a pipe, open() would wait
    if (descriptor_ < 0 && errno == ENOENT) return;
    if (descriptor_ < 0)
        throw InputError(fmt::format("{}: cannot read the journal: {}", file_.string(), std::strerror(errno)));
    if (!is_regular(descriptor_)) {
        ::close(descriptor_);
        throw InputError(fmt::format("{}: is not a regular file: move it away", file_.string()));
    }
    try {
        read(true);
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

void Journal::begin() {
    started_ = utc_now();
    write_line(json{{"hausbench_journal", journal_schema}, {"started", started_}}.dump());
}

void Journal::read(bool read_only) {
    std::string text;
    char buffer[1 << 16];
    for (;;) {
        const ssize_t n = ::read(descriptor_, buffer, sizeof buffer);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0)
            throw InputError(fmt::format("{}: cannot read the journal: {}", file_.string(), std::strerror(errno)));
        if (n == 0) break;
        text.append(buffer, std::size_t(n));
    }
    std::size_t good = 0;  // total length of the complete lines so far
    for (int number = 1; good < text.size(); ++number) {
        const std::size_t end = text.find('\n', good);
        const bool last = end == std::string::npos || end + 1 == text.size();
        const std::string line = text.substr(good, end == std::string::npos ? end : end - good);
        if (end == std::string::npos || line.size() < 18 || line[16] != ' ' ||
            checksum(std::string_view(line).substr(17)) != line.substr(0, 16)) {
            if (number == 1 && !torn_header(text)) {
                throw InputError(fmt::format(
                    "{}: is not a journal of hausbench: move it away, or choose another folder with --results",
                    file_.string()));
            }
            if (!last)
                throw InputError(fmt::format("{}:{}: damaged: start over with --fresh, without --solver and --scene",
                                             file_.string(), number));
            break;  // incomplete: its write did not finish
        }
        if (!take(number, std::string_view(line).substr(17))) {
            throw InputError(
                fmt::format("{}:{}: is not a record of a run: start over with --fresh, without --solver and --scene",
                            file_.string(), number));
        }
        good = end + 1;
    }
    if (read_only) return;
    if (::ftruncate(descriptor_, off_t(good)) != 0 || ::lseek(descriptor_, 0, SEEK_END) < 0) {
        throw InputError(
            fmt::format("{}: cannot remove its incomplete last line: {}", file_.string(), std::strerror(errno)));
    }
    if (started_.empty()) begin();
}

bool Journal::take(int number, std::string_view text) {
    try {
        const json record = json::parse(text);
        if (number > 1 && record.contains("forgotten")) {
            erase(record.at("forgotten").get<std::set<std::string>>());
            return true;
        }
        if (number > 1) {
            if (!record.at("round").is_number_integer()) return false;
            outcomes_[{record.at("identity"), record.at("round")}] = outcome_from_json(record.at("outcome"));
            return true;
        }
        if (record.value("hausbench_journal", json()) != journal_schema) {
            throw InputError(fmt::format(
                "{}: written by another version of hausbench: finish with that version, or start over with --fresh",
                file_.string()));
        }
        started_ = record.at("started");
        return true;
    } catch (const InputError&) {
        throw;
    } catch (const json::exception&) {
        return false;
    } catch (const std::runtime_error&) {  // a value that its column cannot hold, such as an unknown status
        return false;
    }
}

void Journal::clear() {
    outcomes_.clear();
    if (::ftruncate(descriptor_, 0) != 0 || ::lseek(descriptor_, 0, SEEK_SET) < 0) {
        throw InputError(fmt::format("{}: cannot empty it: {}", file_.string(), std::strerror(errno)));
    }
    begin();
}

void Journal::write_line(const std::string& text) {
    const std::string line = checksum(text) + ' ' + text + '\n';
    const off_t start = ::lseek(descriptor_, 0, SEEK_CUR);
    std::size_t done = 0;
    while (done < line.size()) {
        const ssize_t n = ::write(descriptor_, line.data() + done, line.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) {
            const int cause = errno;
            // Removes the incomplete line, which needs no room on the disk. If this fails, the next open removes the
            // line.
            if (::ftruncate(descriptor_, start) == 0) ::lseek(descriptor_, start, SEEK_SET);
            throw InputError(fmt::format("{}: cannot write: {}; finished cases are saved: make room and run again",
                                         file_.string(), std::strerror(cause)));
        }
        done += std::size_t(n);
    }
    if (::fsync(descriptor_) != 0 && errno != EINVAL) {
        throw InputError(fmt::format("{}: cannot write: {}; finished cases are saved: make room and run again",
                                     file_.string(), std::strerror(errno)));
    }
}

void Journal::erase(const std::set<std::string>& identities) {
    std::erase_if(outcomes_, [&](const auto& entry) { return identities.contains(entry.first.first); });
}

void Journal::forget(const std::set<std::string>& identities) {
    const auto before = outcomes_.size();
    erase(identities);
    if (outcomes_.empty())
        clear();
    else if (outcomes_.size() < before)
        write_line(json{{"forgotten", identities}}.dump());
}

void Journal::append(const Key& key, const Outcome& outcome) {
    write_line(json{{"identity", key.first}, {"round", key.second}, {"outcome", to_json(outcome)}}.dump());
    outcomes_[key] = outcome;
}

}  // namespace hausbench
