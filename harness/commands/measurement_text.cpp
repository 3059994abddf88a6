// Formats the output of `measure`: one JSON object, or lines for a person.
#include "harness/commands/measurement.h"
#include "harness/commands/named_shape.h"
#include "harness/commands/row_texts.h"
#include "harness/record/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hausbench {

using nlohmann::json;

namespace {

json point_json(const Vec3& v) {
    if (!v.allFinite()) return nullptr;
    return {v[0], v[1], v[2]};
}

// Returns a bound over a length, rounded outward.
double quotient(double bound, double length, bool lower) {
    const double nearest = bound / length, above = std::fma(nearest, length, -bound);
    if (bound == 0 || !std::isfinite(nearest)) return nearest;
    // The remainder of a division has at most 53 bits below those of the bound, so `above` is exact unless it underflows.
    const bool exact = bound >= 0x1p-900;
    if (exact && (lower ? above <= 0 : above >= 0)) return nearest;
    return std::nextafter(nearest, lower ? 0 : infinity);
}

json fraction(double bound, double diagonal, bool lower) {
    return diagonal > 0 && std::isfinite(diagonal) ? number(quotient(bound, diagonal, lower)) : json();
}

Index count_parts(const MeasuredShape& s) {
    return s.parts.empty() ? 0 : *std::max_element(s.parts.begin(), s.parts.end()) + 1;
}

// Returns the number of the connected part that contains an element, or -1 if unknown.
Index part_of(const MeasuredShape& s, Index element) {
    return element < 0 || element >= Index(s.parts.size()) ? -1 : s.parts[std::size_t(element)];
}

json index_json(Index number) { return number < 0 ? json() : json(number); }

json answer_json(const Result& r, const Measured& m) {
    const double diagonal = m.source.diagonal;
    return {{"lower", number(r.bounds.lower)},
            {"upper", number(r.bounds.upper)},
            {"lower_of_diagonal", fraction(r.bounds.lower, diagonal, true)},
            {"upper_of_diagonal", fraction(r.bounds.upper, diagonal, false)},
            {"status", to_string(r.status)},
            {"note", r.note},
            {"source_point", point_json(r.witness.source_point)},
            {"target_point", point_json(r.witness.target_point)},
            {"source_element", index_json(r.witness.source_element)},
            {"target_element", index_json(r.witness.target_element)},
            {"source_part", index_json(part_of(m.source, r.witness.source_element))},
            {"target_part", index_json(part_of(m.target, r.witness.target_element))},
            {"witness_direction", to_string(r.witness.direction)}};
}

json shape_json(const MeasuredShape& s) {
    return {{"file", s.file.string()},
            {"kind", to_string(s.kind)},
            {"elements", s.elements},
            {"vertices", s.vertices},
            {"parts", s.kind == ShapeKind::mesh ? json(count_parts(s)) : json()},
            {"diagonal", number(s.diagonal)},
            {"format", s.report.format},
            {"precision", s.report.precision},
            {"float32", s.report.float32},
            {"segments", s.report.segments},
            {"single_points", s.report.single_points},
            {"dropped_points", s.report.dropped_points},
            {"dropped_faces", s.report.dropped_faces},
            {"unit", s.report.stated.micrometres != 0 ? json(s.report.stated.unit) : json()},
            {"up", s.report.stated.up ? json(std::string(1, s.report.stated.up)) : json()},
            {"float32_spacing", s.report.float32 ? number(s.float32_spacing) : json()},
            {"unreferenced", s.report.unreferenced ? json(*s.report.unreferenced) : json()}};
}

json directions_json(const Measured& m, const MeasureRequest& request) {
    json all = json::array();
    const auto add = [&](const char* name, const Result& r, double seconds) {
        json answer = answer_json(r, m);
        answer["direction"] = name;
        answer["solve_seconds"] = seconds;
        all.push_back(std::move(answer));
    };
    if (m.failed) return all;
    if (request.quantity() == Quantity::directed) add("source to target", m.answer.result, m.answer.solve_seconds);
    if (m.answer.forward) add("source to target", *m.answer.forward, m.answer.forward_seconds);
    if (m.answer.backward) add("target to source", *m.answer.backward, m.answer.backward_seconds);
    return all;
}

json drawn_json(const Measured& m) {
    json all = json::array();
    for (const DrawnFile& drawn : m.drawn) {
        all.push_back({{"file", drawn.file.string()},
                       {"largest", number(drawn.largest)},
                       {"vertices", drawn.vertices},
                       {"pieces", drawn.pieces},
                       {"resolved", drawn.resolved}});
    }
    return all;
}

std::string drawn_text(const DrawnFile& drawn, const char* what, double resolution) {
    std::string text = fmt::format("fields     {}: {} vertices", drawn.file.string(), drawn.vertices);
    if (drawn.pieces > 0) text += fmt::format(", {} triangles", drawn.pieces);
    text += fmt::format("; largest drawn value {:.9g}, {} is in [{}, {}]\n", drawn.largest, what,
                        bound_text(drawn.bounds.lower, true, 10), bound_text(drawn.bounds.upper, false, 10));
    if (!drawn.resolved)
        text += fmt::format(
            "           coarser than --resolution {:g} asks: that takes more triangles than are written\n", resolution);
    return text;
}

std::string shape_text(const MeasuredShape& s) {
    std::string text = s.file.string();
    if (s.kind == ShapeKind::surface) return fmt::format("{}, an algebraic surface, diagonal {:.9g}", text, s.diagonal);
    text += fmt::format(", {} {}{}", s.elements, s.kind == ShapeKind::points ? "point" : "triangle",
                        s.elements == 1 ? "" : "s");
    if (s.kind == ShapeKind::mesh) text += fmt::format(", {} vertices", s.vertices);
    if (const Index parts = count_parts(s); parts > 1) text += fmt::format(", {} connected parts", parts);
    text += fmt::format(", diagonal {:.9g}", s.diagonal);
    return text + reading_text(s.report);
}

std::string tolerance_text(const Measured& m, const MeasureRequest& request) {
    const bool instead = m.tolerance_of != request.of;
    if (m.tolerance_of == "lower") return "of the lower bound";
    if (m.tolerance_of == "absolute") return instead ? "(a length, since neither shape has an extent)" : "(a length)";
    const char* whose = instead                       ? "of the diagonal of both shapes"
                        : m.tolerance_of == "longest" ? "of A's longest side"
                                                      : "of A's diagonal";
    return fmt::format("{} {:.9g} (= {:.9g}){}", whose, m.unit, m.tolerance_absolute,
                       instead ? ", since A has no extent" : "");
}

std::string answer_text(const std::string& name, const Result& r, double diagonal) {
    const Bounds& b = r.bounds;
    std::string text = fmt::format("{:<10} {} in [{:.17g}, {:.17g}]\n", "distance", name, b.lower, b.upper);
    if (diagonal > 0 && std::isfinite(diagonal) && std::isfinite(b.upper))
        text +=
            fmt::format("           [{}, {}] of A's diagonal\n", bound_text(quotient(b.lower, diagonal, true), true),
                        bound_text(quotient(b.upper, diagonal, false), false));
    std::string end(to_string(r.status));
    if (r.status == Status::below_floor || r.status == Status::above_cutoff)
        end = "not narrowed further because the answer is known";
    else if (r.status != Status::converged)
        end = "not converged: " + end;
    return text + fmt::format("           gap {}, {}{}\n", bound_text(b.gap(), false, 3), end,
                              r.note.empty() ? "" : ": " + r.note);
}

// A table of the statistics: a line for each, and a block for each set of points that count.
std::string statistics_text(const Measured& m, const MeasureRequest& request) {
    constexpr const char* titles[] = {"points of A",
                                      "points of B",
                                      "the larger of the two",
                                      "the mean of the two",
                                      "the harmonic mean of the two",
                                      "points of A and B together"};
    const std::vector<Statistic> statistics = asked_statistics(request, m.source.counted_by, m.target.counted_by);
    std::string text;
    std::optional<Statistic::Over> block;
    for (std::size_t i = 0; i < std::min(statistics.size(), m.answer.result.statistics.size()); ++i) {
        Statistic statistic = statistics[i];
        if (block != statistic.over && request.symmetric)
            text += fmt::format("{:<10} {}\n", block ? "" : "statistics", titles[std::size_t(statistic.over)]);
        block = statistic.over;
        statistic.over = Statistic::Over::source;
        const Bounds& bounds = m.answer.result.statistics[i];
        text +=
            fmt::format("{:<10} {:<14} in [{}, {}]\n", i == 0 && !request.symmetric ? "statistics" : "",
                        to_string(statistic), bound_text(bounds.lower, true, 10), bound_text(bounds.upper, false, 10));
    }
    const Result& r = m.answer.result;
    const std::string end = r.status == Status::converged
                                ? std::string("all within the tolerance")
                                : fmt::format("not all within the tolerance: {}", to_string(r.status));
    return text + fmt::format("           {}{}\n", end, r.note.empty() ? "" : ": " + r.note);
}

// The statistics by name; with --symmetric, those over B and over both shapes below their names.
json statistics_json(const Measured& m, const MeasureRequest& request) {
    if (request.statistics.empty()) return {};
    json all = json::object();
    const std::vector<Statistic> statistics = asked_statistics(request, m.source.counted_by, m.target.counted_by);
    for (std::size_t i = 0; i < std::min(statistics.size(), m.answer.result.statistics.size()); ++i) {
        const Statistic& statistic = statistics[i];
        json& place = statistic.over == Statistic::Over::source ? all : all[std::string(to_string(statistic.over))];
        const std::string argument = fmt::format("{}", statistic.argument);
        Statistic plain = statistic;
        plain.over = Statistic::Over::source;
        const std::string group(kind_of(statistic).group);
        json& value = group.empty() ? place[to_string(plain)] : place[group][argument];
        value = {{"lower", number(m.answer.result.statistics[i].lower)},
                 {"upper", number(m.answer.result.statistics[i].upper)}};
    }
    return all;
}

std::string witness_text(const Result& r, const Measured& m) {
    const Vec3 &p = r.witness.source_point, &q = r.witness.target_point;
    const auto point = [](const Vec3& v, const MeasuredShape& on, Index element) {
        if (!v.allFinite()) return std::string("unknown");
        std::string text = fmt::format("({:.9g}, {:.9g}, {:.9g})", v[0], v[1], v[2]);
        if (element < 0) return text;
        const Index part = part_of(on, element);
        return text + (part >= 0 && count_parts(on) > 1 ? fmt::format(" [element {} of part {}]", element, part)
                                                        : fmt::format(" [element {}]", element));
    };
    if (!p.allFinite() && !q.allFinite()) return "";
    return fmt::format("witness    {} on A, {} on B\n", point(p, m.source, r.witness.source_element),
                       point(q, m.target, r.witness.target_element));
}

std::string distance_text(const Measured& m, const MeasureRequest& request) {
    const std::string name = request.penetration ? "depth" : request.symmetric ? "H(A,B)" : "h(A,B)";
    std::string text;
    if (m.cutoff) {
        constexpr const char* answers[] = {"is at most", "is above", "", "may be above or below"};
        const int code = exit_code(m, request);
        const bool tie = code == 3 && m.answer.result.status == Status::precision_floor;
        text += fmt::format("answer     {} {} {}{}\n", name, answers[code], *m.cutoff,
                            tie ? ": they are equal up to rounding" : "");
    }
    if (request.symmetric) {
        for (const auto& [direction, answer] :
             {std::pair{"h(A,B)", &m.answer.forward}, std::pair{"h(B,A)", &m.answer.backward}}) {
            if (*answer) text += answer_text(direction, **answer, m.source.diagonal) + witness_text(**answer, m);
        }
        text += answer_text(name, m.answer.result, m.source.diagonal);
        if (m.answer.forward && m.answer.backward)
            text += "           the larger of the two\n";
        else
            text += witness_text(m.answer.result, m);
    } else {
        text += answer_text(name, m.answer.result, m.source.diagonal) + witness_text(m.answer.result, m);
    }
    return text;
}

}  // namespace

