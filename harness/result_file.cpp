#include "result_file.h"

#include "error.h"
#include "hdf5.h"
#include "machine.h"
#include "surface_file.h"
#include "verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

constexpr std::pair<const char*, std::string ModelRecord::*> model_texts[] = {
    {"name", &ModelRecord::name},     {"sha256", &ModelRecord::sha256},   {"kind", &ModelRecord::kind}, {"precision", &ModelRecord::precision},
    {"source", &ModelRecord::source}, {"licence", &ModelRecord::licence}, {"note", &ModelRecord::note}};
constexpr std::pair<const char*, std::int64_t ModelRecord::*> model_integers[] = {
    {"elements", &ModelRecord::elements}, {"vertices", &ModelRecord::vertices}, {"unreferenced", &ModelRecord::unreferenced}};

// One column a call: what `value` says of each row.
class Columns {
public:
    Columns(h5::File& file, std::string group, const std::vector<Row>& rows) : file_(file), group_(std::move(group)), rows_(rows) {}

    template <class F> void text(const std::string& name, F value) const {
        std::vector<std::string> column;
        for (const Row& row : rows_) column.push_back(value(row));
        file_.write(group_ + "/" + name, column);
    }
    template <class F> void real(const std::string& name, F value, std::size_t width = 1) const {
        std::vector<double> column;
        for (const Row& row : rows_) {
            if constexpr (std::is_arithmetic_v<decltype(value(row))>) column.push_back(value(row));
            else for (double v : value(row)) column.push_back(v);
        }
        file_.write(group_ + "/" + name, column, width);
    }
    template <class F> void integer(const std::string& name, F value) const {
        std::vector<std::int64_t> column;
        for (const Row& row : rows_) column.push_back(std::int64_t(value(row)));
        file_.write(group_ + "/" + name, column);
    }

private:
    h5::File& file_;
    std::string group_;
    const std::vector<Row>& rows_;
};

std::vector<double> flat(const Vec3& v) { return {v[0], v[1], v[2]}; }

std::vector<double> flat(const Pose& pose) {
    std::vector<double> out;
    for (int i = 0; i < 9; ++i) out.push_back(pose.rotation(i / 3, i % 3));
    for (int i = 0; i < 3; ++i) out.push_back(pose.translation[i]);
    return out;
}

