#include "session.h"

#include "error.h"
#include "kernel/rounding.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

namespace hausbench {
namespace {

// Multiplies by 2^exponent; returns the largest rounding error that a coordinate may have got (0: exact).
double scale(Points& points, int exponent) {
    bool exact = true;
    for (double& value : std::span(points.data(), static_cast<std::size_t>(points.size()))) {
        const double scaled = std::ldexp(value, exponent);
        exact = exact && std::ldexp(scaled, -exponent) == value;
        value = scaled;
    }
    return exact ? 0 : 0x1p-1074;
}

double scaled_back(double value, int exponent, double (*outward)(double)) {
    const double original = std::ldexp(value, -exponent);
    return std::ldexp(original, exponent) == value || std::isinf(value) ? original : outward(original);
}

// A length that must stay positive and finite.
double scaled_tolerance(double value, int exponent) {
    return std::clamp(std::ldexp(value, exponent), std::numeric_limits<double>::denorm_min(),
                      std::numeric_limits<double>::max());
}

void check(const Query& query) {
    const auto fail = [](const char* what, double value, const char* remedy) {
        throw InputError(fmt::format("query: {} is {}; {}", what, value, remedy));
    };
    if (!(query.tolerance.value > 0) || std::isinf(query.tolerance.value)) {
        fail("the tolerance", query.tolerance.value, "give a positive number");
    }
    if (!(query.cutoff >= 0)) fail("the cutoff", query.cutoff, "give a length, or infinity for none");
    if (!(query.time_limit >= 0)) fail("the time limit", query.time_limit, "give seconds, or infinity for none");
    if (!query.pose.rotation.allFinite() || !query.pose.translation.allFinite()) {
        throw InputError("query: the pose has an entry that is not finite; give a finite matrix and translation");
    }
}

}  // namespace

std::string_view to_string(Status status) {
    constexpr std::string_view names[] = {"converged", "cutoff_passed",   "time_limit",
                                          "budget",    "precision_floor", "stalled"};
    return names[static_cast<std::size_t>(status)];
}

std::string refusal(const SolverInfo& info, ShapeKind source, ShapeKind target) {
    const auto text = [&](const char* side, ShapeKind kind) {
        return fmt::format("solver '{}' takes no {} as {}", info.name, to_string(kind), side);
    };
    if (!info.source.contains(source)) return text("source", source);
    if (!info.target.contains(target)) return text("target", target);
    return {};
}

Session::Session(const SolverEntry& entry, const Options& options, Scene scene, const QuerySet& queries, Leave leave)
    : scene_(std::make_unique<Scene>(std::move(scene))), traces_(entry.info.traces) {
    const std::string no = refusal(entry.info, kind_of(scene_->source), kind_of(scene_->target));
    if (!no.empty()) throw InputError(no);

    Points& source = points_of(scene_->source);
    Points& target = points_of(scene_->target);
    const double largest = std::max(magnitude(source), magnitude(target));
    moveable_ = kind_of(scene_->source) != ShapeKind::surface;
    // The coefficients of a surface belong to its coordinates.
    const bool scalable = moveable_ && kind_of(scene_->target) != ShapeKind::surface;
    if (!entry.info.original_coordinates && scalable && largest > 0) {
        std::frexp(largest, &exponent_);
        exponent_ = -exponent_;
        lost_ = std::max(scale(source, exponent_), scale(target, exponent_));
    }
    largest_ = magnitude(source);
    smallest_ = smallest_nonzero(source);

    const Options own(entry.info.name, entry.info.parameters, options.values());
    solver_ = entry.make(own);
    if (const auto unread = own.unread(); !unread.empty()) {
        throw std::logic_error("solver '" + entry.info.name + "' does not read its parameter '" + unread.front() + "'");
    }

    needs_ = leave == Leave::nothing_out ? entry.info.may_need : solver_->needs(*scene_, queries);
    for (const Need& need : needs_) {
        const auto& may = entry.info.may_need;
        if (std::find(may.begin(), may.end(), need) == may.end()) {
            throw std::logic_error("solver '" + entry.info.name + "' needs a " + to_string(need) +
                                   " that is not in may_need");
        }
    }
    // Of all a solver may ever need, what these shapes have no use for is left out all the same.
    std::erase_if(needs_, [&](const Need& need) {
        const Shape& shape = need.side == Side::source ? scene_->source : scene_->target;
        return leave == Leave::nothing_out && !fits(need.structure, kind_of(shape));
    });
    prepared_ = std::make_unique<Prepared>(*scene_, needs_);
    preparation_ = prepared_->times();

    const auto begin = std::chrono::steady_clock::now();
    solver_->prepare(*scene_, *prepared_);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    preparation_.push_back({"solver", elapsed.count(), solver_->prepared_bytes()});
}

// The solver measures fl(R (sv) + st), the definition says s fl(R v + t). They are the same bits unless something
// underflows: then each differs from the exact value by at most 4u (3 r M + t) for the roundings and 2^-1073 for the
// underflows, in its own unit, in each coordinate. A coordinate lost in scaling moves a point by as much. The distance
// changes by no more than the two points move together.
double Session::widening(const Pose& pose) const {
    double widening = 4 * lost_;
    if (exponent_ == 0 || pose.is_identity()) return widening;
    double least = std::numeric_limits<double>::infinity();
    for (const double entry : pose.rotation.reshaped()) {
        if (entry != 0) least = std::min(least, std::abs(entry));
    }
    const Vec3 translation = pose.translation.unaryExpr([&](double t) { return std::ldexp(t, exponent_); });
    const bool exact_translation =
        translation.unaryExpr([&](double t) { return std::ldexp(t, -exponent_); }) == pose.translation;
    // Logarithms rounded down, so that no product here underflows itself.
    const auto exponent_of = [](double x) { return std::isfinite(x) && x != 0 ? std::ilogb(x) : 0; };
    const int product = exponent_of(least) + exponent_of(smallest_);
    if (exact_translation && product >= -1022 && product - exponent_ >= -1022) return widening;
    const double most = pose.rotation.cwiseAbs().maxCoeff();
    const double size = 3 * most * largest_ + translation.cwiseAbs().maxCoeff();
    return widening +
           2 * (10 * unit_roundoff * size + std::ldexp(1.0, std::max(exponent_, 0) - 1070) + 4 * most * lost_);
}

Result Session::solve(const Query& query, Trace& trace) const {
    check(query);
    if (!moveable_ && !query.pose.is_identity()) {
        throw InputError(
            "query: an algebraic surface cannot be moved; write the motion into its polynomial, or triangulate it "
            "first");
    }
    Query scaled = query;
    Result previous;
    if (exponent_ != 0) {
        for (double& value : scaled.pose.translation) value = std::ldexp(value, exponent_);
        if (query.tolerance.of == Tolerance::Of::absolute) {
            scaled.tolerance.value = scaled_tolerance(query.tolerance.value, exponent_);
        }
        scaled.cutoff = std::ldexp(query.cutoff, exponent_);
        if (query.previous) {
            previous = *query.previous;
            previous.bounds.lower = std::ldexp(previous.bounds.lower, exponent_);
            previous.bounds.upper = std::ldexp(previous.bounds.upper, exponent_);
            for (double& value : previous.witness.source_point) value = std::ldexp(value, exponent_);
            for (double& value : previous.witness.target_point) value = std::ldexp(value, exponent_);
            scaled.previous = &previous;
        }
    }

    trace.start(exponent_);
    Result result = solver_->solve(scaled, trace);

    if (const double wider = widening(query.pose); wider > 0) {
        result.bounds.lower = std::max(0.0, next_down(result.bounds.lower - wider));
        result.bounds.upper = next_up(result.bounds.upper + wider);
    }
    if (exponent_ != 0) {
        result.bounds.lower = scaled_back(result.bounds.lower, exponent_, next_down);
        result.bounds.upper = scaled_back(result.bounds.upper, exponent_, next_up);
        for (double& value : result.witness.source_point) value = std::ldexp(value, -exponent_);
        for (double& value : result.witness.target_point) value = std::ldexp(value, -exponent_);
        for (TraceSample& sample : trace.samples()) {
            sample.lower = scaled_back(sample.lower, exponent_, next_down);
            sample.upper = scaled_back(sample.upper, exponent_, next_up);
        }
    }
    if (traces_) trace.finish(result.bounds.lower, result.bounds.upper);

    // Scaling back may have cost what the solver had promised.
    const Bounds& bounds = result.bounds;
    const bool close = bounds.gap() <= query.tolerance.gap(bounds.lower);
    const bool answered = bounds.lower > query.cutoff || bounds.upper <= query.cutoff;
    if (result.status == Status::converged && !close) result.status = Status::precision_floor;
    if (result.status == Status::cutoff_passed && !answered) result.status = Status::precision_floor;
    return result;
}

double Session::prepare_seconds() const {
    double sum = 0;
    for (const PreparationTime& part : preparation_) sum += part.seconds;
    return sum;
}

std::size_t Session::prepare_bytes() const {
    std::size_t sum = 0;
    for (const PreparationTime& part : preparation_) sum += part.bytes;
    return sum;
}

}  // namespace hausbench