json to_json(const Measured& m, const MeasureRequest& request) {
    json out = answer_json(m.answer.result, m);
    if (!request.statistics.empty() && is_share(request.statistics.front()))
        out["lower_of_diagonal"] = out["upper_of_diagonal"] = json();  // a share is not a length
    if (m.failed) {
        out["status"] = to_string(row_status(m.failed->why));
        out["note"] = m.failed->reason;
    }
    const bool is_question = m.cutoff.has_value();
    const int code = exit_code(m, request);
    const Quantity quantity = request.quantity();
    out.update({{"direction", quantity == Quantity::directed ? "source to target" : to_string(quantity)},
                {"directions", directions_json(m, request)},
                {"solver", m.solver},
                {"certified", m.certified},
                {"source", shape_json(m.source)},
                {"target", shape_json(m.target)},
                {"tolerance", request.tolerance},
                {"tolerance_of", m.tolerance_of},
                {"tolerance_absolute", number(m.tolerance_absolute)},
                {"cutoff", is_question ? json(*m.cutoff) : json()},
                {"above_cutoff", is_question && code != 3 ? json(code == 1) : json()},
                {"proven", m.proven ? number(*m.proven) : json()},
                {"proves_less", m.proven ? json(proves_less(m)) : json()},
                {"fields", drawn_json(m)},
                {"distribution", statistics_json(m, request)},
                {"warnings", m.warnings},
                {"notes", m.notes},
                {"prepare_seconds", m.answer.prepare_seconds},
                {"solve_seconds", m.answer.solve_seconds},
                {"peak_bytes", m.peak_bytes}});
    return out;
}