void write_cases(h5::File& file, const std::vector<Row>& rows) {
    const Columns c(file, "cases", rows);
    c.text("identity", [](const Row& r) { return r.asked.identity; });
    c.text("solver", [](const Row& r) { return r.asked.solver; });
    c.text("label", [](const Row& r) { return r.asked.label; });
    c.integer("certified", [](const Row& r) { return r.asked.certified; });
    c.text("options", [](const Row& r) { return options_json(r.asked.options).dump(); });
    c.text("scene", [](const Row& r) { return r.asked.scene; });
    c.text("scene_note", [](const Row& r) { return r.asked.note; });
    c.text("source", [](const Row& r) { return r.asked.source; });
    c.text("target", [](const Row& r) { return r.asked.target; });
    c.integer("source_elements", [](const Row& r) { return r.asked.source_elements; });
    c.integer("target_elements", [](const Row& r) { return r.asked.target_elements; });
    c.real("source_diagonal", [](const Row& r) { return r.asked.source_diagonal; });
    c.integer("pose_index", [](const Row& r) { return r.asked.pose_index; });
    c.real("pose", [](const Row& r) { return flat(r.asked.pose); }, 12);
    c.real("tolerance", [](const Row& r) { return r.asked.tolerance; });
    c.text("tolerance_of", [](const Row& r) { return r.asked.tolerance_of; });
    c.real("tolerance_absolute", [](const Row& r) {
        const Tolerance t = r.asked.resolved_tolerance();
        return t.of == Tolerance::Of::absolute ? t.value : std::numeric_limits<double>::quiet_NaN();
    });
    c.real("case_seconds_limit", [](const Row& r) { return r.asked.limits.case_seconds; });
    c.real("prepare_seconds_limit", [](const Row& r) { return r.asked.limits.prepare_seconds; });
    c.integer("memory_limit_bytes", [](const Row& r) { return r.asked.limits.memory_bytes; });
    c.text("status", [](const Row& r) { return r.outcome.status; });
    c.text("reason", [](const Row& r) { return r.outcome.reason; });
    c.text("solver_status", [](const Row& r) { return r.outcome.solver_status; });
    c.real("lower", [](const Row& r) { return r.outcome.bounds.lower; });
    c.real("upper", [](const Row& r) { return r.outcome.bounds.upper; });
    c.real("witness_source", [](const Row& r) { return flat(r.outcome.witness.source_point); }, 3);
    c.real("witness_target", [](const Row& r) { return flat(r.outcome.witness.target_point); }, 3);
    c.integer("witness_source_element", [](const Row& r) { return r.outcome.witness.source_element; });
    c.integer("witness_target_element", [](const Row& r) { return r.outcome.witness.target_element; });
    c.real("prepare_seconds", [](const Row& r) { return r.outcome.prepare_seconds; });
    c.integer("prepare_bytes", [](const Row& r) { return r.outcome.prepare_bytes; });
    c.real("solve_seconds", [](const Row& r) { return r.outcome.solve_seconds; });
    c.real("reported_seconds", [](const Row& r) { return r.outcome.reported_seconds; });
    c.integer("peak_bytes", [](const Row& r) { return r.outcome.peak_bytes; });
    c.integer("from_trace", [](const Row& r) { return r.outcome.from_trace; });
    c.text("lower_check", [](const Row& r) { return std::string(to_string(r.check.lower)); });
    c.text("extras", [](const Row& r) { return extras_json(r.outcome.extras).dump(); });
    c.text("upper_check", [](const Row& r) { return std::string(to_string(r.check.upper)); });
    c.text("build", [](const Row& r) { return r.outcome.build; });
    c.text("machine", [](const Row& r) { return r.outcome.machine; });
    for (const CounterField& field : counter_fields) {
        std::vector<std::uint64_t> column;
        for (const Row& row : rows) column.push_back(row.outcome.counters.*field.member);
        file.write(fmt::format("cases/counter_{}", field.name), column);
    }
}

// The tables with several rows a case, each with the number of its case.
void write_details(h5::File& file, const std::vector<Row>& rows) {
    std::vector<std::int64_t> repeat_case, repeat_number, round, iterations, part_case, part_bytes, begins, ends;
    std::vector<double> wall, cpu, part_seconds, trace_seconds, trace_lower, trace_upper;
    std::vector<std::string> part_name;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Outcome& o = rows[i].outcome;
        std::int64_t number = 0;
        for (const Repeat& r : o.repeats) {
            repeat_case.push_back(std::int64_t(i));
            repeat_number.push_back(number++);
            round.push_back(r.round);
            wall.push_back(r.wall_seconds);
            cpu.push_back(r.cpu_seconds);
            iterations.push_back(r.iterations);
        }
        for (const PreparationTime& p : o.preparation) {
            part_case.push_back(std::int64_t(i));
            part_name.push_back(p.name);
            part_seconds.push_back(p.seconds);
            part_bytes.push_back(std::int64_t(p.bytes));
        }
        begins.push_back(std::int64_t(trace_seconds.size()));
        for (const TraceSample& s : o.trace) {
            trace_seconds.push_back(s.seconds);
            trace_lower.push_back(s.lower);
            trace_upper.push_back(s.upper);
        }
        ends.push_back(std::int64_t(trace_seconds.size()));
    }
    file.write("cases/trace_begin", begins);
    file.write("cases/trace_end", ends);
    file.write("repeats/case", repeat_case);
    file.write("repeats/repeat", repeat_number);
    file.write("repeats/round", round);
    file.write("repeats/wall_seconds", wall);
    file.write("repeats/cpu_seconds", cpu);
    file.write("repeats/iterations", iterations);
    file.write("preparation/case", part_case);
    file.write("preparation/name", part_name);
    file.write("preparation/seconds", part_seconds);
    file.write("preparation/bytes", part_bytes);
    file.write("trace/seconds", trace_seconds);
    file.write("trace/lower", trace_lower);
    file.write("trace/upper", trace_upper);
}

