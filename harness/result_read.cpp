#include "error.h"
#include "hdf5.h"
#include "result_columns.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <new>
#include <stdexcept>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

// Reads columns of one group and checks that they are equally long.
class Reading {
public:
    Reading(const h5::File& file, std::string group, std::size_t rows)
        : file_(file), group_(std::move(group)), rows_(rows) {}

    std::vector<std::string> texts(const std::string& name) const {
        return checked(name, file_.read_texts(path(name)), 1);
    }
    std::vector<double> reals(const std::string& name, std::size_t width = 1) const {
        return checked(name, file_.read_doubles(path(name)), width);
    }
    std::vector<std::int64_t> integers(const std::string& name) const {
        return checked(name, file_.read_integers(path(name)), 1);
    }
    // Of which only the values of a narrower type are legal.
    template <class T> std::vector<T> integers_as(const std::string& name) const {
        std::vector<T> values;
        for (const std::int64_t value : integers(name)) {
            if (!std::in_range<T>(value)) throw std::runtime_error(fmt::format("{} holds {}", path(name), value));
            values.push_back(static_cast<T>(value));
        }
        return values;
    }
    std::vector<std::uint64_t> counts(const std::string& name) const {
        return checked(name, file_.read_unsigned(path(name)), 1);
    }

private:
    std::string path(const std::string& name) const { return group_ + "/" + name; }
    template <class T> std::vector<T> checked(const std::string& name, std::vector<T> column, std::size_t width) const {
        if (column.size() != rows_ * width) {
            throw std::runtime_error(
                fmt::format("{} has {} values where {} are due", path(name), column.size(), rows_ * width));
        }
        return column;
    }

    const h5::File& file_;
    std::string group_;
    std::size_t rows_;
};

Vec3 vector_at(const std::vector<double>& column, std::size_t i) {
    return {column[3 * i], column[3 * i + 1], column[3 * i + 2]};
}

Verdict verdict_of(const std::string& text) {
    for (Verdict v : {Verdict::holds, Verdict::unsound, Verdict::no_witness, Verdict::not_checked}) {
        if (text == to_string(v)) return v;
    }
    throw std::runtime_error(fmt::format("'{}' is not what a check says", text));
}

std::string status_of(const std::string& text) {
    for (const char* known :
         {"ok", "timeout", "out_of_memory", "signal", "skipped", "failed", "unsound", "not_built", "floor", "budget"}) {
        if (text == known) return text;
    }
    throw std::runtime_error(fmt::format("'{}' is no status of a case", text));
}

ParameterMap options_of(const std::string& text) {
    ParameterMap options;
    const auto object = nlohmann::json::parse(text);  // outlives its items()
    for (const auto& [name, value] : object.items()) options[name] = parameter_of(value);
    return options;
}

