#include "measure.h"

#include "contract.h"
#include "error.h"
#include "field_file.h"
#include "isolated.h"
#include "memory.h"
#include "paths.h"
#include "registry.h"
#include "session.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <iterator>

namespace hausbench {

namespace {

void solve(const SolverEntry& entry, const MeasureRequest& request, Shape source, Shape target, Measured& measured) {
    Query query;
    query.quantity = request.symmetric ? Quantity::symmetric : Quantity::directed;
    query.tolerance = {request.of == "lower" ? Tolerance::Of::lower : Tolerance::Of::absolute,
                       request.tolerance * measured.unit};
    query.threads = request.threads;
    query.time_limit = request.time_limit;
    if (request.cutoff) {
        query.floor = query.cutoff = *request.cutoff;
        // Next to the distance itself no bound tells, and nothing else would end the search.
        if (std::isinf(query.time_limit)) query.time_limit = question_seconds;
    }
    measured.tolerance_absolute = query.tolerance.of == Tolerance::Of::absolute
                                      ? query.tolerance.value
                                      : std::numeric_limits<double>::quiet_NaN();
    QuerySet queries;
    queries.finest_tolerance = query.tolerance.of == Tolerance::Of::absolute ? query.tolerance.value : 0;
    queries.symmetric = request.symmetric;
    SolverMemory memory;
    const PreparedPair shapes = prepare_pair(entry.info, std::move(source), std::move(target));
    const Session session(entry, Options(entry.info.name, entry.info.parameters, request.options), shapes, queries);
    memory.prepared();
    memory.next_answer();
    Trace untraced;
    const auto begin = std::chrono::steady_clock::now();
    held_to_contract(entry.info.name, "solve()", [&] { measured.result = session.solve(query, untraced); });
    measured.solve_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    measured.result.note = one_line(measured.result.note);
    measured.prepare_seconds = session.prepare_seconds();
    measured.peak_bytes = memory.peak_bytes(measured.result.outside_bytes);
    if (request.fields.empty()) return;
    Fields fields = distance_fields(*shapes.source, {}, *shapes.target, {});
    if (entry.info.fields) {  // once more, so that the time above is that of the bounds alone
        query.wanted.fields = true;
        if (auto own = session.solve(query, untraced).fields)
            std::move(own->begin(), own->end(), std::back_inserter(fields));
    }
    export_fields(request.fields, shapes.source->shape(), shapes.source->original(), fields);
}

const char* name_of_unit(const std::string& of) { return of == "longest" ? "longest side" : "diagonal"; }

// What can be done where a solver does not take the pair.
std::string solvers_for(ShapeKind source, ShapeKind target) {
    std::string names;
    for (const SolverEntry& entry : solvers()) {
        if (refusal(entry.info, source, target).empty()) names += (names.empty() ? "" : ", ") + entry.info.name;
    }
    if (names.empty())
        return fmt::format("no solver measures {} against {}: give two files of one kind", to_string(source),
                           to_string(target));
    return fmt::format("choose one that does with --solver: {}", names);
}

}  // namespace

Measured measure(const MeasureRequest& request) {
    if (!(request.tolerance > 0) || !std::isfinite(request.tolerance)) {
        throw InputError(fmt::format("--tolerance: must be a number above 0, not {}", request.tolerance));
    }
    if (request.cutoff && !(*request.cutoff >= 0 && std::isfinite(*request.cutoff)))
        throw InputError(fmt::format("--cutoff: must be a length of at least 0, not {}", *request.cutoff));
    if (!request.fields.empty()) check_export_place(request.fields);
    LoadedShape source = load_isolated(program_path(), request.source);
    LoadedShape target = load_isolated(program_path(), request.target);
    Measured measured;
    measured.source_report = source.report;
    measured.target_report = target.report;
    measured.source_kind = kind_of(source.shape);
    measured.target_kind = kind_of(target.shape);
    measured.source_elements = element_count(source.shape);
    measured.target_elements = element_count(target.shape);
    const Points& points_of_source = points_of(source.shape);
    measured.unit = unit_of(request.of, diagonal(points_of_source), longest_side(points_of_source));
    const bool points = measured.source_kind == ShapeKind::points && measured.target_kind == ShapeKind::points;
    const bool surfaces = measured.source_kind == ShapeKind::surface && measured.target_kind == ShapeKind::surface;
    measured.solver = !request.solver.empty() ? request.solver
                      : points                ? "earlybreak"
                      : surfaces              ? "surface_enclosure"
                                              : "guthe";
    if (surfaces && !request.fields.empty())
        throw InputError(fmt::format(
            "--fields {}: an algebraic surface has no vertices, so it has no fields: triangulate both first",
            request.fields.string()));
    const SolverEntry& entry = find_solver(measured.solver);
    if (const auto why = refusal(entry.info, measured.source_kind, measured.target_kind); !why.empty()) {
        throw InputError(fmt::format("{} and {}: {}; {}", request.source.string(), request.target.string(), why,
                                     solvers_for(measured.source_kind, measured.target_kind)));
    }
    if (measured.unit == 0) {
        throw InputError(fmt::format(
            "{}: its box has no {}, so a tolerance relative to it means nothing: use --of absolute or --of lower",
            request.source.string(), name_of_unit(request.of)));
    }
    solve(entry, request, std::move(source.shape), std::move(target.shape), measured);
    return measured;
}

bool answered(const Measured& measured) {
    return measured.result.status != Status::stalled || std::isfinite(measured.result.bounds.upper) ||
           measured.result.bounds.lower > 0;
}

int exit_code(const Measured& measured, const MeasureRequest& request) {
    if (!request.cutoff) return answered(measured) ? 0 : 1;
    const Status status = measured.result.status;
    return status == Status::below_floor ? 0 : status == Status::above_cutoff ? 1 : 3;
}

nlohmann::json to_json(const Measured& m, const MeasureRequest& request) {
    const auto point = [](const Vec3& v) -> nlohmann::json {
        if (!v.allFinite()) return nullptr;
        return {v[0], v[1], v[2]};
    };
    const Witness& w = m.result.witness;
    return {{"lower", number(m.result.bounds.lower)},
            {"upper", number(m.result.bounds.upper)},
            {"status", to_string(m.result.status)},
            {"note", m.result.note},
            {"source_point", point(w.source_point)},
            {"target_point", point(w.target_point)},
            {"witness_direction", to_string(w.direction)},
            {"direction", request.symmetric ? "symmetric" : "source to target"},
            {"solver", m.solver},
            {"tolerance", request.tolerance},
            {"tolerance_of", request.of},
            {"cutoff", request.cutoff ? nlohmann::json(*request.cutoff) : nlohmann::json()},
            {"above_cutoff", request.cutoff && exit_code(m, request) != 3 ? nlohmann::json(exit_code(m, request) == 1)
                                                                          : nlohmann::json()},
            {"tolerance_absolute", number(m.tolerance_absolute)},
            {"prepare_seconds", m.prepare_seconds},
            {"solve_seconds", m.solve_seconds},
            {"peak_bytes", m.peak_bytes}};
}

std::string describe(const Measured& m, const MeasureRequest& request) {
    const auto shape = [](const std::filesystem::path& file, ShapeKind kind, Index elements, const LoadReport& report) {
        std::string text = kind == ShapeKind::surface ? fmt::format("{}, an algebraic surface", file.string())
                                                      : fmt::format("{}, {} {}", file.string(), elements,
                                                                    kind == ShapeKind::points ? "points" : "triangles");
        if (report.precision != "float64") text += fmt::format(", {} coordinates", report.precision);
        if (report.unreferenced.value_or(0) > 0)
            text += fmt::format(", {} unreferenced vertices dropped", *report.unreferenced);
        return text;
    };
    const Bounds& b = m.result.bounds;
    const Vec3& p = m.result.witness.source_point;
    const Vec3& q = m.result.witness.target_point;
    std::string text;
    text += fmt::format("source A   {}\n", shape(request.source, m.source_kind, m.source_elements, m.source_report));
    text += fmt::format("target B   {}\n", shape(request.target, m.target_kind, m.target_elements, m.target_report));
    const std::string of =
        request.of == "lower" ? "of the lower bound"
        : request.of == "absolute"
            ? "(a length)"
            : fmt::format("of A's {} {:.9g} (= {:.9g})", name_of_unit(request.of), m.unit, m.tolerance_absolute);
    text += fmt::format("solver     {}, tolerance {:g} {}\n", m.solver, request.tolerance, of);
    text +=
        fmt::format("distance   {} in [{:.17g}, {:.17g}]\n", request.symmetric ? "H(A,B)" : "h(A,B)", b.lower, b.upper);
    text += fmt::format("           gap {:.3g}, {}{}\n", b.gap(), to_string(m.result.status),
                        m.result.note.empty() ? "" : ": " + m.result.note);
    if (request.cutoff) {
        constexpr const char* answers[] = {"no, it is at most that", "yes", "", "open"};
        text += fmt::format("above {:.9g}? {}\n", *request.cutoff, answers[exit_code(m, request)]);
    }
    if (p.allFinite()) {
        text += fmt::format("witness    ({:.9g}, {:.9g}, {:.9g}) on A, ({:.9g}, {:.9g}, {:.9g}) on B{}\n", p[0], p[1],
                            p[2], q[0], q[1], q[2],
                            request.symmetric ? fmt::format(", {}", to_string(m.result.witness.direction)) : "");
    }
    text +=
        fmt::format("time       {:.4f} s to prepare, {:.4f} s to solve; peak {}\n", m.prepare_seconds, m.solve_seconds,
                    m.peak_bytes < 0 ? "unknown" : fmt::format("{:.1f} MB", double(m.peak_bytes) / 1e6));
    return text;
}

}  // namespace hausbench