void write_models(h5::File& file, const std::vector<ModelRecord>& models) {
    const auto texts = [&](const char* name, std::string ModelRecord::*member) {
        std::vector<std::string> column;
        for (const ModelRecord& model : models) column.push_back(model.*member);
        file.write(fmt::format("models/{}", name), column);
    };
    for (const auto& [name, member] : model_texts) texts(name, member);
    for (const auto& [name, member] : model_integers) {
        std::vector<std::int64_t> column;
        for (const ModelRecord& model : models) column.push_back(model.*member);
        file.write(fmt::format("models/{}", name), column);
    }
    std::vector<double> diagonals;
    for (const ModelRecord& model : models) diagonals.push_back(model.diagonal);
    file.write("models/diagonal", diagonals);
}

void write_ledger(h5::File& file, const std::vector<LedgerEntry>& ledger) {
    std::vector<std::string> kind, subject, what, reason;
    std::vector<std::int64_t> count;
    std::vector<double> saved;
    for (const LedgerEntry& entry : ledger) {
        kind.push_back(entry.kind);
        subject.push_back(entry.subject);
        what.push_back(entry.what);
        reason.push_back(entry.reason);
        count.push_back(entry.count);
        saved.push_back(entry.seconds_saved);
    }
    file.write("ledger/kind", kind);
    file.write("ledger/subject", subject);
    file.write("ledger/what", what);
    file.write("ledger/reason", reason);
    file.write("ledger/count", count);
    file.write("ledger/seconds_saved", saved);
}

// Reads columns of one group and checks that they are equally long.
class Reading {
public:
    Reading(const h5::File& file, std::string group, std::size_t rows) : file_(file), group_(std::move(group)), rows_(rows) {}

    std::vector<std::string> texts(const std::string& name) const { return checked(name, file_.read_texts(path(name)), 1); }
    std::vector<double> reals(const std::string& name, std::size_t width = 1) const { return checked(name, file_.read_doubles(path(name)), width); }
    std::vector<std::int64_t> integers(const std::string& name) const { return checked(name, file_.read_integers(path(name)), 1); }
    std::vector<std::uint64_t> counts(const std::string& name) const { return checked(name, file_.read_unsigned(path(name)), 1); }

private:
    std::string path(const std::string& name) const { return group_ + "/" + name; }
    template <class T> std::vector<T> checked(const std::string& name, std::vector<T> column, std::size_t width) const {
        if (column.size() != rows_ * width) {
            throw std::runtime_error(fmt::format("{} has {} values where {} are due", path(name), column.size(), rows_ * width));
        }
        return column;
    }

    const h5::File& file_;
    std::string group_;
    std::size_t rows_;
};

Vec3 vector_at(const std::vector<double>& column, std::size_t i) { return {column[3 * i], column[3 * i + 1], column[3 * i + 2]}; }