std::vector<Row> read_cases(const h5::File& file) {
    const std::size_t n = file.read_texts("cases/identity").size();
    const Reading c(file, "cases", n);
    std::vector<Row> rows(n);
    const auto each = [&](const auto& column, auto set) {
        for (std::size_t i = 0; i < n; ++i) set(rows[i], column[i]);
    };
    using Text = const std::string&;
    each(c.texts("identity"), [](Row& r, Text v) { r.asked.identity = v; });
    each(c.texts("solver"), [](Row& r, Text v) { r.asked.solver = v; });
    each(c.texts("label"), [](Row& r, Text v) { r.asked.label = v; });
    each(c.integers_as<int>("certified"), [](Row& r, int v) { r.asked.certified = v; });
    each(c.texts("options"), [](Row& r, Text v) { r.asked.options = options_of(v); });
    each(c.texts("scene"), [](Row& r, Text v) { r.asked.scene = v; });
    each(c.texts("scene_note"), [](Row& r, Text v) { r.asked.note = v; });
    each(c.reals("exact"), [](Row& r, double v) { r.asked.exact = v; });
    each(c.texts("source"), [](Row& r, Text v) { r.asked.source = v; });
    each(c.texts("target"), [](Row& r, Text v) { r.asked.target = v; });
    each(c.integers("source_elements"), [](Row& r, auto v) { r.asked.source_elements = v; });
    each(c.integers("target_elements"), [](Row& r, auto v) { r.asked.target_elements = v; });
    each(c.reals("source_diagonal"), [](Row& r, double v) { r.asked.source_diagonal = v; });
    each(c.integers_as<int>("pose_index"), [](Row& r, int v) { r.asked.pose_index = v; });
    const auto poses = c.reals("pose", 12);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < 9; ++k)
            rows[i].asked.pose.rotation(Eigen::Index(k / 3), Eigen::Index(k % 3)) = poses[12 * i + k];
        for (std::size_t k = 0; k < 3; ++k) rows[i].asked.pose.translation[Eigen::Index(k)] = poses[12 * i + 9 + k];
    }
    each(c.reals("tolerance"), [](Row& r, double v) { r.asked.tolerance = v; });
    each(c.texts("tolerance_of"), [](Row& r, Text v) { r.asked.tolerance_of = v; });
    each(c.reals("case_seconds_limit"), [](Row& r, double v) { r.asked.limits.case_seconds = v; });
    each(c.reals("prepare_seconds_limit"), [](Row& r, double v) { r.asked.limits.prepare_seconds = v; });
    each(c.integers("memory_limit_bytes"), [](Row& r, auto v) { r.asked.limits.memory_bytes = v; });
    each(c.texts("status"), [](Row& r, Text v) { r.outcome.status = status_of(v); });
    each(c.texts("reason"), [](Row& r, Text v) { r.outcome.reason = v; });
    each(c.texts("solver_status"), [](Row& r, Text v) { r.outcome.solver_status = v; });
    each(c.reals("lower"), [](Row& r, double v) { r.outcome.bounds.lower = v; });
    each(c.reals("upper"), [](Row& r, double v) { r.outcome.bounds.upper = v; });
    const auto on_source = c.reals("witness_source", 3), on_target = c.reals("witness_target", 3);
    const auto source_element = c.integers_as<Index>("witness_source_element"),
               target_element = c.integers_as<Index>("witness_target_element");
    for (std::size_t i = 0; i < n; ++i)
        rows[i].outcome.witness = {vector_at(on_source, i), vector_at(on_target, i), source_element[i],
                                   target_element[i]};
    each(c.reals("prepare_seconds"), [](Row& r, double v) { r.outcome.prepare_seconds = v; });
    each(c.integers("prepare_bytes"), [](Row& r, auto v) { r.outcome.prepare_bytes = v; });
    each(c.reals("solve_seconds"), [](Row& r, double v) { r.outcome.solve_seconds = v; });
    each(c.reals("reported_seconds"), [](Row& r, double v) { r.outcome.reported_seconds = v; });
    each(c.integers("peak_bytes"), [](Row& r, auto v) { r.outcome.peak_bytes = v; });
    each(c.texts("clock"), [](Row& r, Text v) { r.outcome.clock = v; });
    each(c.integers("from_trace"), [](Row& r, auto v) { r.outcome.from_trace = v != 0; });
    each(c.texts("lower_check"), [](Row& r, Text v) { r.check.lower = verdict_of(v); });
    each(c.texts("extras"), [](Row& r, Text v) { r.outcome.extras = extras_of(nlohmann::json::parse(v)); });
    each(c.texts("facts"), [](Row& r, Text v) { r.outcome.facts = nlohmann::json::parse(v).get<Facts>(); });
    each(c.texts("upper_check"), [](Row& r, Text v) { r.check.upper = verdict_of(v); });
    each(c.texts("build"), [](Row& r, Text v) { r.outcome.build = v; });
    each(c.texts("machine"), [](Row& r, Text v) { r.outcome.machine = v; });
    for (const CounterField& field : counter_fields) {
        each(c.counts(fmt::format("counter_{}", field.name)),
             [&](Row& r, auto v) { r.outcome.counters.*field.member = v; });
    }
    return rows;
}

