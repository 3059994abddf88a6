#include "harness/commands/measurement.h"

#include "algorithms/error.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "datasets/derive.h"
#include "datasets/units.h"
#include "harness/check/certificate_file.h"
#include "harness/check/contradictions.h"
#include "harness/commands/measurement_solve.h"
#include "harness/commands/named_shape.h"
#include "harness/commands/witness_file.h"
#include "harness/plan/plugin_code.h"
#include "harness/result/field_file.h"
#include "process/whole_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace hausbench {

namespace {

const char* name_of_unit(const std::string& of) { return of == "longest" ? "longest side" : "diagonal"; }

// Returns a hint for an error message: the solvers that accept shapes of these kinds for this quantity, or a sentence
// that none does.
std::string solvers_for(ShapeKind source, ShapeKind target, Quantity quantity) {
    std::string names;
    for (const SolverEntry& entry : solvers()) {
        if (refusal(entry.info, source, target, quantity).empty())
            names += (names.empty() ? "" : ", ") + entry.info.name;
    }
    if (names.empty())
        return fmt::format("no solver computes {} of {} and {}: give two {}", symbol(quantity), to_string(source),
                           to_string(target), quantity == Quantity::penetration ? "meshes" : "files of one kind");
    return fmt::format("choose one that does with --solver: {}", names);
}

std::string solvers_with_certificates(ShapeKind source, ShapeKind target) {
    std::string names;
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.can(Ability::certificates) && refusal(entry.info, source, target).empty())
            names += (names.empty() ? "" : ", ") + entry.info.name;
    }
    return names.empty() ? fmt::format("none does for {} against {}", to_string(source), to_string(target))
                         : fmt::format("choose one that does with --solver: {}", names);
}

// Throws InputError if an output file would overwrite a file of A or B, or another output file.
void expect_places_apart(const MeasureRequest& request) {
    std::vector<std::pair<std::string, std::filesystem::path>> taken = {{"A", file_behind(request.source)},
                                                                        {"B", file_behind(request.target)}};
    const auto take = [&](const std::string& what, const std::filesystem::path& file) {
        for (const auto& [other, its_file] : taken) {
            if (is_same_file(file, its_file))
                throw InputError(
                    fmt::format("{} {}: {} is the same file: choose another name", what, file.string(), other));
        }
        taken.emplace_back(what, file);
    };
    if (!request.fields.empty()) take("--fields", request.fields);
    if (!request.fields.empty() && request.asks_for_h())
        take("--fields with --symmetric", file_of_way_back(request.fields));
    if (!request.certificate.empty()) take("--certificate", request.certificate);
    if (!request.witness.empty()) take("--witness", request.witness);
}

// Statistics have neither a farthest point nor a proof.
void check_distribution(const MeasureRequest& request) {
    if (request.penetration)
        throw InputError("--distribution and --penetration are different quantities: give one of them");
    if (request.cutoff)
        throw InputError(
            fmt::format("--cutoff: is about the largest distance: leave it out, or ask for --statistics 'within {}'",
                        *request.cutoff));
    if (!request.fields.empty())
        throw InputError("--fields: is drawn beside the largest distance: leave out --distribution and --statistics");
    if (!request.certificate.empty())
        throw InputError("--certificate: proves the largest distance: leave out --distribution and --statistics");
    if (!request.witness.empty())
        throw InputError("--witness: shows the largest distance: leave out --distribution and --statistics");
    if (!(request.share_tolerance > 0))
        throw InputError(fmt::format("--share-tolerance: must be a number above 0, not {}", request.share_tolerance));
}