Verdict verdict_of(const std::string& text) {
    for (Verdict v : {Verdict::holds, Verdict::unsound, Verdict::no_witness, Verdict::not_checked}) {
        if (text == to_string(v)) return v;
    }
    throw std::runtime_error(fmt::format("'{}' is not what a check says", text));
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
    each(c.integers("certified"), [](Row& r, auto v) { r.asked.certified = int(v); });
    each(c.texts("options"), [](Row& r, Text v) { r.asked.options = options_of(v); });
    each(c.texts("scene"), [](Row& r, Text v) { r.asked.scene = v; });
    each(c.texts("scene_note"), [](Row& r, Text v) { r.asked.note = v; });
    each(c.texts("source"), [](Row& r, Text v) { r.asked.source = v; });
    each(c.texts("target"), [](Row& r, Text v) { r.asked.target = v; });
    each(c.integers("source_elements"), [](Row& r, auto v) { r.asked.source_elements = v; });
    each(c.integers("target_elements"), [](Row& r, auto v) { r.asked.target_elements = v; });
    each(c.reals("source_diagonal"), [](Row& r, double v) { r.asked.source_diagonal = v; });
    each(c.integers("pose_index"), [](Row& r, auto v) { r.asked.pose_index = int(v); });
    const auto poses = c.reals("pose", 12);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < 9; ++k) rows[i].asked.pose.rotation(Eigen::Index(k / 3), Eigen::Index(k % 3)) = poses[12 * i + k];
        for (std::size_t k = 0; k < 3; ++k) rows[i].asked.pose.translation[Eigen::Index(k)] = poses[12 * i + 9 + k];
    }
    each(c.reals("tolerance"), [](Row& r, double v) { r.asked.tolerance = v; });
    each(c.texts("tolerance_of"), [](Row& r, Text v) { r.asked.tolerance_of = v; });
    each(c.reals("case_seconds_limit"), [](Row& r, double v) { r.asked.limits.case_seconds = v; });
    each(c.reals("prepare_seconds_limit"), [](Row& r, double v) { r.asked.limits.prepare_seconds = v; });
    each(c.integers("memory_limit_bytes"), [](Row& r, auto v) { r.asked.limits.memory_bytes = v; });
    each(c.texts("status"), [](Row& r, Text v) { r.outcome.status = v; });
    each(c.texts("reason"), [](Row& r, Text v) { r.outcome.reason = v; });
    each(c.texts("solver_status"), [](Row& r, Text v) { r.outcome.solver_status = v; });
    each(c.reals("lower"), [](Row& r, double v) { r.outcome.bounds.lower = v; });
    each(c.reals("upper"), [](Row& r, double v) { r.outcome.bounds.upper = v; });
    const auto on_source = c.reals("witness_source", 3), on_target = c.reals("witness_target", 3);
    const auto source_element = c.integers("witness_source_element"), target_element = c.integers("witness_target_element");
    for (std::size_t i = 0; i < n; ++i) {
        rows[i].outcome.witness = {vector_at(on_source, i), vector_at(on_target, i), Index(source_element[i]), Index(target_element[i])};
    }
    each(c.reals("prepare_seconds"), [](Row& r, double v) { r.outcome.prepare_seconds = v; });
    each(c.integers("prepare_bytes"), [](Row& r, auto v) { r.outcome.prepare_bytes = v; });
    each(c.reals("solve_seconds"), [](Row& r, double v) { r.outcome.solve_seconds = v; });
    each(c.reals("reported_seconds"), [](Row& r, double v) { r.outcome.reported_seconds = v; });
    each(c.integers("peak_bytes"), [](Row& r, auto v) { r.outcome.peak_bytes = v; });
    each(c.integers("from_trace"), [](Row& r, auto v) { r.outcome.from_trace = v != 0; });
    each(c.texts("lower_check"), [](Row& r, Text v) { r.check.lower = verdict_of(v); });
    each(c.texts("extras"), [](Row& r, Text v) { r.outcome.extras = extras_of(nlohmann::json::parse(v)); });
    each(c.texts("upper_check"), [](Row& r, Text v) { r.check.upper = verdict_of(v); });
    each(c.texts("build"), [](Row& r, Text v) { r.outcome.build = v; });
    each(c.texts("machine"), [](Row& r, Text v) { r.outcome.machine = v; });
    for (const CounterField& field : counter_fields) {
        each(c.counts(fmt::format("counter_{}", field.name)), [&](Row& r, auto v) { r.outcome.counters.*field.member = v; });
    }
    return rows;
}

void read_details(const h5::File& file, std::vector<Row>& rows) {
    const auto row = [&](std::int64_t i) -> Outcome& {
        if (i < 0 || std::size_t(i) >= rows.size()) throw std::runtime_error("a detail belongs to no case");
        return rows[std::size_t(i)].outcome;
    };
    const auto of = file.read_integers("repeats/case");
    const Reading r(file, "repeats", of.size());
    const auto rounds = r.integers("round"), iterations = r.integers("iterations");
    const auto wall = r.reals("wall_seconds"), cpu = r.reals("cpu_seconds");
    for (std::size_t i = 0; i < of.size(); ++i) row(of[i]).repeats.push_back({int(rounds[i]), wall[i], cpu[i], iterations[i]});

    const auto part_of = file.read_integers("preparation/case");
    const Reading p(file, "preparation", part_of.size());
    const auto names = p.texts("name");
    const auto seconds = p.reals("seconds");
    const auto bytes = p.integers("bytes");
    for (std::size_t i = 0; i < part_of.size(); ++i) row(part_of[i]).preparation.push_back({names[i], seconds[i], std::size_t(bytes[i])});

    const auto at = file.read_doubles("trace/seconds");
    const Reading t(file, "trace", at.size()), c(file, "cases", rows.size());
    const auto lower = t.reals("lower"), upper = t.reals("upper");
    const auto begins = c.integers("trace_begin"), ends = c.integers("trace_end");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        for (std::int64_t k = begins[i]; k < ends[i]; ++k) {
            const auto s = std::size_t(k);
            if (k < 0 || s >= at.size()) throw std::runtime_error("a trace reaches past the samples");
            rows[i].outcome.trace.push_back({at[s], lower[s], upper[s]});
        }
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
    for (std::size_t i = 0; i < n; ++i) models[i].diagonal = diagonals[i];
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

constexpr const char* meta_texts[] = {"stem",     "title",     "paper",    "profile",    "experiment_toml", "started",           "finished",
                                      "commit",   "dirty",     "build",    "compiler",   "flags",           "build_type",        "libraries",
                                      "machine",  "cpu",       "caches",   "kernel",     "system",          "hausbench_version"};
constexpr const char* meta_integers[] = {"cores", "memory_bytes"};

}  // namespace