void read_details(const h5::File& file, std::vector<Row>& rows) {
    const auto row = [&](std::int64_t i) -> Outcome& {
        if (i < 0 || std::size_t(i) >= rows.size()) throw std::runtime_error("a detail belongs to no case");
        return rows[std::size_t(i)].outcome;
    };
    const auto answer_of = file.read_integers("answers/case");
    const Reading a(file, "answers", answer_of.size());
    const auto answer_rounds = a.integers_as<int>("round");
    const auto answer_wall = a.reals("wall_seconds"), answer_cpu = a.reals("cpu_seconds");
    for (std::size_t i = 0; i < answer_of.size(); ++i)
        row(answer_of[i]).answers.push_back({answer_rounds[i], answer_wall[i], answer_cpu[i]});

    const auto of = file.read_integers("repeats/case");
    const Reading r(file, "repeats", of.size());
    const auto rounds = r.integers_as<int>("round");
    const auto iterations = r.integers("iterations");
    const auto wall = r.reals("wall_seconds"), cpu = r.reals("cpu_seconds");
    for (std::size_t i = 0; i < of.size(); ++i)
        row(of[i]).repeats.push_back({rounds[i], wall[i], cpu[i], iterations[i]});

    const auto part_of = file.read_integers("preparation/case");
    const Reading p(file, "preparation", part_of.size());
    const auto names = p.texts("name");
    const auto seconds = p.reals("seconds");
    const auto bytes = p.integers_as<std::size_t>("bytes");
    const auto part_rounds = p.integers_as<int>("round");
    for (std::size_t i = 0; i < part_of.size(); ++i)
        row(part_of[i]).preparation.push_back({part_rounds[i], names[i], seconds[i], std::int64_t(bytes[i])});

    const auto at = file.read_doubles("trace/seconds");
    const Reading t(file, "trace", at.size()), c(file, "cases", rows.size());
    const auto lower = t.reals("lower"), upper = t.reals("upper");
    const auto begins = c.integers("trace_begin"), ends = c.integers("trace_end");
    std::int64_t used = 0;  // traces stand one after the other; where they overlap, a small file could fill the memory
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (begins[i] >= ends[i]) continue;
        if (begins[i] < used) throw std::runtime_error("two cases share samples of a trace");
        if (std::size_t(ends[i]) > at.size()) throw std::runtime_error("a trace reaches past the samples");
        used = ends[i];
        for (auto s = std::size_t(begins[i]); s < std::size_t(ends[i]); ++s)
            rows[i].outcome.trace.push_back({at[s], lower[s], upper[s]});
    }
}

std::vector<ModelRecord> read_models(const h5::File& file) {
    const std::size_t n = file.read_texts("models/name").size();
    const Reading c(file, "models", n);
    std::vector<ModelRecord> models(n);
    for (const auto& [name, member] : model_texts) {
        const auto column = c.texts(name);
        for (std::size_t i = 0; i < n; ++i) models[i].*member = column[i];
    }
    for (const auto& [name, member] : model_integers) {
        const auto column = c.integers(name);
        for (std::size_t i = 0; i < n; ++i) models[i].*member = column[i];
    }
    const auto diagonals = c.reals("diagonal");
    const auto boxes = c.reals("box", 6);
    for (std::size_t i = 0; i < n; ++i) {
        models[i].diagonal = diagonals[i];
        for (std::size_t k = 0; k < 6; ++k) models[i].box[k] = boxes[6 * i + k];
    }
    return models;
}

std::vector<LedgerEntry> read_ledger(const h5::File& file) {
    const std::size_t n = file.read_texts("ledger/kind").size();
    const Reading c(file, "ledger", n);
    const auto kind = c.texts("kind"), subject = c.texts("subject"), what = c.texts("what"), reason = c.texts("reason");
    const auto count = c.integers("count");
    const auto saved = c.reals("seconds_saved");
    std::vector<LedgerEntry> ledger;
    for (std::size_t i = 0; i < n; ++i) ledger.push_back({kind[i], subject[i], what[i], reason[i], count[i], saved[i]});
    return ledger;
}

constexpr const char* meta_texts[] = {"stem",     "title",    "paper",      "profile",   "experiment_toml",
                                      "started",  "finished", "commit",     "dirty",     "build",
                                      "compiler", "flags",    "build_type", "libraries", "machine",
                                      "cpu",      "caches",   "kernel",     "system",    "hausbench_version"};