void check(const MeasureRequest& request) {
    if (request.symmetric && request.penetration)
        throw InputError("--symmetric and --penetration are different quantities: give one of them");
    if (!request.statistics.empty()) check_distribution(request);
    if (request.penetration && !request.fields.empty())
        throw InputError("--fields: a penetration depth has no fields: leave out --fields or --penetration");
    if (!(request.tolerance > 0) || !std::isfinite(request.tolerance))
        throw InputError(fmt::format("--tolerance: must be a number above 0, not {}", request.tolerance));
    if (request.cutoff && !(*request.cutoff >= 0 && std::isfinite(*request.cutoff)))
        throw InputError(fmt::format("--cutoff: must be a length of at least 0, not {}", *request.cutoff));
    if (!(request.time_limit >= 0))
        throw InputError(fmt::format("--time-limit: must be seconds of at least 0, not {}", request.time_limit));
    if (!(request.resolution > 0))
        throw InputError(fmt::format("--resolution: must be a number above 0, not {}", request.resolution));
    if (!request.fields.empty()) check_export_place(request.fields);
    if (!request.fields.empty() && request.asks_for_h()) check_export_place(file_of_way_back(request.fields));
    if (!request.certificate.empty()) check_place_to_write(request.certificate);
    if (!request.witness.empty()) check_witness_place(request.witness);
    expect_places_apart(request);
    if (!request.certificate.empty() &&
        (request.reading.any() || !request.source_matrix.empty() || !request.target_matrix.empty()))
        throw InputError(
            "--certificate: proves a bound for the files as they stand, without --unit, --up, --columns, "
            "--drop-invalid "
            "and matrices: write the converted shapes with `hausbench export`, and measure those");
}

// Returns the lengths of the sides of the box, the smallest first.
std::array<double, 3> extents_of(const Points& points) {
    std::array<double, 3> extents{};
    for (int k = 0; k < 3; ++k) extents[std::size_t(k)] = points.col(k).maxCoeff() - points.col(k).minCoeff();
    std::sort(extents.begin(), extents.end());
    return extents;
}

MeasuredShape about(const std::filesystem::path& file, const LoadedShape& loaded) {
    const Points& points = points_of(loaded.shape);
    const auto* mesh = std::get_if<TriangleMesh>(&loaded.shape);
    const double largest = magnitude(points);
    // A float32 has 24 significant bits, so numbers from 2^e to 2^(e+1) are 2^(e-23) apart. Below 2^-126, the smallest
    // normal float32, the spacing is constant.
    const int exponent = largest > 0 ? std::max(std::ilogb(largest), -126) : -126;
    return {file,
            loaded.report,
            kind_of(loaded.shape),
            counted_by(loaded.shape),
            element_count(loaded.shape),
            static_cast<Index>(points.rows()),
            diagonal(points),
            extents_of(points),
            std::ldexp(1.0, exponent - 23),
            mesh ? connected_parts(*mesh) : std::vector<Index>()};
}

// Returns the tolerance of the request. Throws InputError if it was given in a unit that has no length.
Tolerance tolerance_of(const MeasureRequest& request, const Points& a, Measured& measured) {
    const ResolvedTolerance resolved = resolve_tolerance(request.tolerance, request.of, a, measured.extent);
    if (resolved.fell_back && request.tolerance_given)
        throw InputError(fmt::format(
            "{}: its box has no {}, so a tolerance relative to it has no meaning: use --of absolute or --of lower",
            request.source.string(), name_of_unit(request.of)));
    const bool relative = resolved.tolerance.of == Tolerance::Of::lower;
    measured.tolerance_of = resolved.of;
    measured.unit = resolved.unit;
    measured.tolerance_absolute = relative ? std::numeric_limits<double>::quiet_NaN() : resolved.tolerance.value;
    if (request.cutoff) measured.cutoff = *request.cutoff * (request.of_given ? resolved.unit : 1);
    return resolved.tolerance;
}

std::string default_solver(ShapeKind source, ShapeKind target) {
    if (source != target) return "cover";
    return source == ShapeKind::points ? "scan" : source == ShapeKind::surface ? "surface_enclosure" : "cover";
}

// Warns if the float32 coordinates of a file are spaced wider than the tolerance.
void warn_of_float32(const MeasureRequest& request, Measured& measured) {
    const bool relative = request.of == "lower";
    const double gap = relative ? request.tolerance * measured.answer.result.bounds.lower : measured.tolerance_absolute;
    for (const auto& [name, shape] : {std::pair{"A", &measured.source}, std::pair{"B", &measured.target}}) {
        if (!shape->report.float32 || !(shape->float32_spacing > gap) || !(gap > 0)) continue;
        measured.warnings.push_back(
            fmt::format("the coordinates of {} are float32, in steps of up to {:.3g}: that is more than the tolerance "
                        "{:.3g}, and the answer is about the rounded shape",
                        name, shape->float32_spacing, gap));
    }
}

