#include "error.h"
#include "hdf5.h"
#include "result_columns.h"

#include <fmt/format.h>

#include <limits>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

// One column a call: what `value` says of each row.
class Columns {
public:
    Columns(h5::File& file, std::string group, const std::vector<Row>& rows)
        : file_(file), group_(std::move(group)), rows_(rows) {}

    template <class F> void text(const std::string& name, F value) const {
        std::vector<std::string> column;
        for (const Row& row : rows_) column.push_back(value(row));
        file_.write(group_ + "/" + name, column);
    }
    template <class F> void real(const std::string& name, F value, std::size_t width = 1) const {
        std::vector<double> column;
        for (const Row& row : rows_) {
            if constexpr (std::is_arithmetic_v<decltype(value(row))>)
                column.push_back(value(row));
            else
                for (double v : value(row)) column.push_back(v);
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
    c.real("exact", [](const Row& r) { return r.asked.exact; });
    c.text("source", [](const Row& r) { return r.asked.source; });
    c.text("target", [](const Row& r) { return r.asked.target; });
    c.integer("source_elements", [](const Row& r) { return r.asked.source_elements; });
    c.integer("target_elements", [](const Row& r) { return r.asked.target_elements; });
    c.real("source_diagonal", [](const Row& r) { return r.asked.source_diagonal; });
    c.integer("pose_index", [](const Row& r) { return r.asked.pose_index; });
    c.real(
        "pose", [](const Row& r) { return flat(r.asked.pose); }, 12);
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
    c.real(
        "witness_source", [](const Row& r) { return flat(r.outcome.witness.source_point); }, 3);
    c.real(
        "witness_target", [](const Row& r) { return flat(r.outcome.witness.target_point); }, 3);
    c.integer("witness_source_element", [](const Row& r) { return r.outcome.witness.source_element; });
    c.integer("witness_target_element", [](const Row& r) { return r.outcome.witness.target_element; });
    c.real("prepare_seconds", [](const Row& r) { return r.outcome.prepare_seconds; });
    c.integer("prepare_bytes", [](const Row& r) { return r.outcome.prepare_bytes; });
    c.real("solve_seconds", [](const Row& r) { return r.outcome.solve_seconds; });
    c.real("reported_seconds", [](const Row& r) { return r.outcome.reported_seconds; });
    c.integer("peak_bytes", [](const Row& r) { return r.outcome.peak_bytes; });
    c.text("clock", [](const Row& r) { return r.outcome.clock; });
    c.integer("from_trace", [](const Row& r) { return r.outcome.from_trace; });
    c.text("lower_check", [](const Row& r) { return std::string(to_string(r.check.lower)); });
    c.text("extras", [](const Row& r) { return extras_json(r.outcome.extras).dump(); });
    c.text("facts", [](const Row& r) { return nlohmann::json(r.outcome.facts).dump(); });
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
    std::vector<std::int64_t> repeat_case, repeat_number, round, iterations, part_case, part_round, part_bytes, begins,
        ends;
    std::vector<std::int64_t> answer_case, answer_round;
    std::vector<double> answer_wall, answer_cpu;
    std::vector<double> wall, cpu, part_seconds, trace_seconds, trace_lower, trace_upper;
    std::vector<std::string> part_name;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Outcome& o = rows[i].outcome;
        for (const FirstAnswer& a : o.answers) {
            answer_case.push_back(std::int64_t(i));
            answer_round.push_back(a.round);
            answer_wall.push_back(a.wall_seconds);
            answer_cpu.push_back(a.cpu_seconds);
        }
        std::int64_t number = 0;
        for (const Repeat& r : o.repeats) {
            repeat_case.push_back(std::int64_t(i));
            repeat_number.push_back(number++);
            round.push_back(r.round);
            wall.push_back(r.wall_seconds);
            cpu.push_back(r.cpu_seconds);
            iterations.push_back(r.iterations);
        }
        for (const Preparation& p : o.preparation) {
            part_case.push_back(std::int64_t(i));
            part_round.push_back(p.round);
            part_name.push_back(p.name);
            part_seconds.push_back(p.seconds);
            part_bytes.push_back(p.bytes);
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
    file.write("answers/case", answer_case);
    file.write("answers/round", answer_round);
    file.write("answers/wall_seconds", answer_wall);
    file.write("answers/cpu_seconds", answer_cpu);
    file.write("repeats/case", repeat_case);
    file.write("repeats/repeat", repeat_number);
    file.write("repeats/round", round);
    file.write("repeats/wall_seconds", wall);
    file.write("repeats/cpu_seconds", cpu);
    file.write("repeats/iterations", iterations);
    file.write("preparation/case", part_case);
    file.write("preparation/round", part_round);
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
    std::vector<double> diagonals, boxes;
    for (const ModelRecord& model : models) {
        diagonals.push_back(model.diagonal);
        boxes.insert(boxes.end(), model.box.begin(), model.box.end());
    }
    file.write("models/diagonal", diagonals);
    file.write("models/box", boxes, 6);
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

}  // namespace

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
        throw InputError(
            fmt::format("{}: cannot write the result: {}; nothing is lost: make room, or choose another folder "
                        "(for `run` with --results), and start again",
                        file.string(), error.what()));
    }
}

}  // namespace hausbench