constexpr const char* meta_integers[] = {"cores", "memory_bytes"};

ResultFile read_trusting(const fs::path& file) {
    const h5::File in(file, h5::Open::read);
    if (!in.has("meta") || !in.has_attribute("meta", "schema_version")) {
        throw InputError(
            fmt::format("{}: is not a result of hausbench: name a file that `hausbench run` wrote", file.string()));
    }
    if (const auto schema = in.integer_attribute("meta", "schema_version"); schema != result_schema) {
        throw InputError(
            fmt::format("{}: has schema version {}, this program reads {}: {}", file.string(), schema, result_schema,
                        schema > result_schema ? "use a newer hausbench" : "run its experiment again with --fresh"));
    }
    ResultFile result;
    for (const char* name : meta_texts) result.texts[name] = in.text_attribute("meta", name);
    for (const char* name : meta_integers) result.integers[name] = in.integer_attribute("meta", name);
    result.models = read_models(in);
    result.rows = read_cases(in);
    read_details(in, result.rows);
    result.ledger = read_ledger(in);
    for (Row& row : result.rows) {
        for (const ModelRecord& model : result.models) {
            if (model.name == row.asked.source) row.asked.source_hash = model.sha256;
            if (model.name == row.asked.target) row.asked.target_hash = model.sha256;
        }
    }
    return result;
}

std::int64_t address_space() {
    std::int64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * ::sysconf(_SC_PAGE_SIZE);
}

// The library crashes on some damaged files, and a file without a seal, changed by another program, may be one. So a copy of
// this process reads the file first, within limits of time and memory; this process reads it only where the copy survives.
void read_in_a_copy(const fs::path& file) {
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
    if (child == 0) {
        const auto most = rlim_t(address_space()) + (rlim_t(4) << 30) +
                          16 * rlim_t(fs::file_size(file));  // a damaged count asks for more
        const auto enough =
            rlim_t(5 + fs::file_size(file) / 1'000'000);  // s; it reads 100 MB/s, and loops for ever on some files
        const rlimit nothing{0, 0}, seconds{enough, enough + 1}, memory{most, most};
        const int silent = ::open("/dev/null", O_WRONLY);
        ::dup2(silent, STDERR_FILENO);  // the last words of an abort
        ::setrlimit(RLIMIT_CORE, &nothing);
        ::setrlimit(RLIMIT_CPU, &seconds);
        ::setrlimit(RLIMIT_AS, &memory);
        for (int number : {SIGINT, SIGTERM}) std::signal(number, SIG_DFL);
        try {
            read_trusting(file);
        } catch (const std::bad_alloc&) {
            ::_exit(4);
        } catch (const std::length_error&) {
            ::_exit(4);
        } catch (...) {  // said again by the one who reads next
        }
        ::_exit(0);
    }
    int status = 0;
    while (::waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) throw std::runtime_error(std::string("waitpid: ") + std::strerror(errno));
    }
    if (WIFSIGNALED(status))
        throw std::runtime_error(
            fmt::format("reading it ends with signal {}, {}", WTERMSIG(status), ::strsignal(WTERMSIG(status))));
    if (WEXITSTATUS(status) != 0) throw std::runtime_error("it asks for more memory than its size accounts for");
}

// Untrusted text: control characters, and all that is not ASCII, become question marks.
std::string printable(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
    return text;
}

}  // namespace

ResultFile read_result(const fs::path& file) {
    if (fs::is_directory(file))
        throw InputError(fmt::format("{}: is a folder: name a result file (.h5)", file.string()));
    if (!fs::exists(file)) throw InputError(fmt::format("{}: does not exist: run its experiment first", file.string()));
    try {
        h5::check_seal(file);
        read_in_a_copy(file);
        return read_trusting(file);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        std::string why = error.what();
        if (why.starts_with(file.string() + ": ")) why.erase(0, file.string().size() + 2);
        throw InputError(
            fmt::format("{}: damaged, or not a result of hausbench ({}): write it again by running its experiment",
                        file.string(), printable(why)));
    }
}

}  // namespace hausbench