constexpr double agreement = 1.02;  // largest ratio of lengths that count as equal in a warning

// Returns the factor by which all sides of B's box are longer than A's, or nothing if they have different factors.
std::optional<double> common_factor(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (a[k] == 0 && b[k] == 0) continue;
        const double factor = b[k] / a[k];
        if (!(factor > 0) || !std::isfinite(factor)) return std::nullopt;
        least = std::min(least, factor);
        most = std::max(most, factor);
    }
    return most > 0 && most <= agreement * least ? std::optional(std::sqrt(least) * std::sqrt(most)) : std::nullopt;
}

// Returns the ratio of two units that a factor is within 2 % of, or nothing: inches in mm, metres in inches, feet in mm,
// a power of ten, or the inverse of one of these.
std::optional<double> ratio_of_units(double factor) {
    const double larger = std::max(factor, 1 / factor);
    const double power = std::pow(10, std::round(std::log10(larger)));
    for (const double ratio : {25.4, 39.37, 304.8, power > 1 ? power : 10.0})
        if (larger <= agreement * ratio && ratio <= agreement * larger) return ratio;
    return std::nullopt;
}

// Warns about common mistakes: one file in millimetres, the other in metres or inches; one of two equal shapes moved.
void warn_of_units(const Points& source, const Points& target, Measured& measured) {
    const double a = measured.source.diagonal, b = measured.target.diagonal;
    const auto factor = common_factor(measured.source.extents, measured.target.extents);
    if (const auto unit_ratio = factor ? ratio_of_units(*factor) : std::nullopt) {
        measured.warnings.push_back(fmt::format(
            "all sides of the box of {} are about {:g} times as long as the sides of {}: are both in the same "
            "unit? If a file states its unit, --unit converts it; else scale one file",
            *factor > 1 ? "B" : "A", *unit_ratio, *factor > 1 ? "A" : "B"));
        return;
    }
    const bool apart = (source.colwise().maxCoeff().array() < target.colwise().minCoeff().array()).any() ||
                       (target.colwise().maxCoeff().array() < source.colwise().minCoeff().array()).any();
    if (factor && *factor <= agreement && agreement * *factor >= 1 && apart)
        measured.warnings.push_back(
            "the boxes of A and B do not overlap, although their sizes agree: is one of them moved or turned? "
            "--transform-source and --transform-target take a matrix");
    const double ratio = std::max(a, b) / std::min(a, b);
    if (ratio >= 100 && std::isfinite(ratio))
        measured.warnings.push_back(fmt::format("{} is {:.3g} times as large as the other: are both in the same unit?",
                                                a > b ? "A" : "B", ratio));
}

// Warns if most vertices belong to no triangle, as in a file that was cut short after its vertices.
void warn_of_unreferenced(Measured& measured) {
    for (const auto& [name, shape] : {std::pair{"A", &measured.source}, std::pair{"B", &measured.target}}) {
        const std::int64_t dropped = shape->report.unreferenced.value_or(0);
        if (dropped > shape->vertices)
            measured.warnings.push_back(
                fmt::format("{} of the {} vertices of {} belong to no triangle and are ignored: is the file complete?",
                            dropped, dropped + shape->vertices, name));
    }
}

// Loads A and B. --columns is for both; but if it fits one of them, the other may be a table that is clear without it.
std::pair<LoadedShape, LoadedShape> load_both(const MeasureRequest& request) {
    const std::string names[] = {request.source.string(), request.target.string()};
    if (request.reading.columns.empty())
        return {load_named(names[0], request.reading), load_named(names[1], request.reading)};
    if (!has_columns(names[0]) && !has_columns(names[1]))
        throw InputError("--columns: neither file is a table of points, such as .csv or .xyz: leave it out");
    ShapeOptions plain = request.reading;
    plain.columns.clear();
    std::optional<InputError> misfit;
    std::vector<LoadedShape> loaded;
    for (const std::string& name : names) {
        try {
            loaded.push_back(load_named(name, request.reading));
        } catch (const InputError& error) {
            if (misfit || !has_columns(name)) throw;
            misfit = error;
            try {
                loaded.push_back(load_named(name, plain));
            } catch (const InputError&) {
                throw error;
            }
            loaded.back().report.notes.emplace_back("is read without --columns, which do not fit it");
        }
    }
    if (misfit && !(has_columns(names[0]) && has_columns(names[1]))) throw InputError(*misfit);
    return {std::move(loaded[0]), std::move(loaded[1])};
}

