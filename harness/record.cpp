#include "record.h"

#include "hash.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace hausbench {

using nlohmann::json;

json number(double value) {
    if (std::isfinite(value)) return value;
    return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

double number(const json& value) {
    if (value.is_number()) return value.get<double>();
    const auto text = value.get<std::string>();
    if (text == "inf") return std::numeric_limits<double>::infinity();
    if (text == "-inf") return -std::numeric_limits<double>::infinity();
    return std::numeric_limits<double>::quiet_NaN();
}

namespace {

json vector_json(const Vec3& v) { return {number(v[0]), number(v[1]), number(v[2])}; }

Vec3 vector_of(const json& j) { return {number(j.at(0)), number(j.at(1)), number(j.at(2))}; }

}  // namespace

Tolerance Case::resolved_tolerance() const {
    if (tolerance_of == "lower") return {Tolerance::Of::lower, tolerance};
    return {Tolerance::Of::absolute, tolerance_of == "diagonal" ? tolerance * source_diagonal : tolerance};
}

json options_json(const ParameterMap& options) {
    json out = json::object();
    for (const auto& [name, value] : options) {
        json& field = out[name];
        std::visit([&](const auto& v) { field = v; }, value);
    }
    return out;
}

ParameterValue parameter_of(const json& value) {
    if (value.is_boolean()) return value.get<bool>();
    if (value.is_number_integer()) return value.get<std::int64_t>();
    if (value.is_number()) return value.get<double>();
    return value.get<std::string>();
}

std::string identify(const Case& asked) {
    Sha256 hash;
    hash.add("case 1")
        .add(asked.source_hash)
        .add(asked.target_hash)
        .add(asked.solver)
        .add(options_json(asked.options).dump());
    // A model that is missing has no bytes: its name stands in, so that such cases still differ.
    if (asked.source_hash.empty()) hash.add(asked.source);
    if (asked.target_hash.empty()) hash.add(asked.target);
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) hash.add(&asked.pose.rotation(i, k), sizeof(double));
    }
    hash.add(asked.pose.translation.data(), 3 * sizeof(double));
    hash.add(asked.tolerance_of).add(&asked.tolerance, sizeof asked.tolerance);
    hash.add(&asked.limits.case_seconds, sizeof(double)).add(&asked.limits.prepare_seconds, sizeof(double));
    hash.add(&asked.limits.memory_bytes, sizeof(std::int64_t));
    return hash.hex();
}

std::string name_of(const Case& c) {
    return fmt::format("{} on {}, pose {}, tolerance {:g} of {}", c.label, c.scene, c.pose_index, c.tolerance,
                       c.tolerance_of);
}

std::string row_status(Status status) {
    switch (status) {
        case Status::converged:
        case Status::cutoff_passed:
            return "ok";
        case Status::time_limit:
            return "timeout";
        case Status::budget:
            return "budget";
        case Status::precision_floor:
            return "floor";
        case Status::stalled:
            return "failed";
    }
    throw std::logic_error("row_status: not a status");
}

std::string_view to_string(Verdict verdict) {
    constexpr std::string_view names[] = {"holds", "unsound", "no witness", "not checked"};
    return names[std::size_t(verdict)];
}

json extras_json(const std::map<std::string, double>& extras) {
    json object = json::object();
    for (const auto& [name, value] : extras) object[name] = number(value);
    return object;
}

std::map<std::string, double> extras_of(const json& object) {
    std::map<std::string, double> extras;
    for (const auto& [name, value] : object.items()) extras[name] = number(value);
    return extras;
}

json to_json(const Outcome& o) {
    json counters = json::object();
    for (const CounterField& field : counter_fields) counters[std::string(field.name)] = o.counters.*field.member;
    json preparation = json::array(), answers = json::array(), repeats = json::array(), trace = json::array();
    for (const auto& p : o.preparation) preparation.push_back({p.round, p.name, number(p.seconds), p.bytes});
    for (const auto& a : o.answers) answers.push_back({a.round, number(a.wall_seconds), number(a.cpu_seconds)});
    for (const auto& r : o.repeats)
        repeats.push_back({r.round, number(r.wall_seconds), number(r.cpu_seconds), r.iterations});
    for (const auto& s : o.trace) trace.push_back({number(s.seconds), number(s.lower), number(s.upper)});
    return {{"status", o.status},
            {"reason", o.reason},
            {"solver_status", o.solver_status},
            {"lower", number(o.bounds.lower)},
            {"upper", number(o.bounds.upper)},
            {"witness",
             {vector_json(o.witness.source_point), vector_json(o.witness.target_point), o.witness.source_element,
              o.witness.target_element}},
            {"counters", counters},
            {"extras", extras_json(o.extras)},
            {"facts", o.facts},
            {"prepare_seconds", number(o.prepare_seconds)},
            {"prepare_bytes", o.prepare_bytes},
            {"solve_seconds", number(o.solve_seconds)},
            {"reported_seconds", number(o.reported_seconds)},
            {"peak_bytes", o.peak_bytes},
            {"clock", o.clock},
            {"preparation", preparation},
            {"answers", answers},
            {"repeats", repeats},
            {"repeats_asked", o.repeats_asked},
            {"trace", trace},
            {"from_trace", o.from_trace},
            {"build", o.build},
            {"machine", o.machine}};
}

Outcome outcome_from_json(const json& j) {
    Outcome o;
    o.status = j.at("status");
    o.reason = j.at("reason");
    o.solver_status = j.at("solver_status");
    o.bounds = {number(j.at("lower")), number(j.at("upper"))};
    const json& w = j.at("witness");
    o.witness = {vector_of(w.at(0)), vector_of(w.at(1)), w.at(2), w.at(3)};
    for (const CounterField& field : counter_fields)
        o.counters.*field.member = j.at("counters").at(std::string(field.name));
    o.extras = extras_of(j.at("extras"));
    o.facts = j.at("facts").get<Facts>();
    o.prepare_seconds = number(j.at("prepare_seconds"));
    o.prepare_bytes = j.at("prepare_bytes");
    o.solve_seconds = number(j.at("solve_seconds"));
    o.reported_seconds = number(j.at("reported_seconds"));
    o.peak_bytes = j.at("peak_bytes");
    o.clock = j.at("clock");
    for (const json& p : j.at("preparation")) o.preparation.push_back({p.at(0), p.at(1), number(p.at(2)), p.at(3)});
    for (const json& a : j.at("answers")) o.answers.push_back({a.at(0), number(a.at(1)), number(a.at(2))});
    for (const json& r : j.at("repeats")) o.repeats.push_back({r.at(0), number(r.at(1)), number(r.at(2)), r.at(3)});
    o.repeats_asked = j.at("repeats_asked");
    for (const json& s : j.at("trace")) o.trace.push_back({number(s.at(0)), number(s.at(1)), number(s.at(2))});
    o.from_trace = j.at("from_trace");
    o.build = j.at("build");
    o.machine = j.at("machine");
    return o;
}

}  // namespace hausbench