void describe_run(ResultFile& result, const Experiment& experiment, const std::string& started, const std::string& finished) {
    const Build& build = this_build();
    const Machine& machine = this_machine();
    result.texts = {{"stem", experiment.stem},
                    {"title", experiment.title},
                    {"paper", experiment.paper},
                    {"profile", experiment.profile},
                    {"experiment_toml", experiment.toml},
                    {"started", started},
                    {"finished", finished},
                    {"commit", build.commit},
                    {"dirty", build.dirty},
                    {"build", build.id},
                    {"compiler", build.compiler},
                    {"flags", build.flags},
                    {"build_type", build.type},
                    {"libraries", build.libraries},
                    {"hausbench_version", build.version},
                    {"machine", machine.id},
                    {"cpu", machine.cpu},
                    {"caches", machine.caches},
                    {"kernel", machine.kernel},
                    {"system", machine.system}};
    result.integers = {{"cores", machine.cores}, {"memory_bytes", machine.memory_bytes}};
}

namespace {

// The equation of a surface is what it is.
std::string note_of(const ModelInfo& model) {
    if (!model.surface) return model.note;
    return describe(*model.surface) + (model.note.empty() ? "" : "; " + model.note);
}

}  // namespace

ModelRecord record_of(const ModelRow& model) {
    const ResolvedModel& r = model.resolved;
    return {model.info->name, r.content_hash, std::string(to_string(r.kind)), r.report.precision, model.info->source, model.info->licence,
            note_of(*model.info), r.elements,     r.vertices,                     r.report.unreferenced.value_or(-1), r.diagonal};
}

void write_result(const fs::path& file, const ResultFile& result) {
    const fs::path unfinished = file.string() + ".unfinished";
    try {
        h5::File out(unfinished, h5::Open::create);
        out.attribute("meta", "schema_version", result_schema);
        for (const auto& [name, value] : result.texts) out.attribute("meta", name, value);
        for (const auto& [name, value] : result.integers) out.attribute("meta", name, value);
        write_models(out, result.models);
        write_cases(out, result.rows);
        write_details(out, result.rows);
        write_ledger(out, result.ledger);
        out.close();
        fs::rename(unfinished, file);
    } catch (const std::exception& error) {
        std::error_code ignored;
        fs::remove(unfinished, ignored);
        throw InputError(fmt::format("{}: cannot write the result: {}; nothing is lost: make room or choose another folder with "
                                     "--results, and run again", file.string(), error.what()));
    }
}

ResultFile read_result(const fs::path& file) {
    if (fs::is_directory(file)) throw InputError(fmt::format("{}: is a folder: name a result file (.h5)", file.string()));
    if (!fs::exists(file)) throw InputError(fmt::format("{}: does not exist: run its experiment first", file.string()));
    try {
        const h5::File in(file, h5::Open::read);
        if (!in.has("meta") || !in.has_attribute("meta", "schema_version")) {
            throw InputError(fmt::format("{}: is not a result of hausbench: name a file that `hausbench run` wrote", file.string()));
        }
        if (const auto schema = in.integer_attribute("meta", "schema_version"); schema > result_schema) {
            throw InputError(fmt::format("{}: has schema version {}, this program knows {}: use a newer hausbench", file.string(), schema, result_schema));
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
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(fmt::format("{}: damaged, or not a result of hausbench ({}): write it again by running its experiment", file.string(), error.what()));
    }
}

}  // namespace hausbench