// Throws InputError if both files state a unit, or which axis points up, and they differ.
void expect_one_convention(const MeasureRequest& request, const Stated& a, const Stated& b) {
    const std::string source = request.source.string(), target = request.target.string();
    const bool convertible = a.micrometres != 0 && b.micrometres != 0;
    if (units_differ(a, b))
        throw InputError(fmt::format("{} is in {}, and {} in {}: {}compare the numbers as they stand with --unit none",
                                     source, one_line(a.unit), target, one_line(b.unit),
                                     convertible ? "convert both with --unit mm, or " : "such a unit is not known: "));
    if (a.up != 0 && b.up != 0 && a.up != b.up)
        throw InputError(
            fmt::format("{} has {} pointing up, and {} has {}: turn both with --up Z, or compare the numbers "
                        "as they stand with --up none",
                        source, a.up, target, b.up));
}

// Notes how the files were read, and what only one of them states.
void take_notes(const MeasureRequest& request, Measured& measured) {
    const Stated &a = measured.source.report.stated, &b = measured.target.report.stated;
    for (const auto& [name, shape, other] :
         {std::tuple{"A", &measured.source, &b}, std::tuple{"B", &measured.target, &a}}) {
        const Stated& stated = shape->report.stated;
        if (shape->counted_by == CountedBy::length && !request.statistics.empty() && request.weigh == WeighBy::area)
            measured.notes.push_back(
                fmt::format("{}: has no area, only line segments: its statistics are by length", name));
        for (const std::string& note : shape->report.notes) measured.notes.push_back(fmt::format("{}: {}", name, note));
        if (!request.reading.unit.empty() || stated.micrometres == 0) continue;
        measured.notes.push_back(
            fmt::format("{}: is in {}{}", name, stated.unit,
                        !other->unit.empty()
                            ? ""
                            : ", and the other file states no unit: the numbers are compared as they stand; --unit "
                              "converts them"));
    }
}

}  // namespace