std::string describe(const Measured& m, const MeasureRequest& request) {
    std::string text;
    text += fmt::format("source A   {}\n", shape_text(m.source));
    text += fmt::format("target B   {}\n", shape_text(m.target));
    text += fmt::format("solver     {} ({}), tolerance {:g} {}\n", m.solver,
                        m.certified ? "certified" : "not certified", request.tolerance, tolerance_text(m, request));
    if (m.failed) return text + fmt::format("distance   no answer: {}\n", m.failed->reason);
    text += request.quantity() == Quantity::distribution ? statistics_text(m, request) : distance_text(m, request);
    constexpr const char* larger =
        ", which is larger than the upper bound above, for the run that proves it came less far; allow it more time";
    if (m.proven)
        text += fmt::format("proof      {}: at most {:.17g}{}; check it with `hausbench verify --certificate`\n",
                            request.certificate.string(), *m.proven, proves_less(m) ? larger : "");
    for (std::size_t i = 0; i < m.drawn.size(); ++i)
        text += drawn_text(m.drawn[i], i == 0 ? "h(A,B)" : "h(B,A)", request.resolution);
    for (const std::string& note : m.notes) text += fmt::format("note       {}\n", note);
    for (const std::string& warning : m.warnings) text += fmt::format("warning    {}\n", warning);
    return text + fmt::format("time       {:.4f} s to prepare, {:.4f} s to solve; peak {}\n", m.answer.prepare_seconds,
                              m.answer.solve_seconds,
                              m.peak_bytes < 0 ? "unknown" : fmt::format("{:.1f} MB", double(m.peak_bytes) / 1e6));
}

}  // namespace hausbench