Measured measure(const MeasureRequest& given) {
    check(given);
    MeasureRequest request = given;
    // A cutoff very close to the distance may never be decided, so the search needs a time limit.
    if (request.cutoff && std::isinf(request.time_limit)) request.time_limit = question_seconds;
    auto [source, target] = load_both(request);
    expect_one_convention(request, source.report.stated, target.report.stated);
    if (!request.source_matrix.empty()) transform(source, request.source_matrix);
    if (!request.target_matrix.empty()) transform(target, request.target_matrix);
    Measured measured;
    measured.source = about(request.source, source);
    measured.target = about(request.target, target);
    take_notes(request, measured);
    warn_of_units(points_of(source.shape), points_of(target.shape), measured);
    const ShapeKind a = measured.source.kind, b = measured.target.kind;
    const Quantity quantity = request.quantity();
    measured.solver = !request.solver.empty()              ? request.solver
                      : quantity == Quantity::penetration  ? "penetration"
                      : quantity == Quantity::distribution ? "distribution"
                                                           : default_solver(a, b);
    if (a == ShapeKind::surface && b == ShapeKind::surface && !request.fields.empty())
        throw InputError(fmt::format(
            "--fields {}: an algebraic surface has no vertices, so it has no fields: triangulate both first",
            request.fields.string()));
    const SolverEntry& entry = find_solver(measured.solver);
    if (const std::string no = refusal(entry.info, a, b, quantity); !no.empty())
        throw InputError(fmt::format("{} and {}: {}; {}", request.source.string(), request.target.string(), no,
                                     solvers_for(a, b, quantity)));
    if (!request.certificate.empty() && !entry.info.can(Ability::certificates))
        throw InputError(fmt::format("--certificate {}: solver '{}' writes no certificates; {}",
                                     request.certificate.string(), entry.info.name, solvers_with_certificates(a, b)));
    for (const auto& [name, shape] :
         {std::pair{&request.source, &measured.source}, {&request.target, &measured.target}}) {
        const bool counts = shape == &measured.source || request.symmetric;
        if (counts && !request.statistics.empty() && request.weigh == WeighBy::area &&
            shape->counted_by == CountedBy::nothing)
            throw InputError(fmt::format("{}: has neither area nor length, by which statistics weigh: add --by-vertex",
                                         name->string()));
    }
    measured.certified = promises(entry, request.options);
    measured.extent = diagonal_of_both(points_of(source.shape), points_of(target.shape));
    const Tolerance tolerance = tolerance_of(request, points_of(source.shape), measured);
    solve(request, entry, tolerance, std::move(source.shape), std::move(target.shape), measured);
    warn_of_float32(request, measured);
    warn_of_unreferenced(measured);
    if (const std::string wrong =
            wrong_witness(measured.answer.result.witness, measured.source.elements, measured.target.elements);
        !wrong.empty())
        measured.warnings.push_back(fmt::format("do not trust solver '{}': {}", measured.solver, wrong));
    if (!request.certificate.empty() && !measured.proven && no_answer(measured).empty())
        measured.warnings.push_back(
            fmt::format("{} is not written: {}", request.certificate.string(),
                        measured.why_not_proven.empty() ? "the solver did not say why" : measured.why_not_proven));
    if (!measured.why_not_drawn.empty())
        measured.warnings.push_back(
            fmt::format("{}: not all fields are written: {}", request.fields.string(), measured.why_not_drawn));
    if (!request.witness.empty() && no_answer(measured).empty()) {
        const Witness& witness = measured.answer.result.witness;
        measured.no_witness = !witness.source_point.allFinite() || !witness.target_point.allFinite();
        if (measured.no_witness)
            measured.warnings.push_back(
                fmt::format("{} is not written: the solver names no two points", request.witness.string()));
        else
            write_witness(request.witness, witness.source_point, witness.target_point);
    }
    if (!measured.doubt.empty())
        measured.warnings.push_back(fmt::format("{}: {}", request.certificate.string(), measured.doubt));
    return measured;
}

std::vector<Statistic> asked_statistics(const MeasureRequest& request, CountedBy source, CountedBy target) {
    std::vector<Statistic> all = request.statistics;
    if (!request.symmetric) return all;
    for (const Statistic::Over over : {Statistic::Over::target, Statistic::Over::larger, Statistic::Over::mean_of_both,
                                       Statistic::Over::harmonic_mean, Statistic::Over::pooled}) {
        if (over == Statistic::Over::pooled && source != target && request.weigh == WeighBy::area) continue;
        for (Statistic statistic : request.statistics) {
            statistic.over = over;
            all.push_back(statistic);
        }
    }
    return all;
}

bool proves_less(const Measured& measured) {
    return measured.proven && !proves_the_bound(*measured.proven, measured.answer.result.bounds.upper, measured.extent);
}

std::string no_answer(const Measured& measured) {
    if (measured.failed) return measured.failed->reason;
    const Result& result = measured.answer.result;
    if (!may_bound_a_distance(result.bounds))
        return fmt::format("its bounds [{:g}, {:g}] are not an interval of distances", result.bounds.lower,
                           result.bounds.upper);
    const bool said = result.status != Status::stalled || std::isfinite(result.bounds.upper) || result.bounds.lower > 0;
    return said ? "" : result.note.empty() ? "it stalled" : result.note;
}

int exit_code(const Measured& measured, const MeasureRequest& request) {
    const bool proof = (request.certificate.empty() || (measured.proven && measured.doubt.empty())) &&
                       measured.why_not_drawn.empty() && !measured.no_witness;
    if (!request.cutoff) return no_answer(measured).empty() && proof ? 0 : 1;
    if (!no_answer(measured).empty()) return 3;
    const Status status = measured.answer.result.status;
    return status == Status::below_floor ? 0 : status == Status::above_cutoff ? 1 : 3;
}

}  // namespace hausbench
