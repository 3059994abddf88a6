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

// Multiplies by 2^exponent; returns 2^-1074 where that rounded a coordinate (which underflowed: by half as much), else 0.
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
    if (!(query.floor >= 0) || std::isinf(query.floor)) fail("the floor", query.floor, "give a length, or 0 for none");
    if (!(query.cutoff >= 0)) fail("the cutoff", query.cutoff, "give a length, or infinity for none");
    if (!(query.time_limit >= 0)) fail("the time limit", query.time_limit, "give seconds, or infinity for none");
    if (!query.pose.rotation.allFinite() || !query.pose.translation.allFinite()) {
        throw InputError("query: the pose has an entry that is not finite; give a finite matrix and translation");
    }
}

bool claims_an_answer(Status status) {
    return status == Status::converged || status == Status::below_floor || status == Status::above_cutoff;
}

// A solver's word is not enough: its status has to follow from its bounds.
void hold_to_its_status(const Query& query, Result& result) {
    if (!claims_an_answer(result.status)) return;
    if (const auto answer = query.answer(result.bounds.lower, result.bounds.upper)) {
        result.status = *answer;
        return;
    }
    result.note = fmt::format("the solver reports {}, but {}", to_string(result.status),
                              result.status == Status::converged     ? "its gap is above the tolerance"
                              : result.status == Status::below_floor ? "its upper bound is above the floor"
                                                                     : "its lower bound is not above the cutoff");
    result.status = Status::stalled;
}

}  // namespace

std::string_view to_string(Status status) {
    constexpr std::string_view names[] = {"converged", "below_floor",     "above_cutoff", "time_limit",
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
    : entry_(entry), options_(options), leave_(leave), scene_(std::make_unique<Scene>(std::move(scene))) {
    const std::string no = refusal(entry.info, kind_of(scene_->source), kind_of(scene_->target));
    if (!no.empty()) throw InputError(no);

    Points& source = points_of(scene_->source);
    Points& target = points_of(scene_->target);
    const double largest = std::max(magnitude(source), magnitude(target));
    moveable_ = kind_of(scene_->source) != ShapeKind::surface;
    // The coefficients of a surface belong to its coordinates.
    scalable_ = !entry.info.original_coordinates && moveable_ && kind_of(scene_->target) != ShapeKind::surface;
    if (scalable_ && largest > 0) {
        std::frexp(largest, &exponent_);
        exponent_ = -exponent_;
        const double smallest = std::min(smallest_nonzero(source), smallest_nonzero(target));
        if (std::ldexp(smallest, exponent_) < std::numeric_limits<double>::min())
            original_ = std::make_unique<Scene>(*scene_);
        lost_source_ = scale(source, exponent_);
        lost_target_ = scale(target, exponent_);
        if (lost_source_ + lost_target_ == 0) original_.reset();
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
        return leave == Leave::nothing_out && !need.structure.fits(kind_of(shape));
    });
    prepared_ = std::make_unique<Prepared>(*scene_, needs_);
    preparation_ = prepared_->times();

    const auto begin = std::chrono::steady_clock::now();
    solver_->prepare(*scene_, *prepared_);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    preparation_.push_back({"solver", elapsed.count(), solver_->prepared_bytes()});
}

// At least the largest |coordinate| that any step of posing the source can reach, scaled: S below.
double Session::posed_extent(const Pose& pose) const {
    double translation = 0;
    for (const double t : pose.translation) translation = std::max(translation, std::abs(std::ldexp(t, exponent_)));
    return 3 * (pose.rotation.cwiseAbs().maxCoeff() * largest_) + translation;
}

// How far the points that the solver measures may be from those that the definition means, A's and B's together, in scaled
// units. The distance changes by no more.
//
// Scaling: a coordinate that it rounds is off by 2^-1075, so a point by less than 2^-1074, which is `lost`.
//
// Posing: in each coordinate the definition says D = s fl(R v + t), and the solver measures C = fl(R v' + t'), where s is the
// power of two 2^e, and v' and t' are the scaled v and t. Where v' = s v, t' = s t and no product underflows in either unit,
// they are the same bits: scaling by s commutes with each rounding, and a sum that underflows is exact. Otherwise both are
// held against the exact value s (R v + t). With r = max |R_ij| and S = 3 r max |v'| + max |t'|, the roundings of products and
// sums are 4u(1 + 4u) S on either side, each of the three products may lose 2^-1075 in its own unit, t' may lose 2^-1075, and
// the products carry what v' has lost, 3 r 2^-1075. With q = 2^(max(e, 0) - 1074), the coarser of the two units of underflow,
//   |C - D| <= 8.01 u S + (3 + 3 + 1) q / 2 + 1.5 r lost,
// and in length, with sqrt 3 < 1.733, 13.9 u S + 6.1 q + 2.6 r lost. What is computed below rounds by less than 8u of itself
// and underflows by less than q, and B has lost 0.9 q at most: 8 q covers the three.
double Session::widening(const Pose& pose) const {
    if (pose.is_identity()) return lost_source_ + lost_target_;
    if (exponent_ == 0) return 0;
    double least = std::numeric_limits<double>::infinity();
    for (const double entry : pose.rotation.reshaped()) {
        if (entry != 0) least = std::min(least, std::abs(entry));
    }
    const bool exact_translation = pose.translation.unaryExpr([&](double t) {
        return std::ldexp(std::ldexp(t, exponent_), -exponent_);
    }) == pose.translation;
    // Exponents, so that no product here underflows itself.
    const auto exponent_of = [](double x) { return std::isfinite(x) ? std::ilogb(x) : 0; };
    const int product = exponent_of(least) + exponent_of(smallest_);
    const bool same_bits = lost_source_ == 0 && exact_translation && product >= -1022 && product - exponent_ >= -1022;
    if (same_bits) return lost_target_;
    const double most = pose.rotation.cwiseAbs().maxCoeff();
    return 3 * (most * lost_source_) + 14 * unit_roundoff * posed_extent(pose) +
           8 * std::ldexp(1.0, std::max(exponent_, 0) - 1074);
}

Points Session::original(Side side) const {
    const auto of = [side](Scene& scene) -> Shape& { return side == Side::source ? scene.source : scene.target; };
    if (original_) return points_of(of(*original_));
    Points points = points_of(of(*scene_));
    scale(points, -exponent_);
    return points;
}

Result Session::solve_rescaled(const Query& query, Points source, Trace& trace) const {
    Scene scene = *scene_;
    points_of(scene.source) = std::move(source);
    points_of(scene.target) = original(Side::target);
    Query still = query;
    still.pose = Pose{};
    const double finest = query.tolerance.of == Tolerance::Of::absolute ? query.tolerance.value : 0;
    return Session(entry_, options_, std::move(scene), {false, 1, finest}, leave_).solve(still, trace);
}

Query Session::scaled(const Query& query) const {
    Query out = query;
    for (double& value : out.pose.translation) value = std::ldexp(value, exponent_);
    if (query.tolerance.of == Tolerance::Of::absolute) {
        out.tolerance.value = scaled_tolerance(query.tolerance.value, exponent_);
    }
    out.floor = std::ldexp(query.floor, exponent_);
    out.cutoff = std::ldexp(query.cutoff, exponent_);
    return out;
}

void Session::scale_back(Result& result, Trace& trace, double wider) const {
    const auto outward = [&](double& lower, double& upper) {
        if (wider > 0) {
            lower = std::max(0.0, next_down(lower - wider));
            upper = next_up(upper + wider);
        }
        if (exponent_ == 0) return;
        lower = scaled_back(lower, exponent_, next_down);
        upper = scaled_back(upper, exponent_, next_up);
    };
    outward(result.bounds.lower, result.bounds.upper);
    for (TraceSample& sample : trace.samples()) outward(sample.lower, sample.upper);
    for (double& value : result.witness.source_point) value = std::ldexp(value, -exponent_);
    for (double& value : result.witness.target_point) value = std::ldexp(value, -exponent_);
}

Result Session::solve(const Query& query, State* state, Trace& trace) const {
    check(query);
    if (!moveable_ && !query.pose.is_identity()) {
        throw InputError(
            "query: an algebraic surface cannot be moved; write the motion into its polynomial, or triangulate it "
            "first");
    }
    if (!query.pose.is_identity()) {
        const double extent = posed_extent(query.pose);
        if (!(extent <= largest_safe_coordinate && std::ldexp(extent, -exponent_) < 0x1p1023)) {
            Points source = posed(original(Side::source), query.pose);
            if (!source.allFinite()) {
                throw InputError(
                    "query: the pose moves a point of A beyond the largest double, 1.8e308; give a smaller rotation "
                    "and "
                    "translation, or both shapes in a larger unit");
            }
            if (scalable_ && std::ldexp(magnitude(source), exponent_) > largest_safe_coordinate)
                return solve_rescaled(query, std::move(source), trace);
        }
    }

    const Query asked = scaled(query);
    trace.start(exponent_);
    Result result = solver_->solve(asked, state, trace);
    hold_to_its_status(asked, result);
    scale_back(result, trace, widening(query.pose));
    if (entry_.info.traces) trace.finish(result.bounds.lower, result.bounds.upper);

    // Scaling back may have cost what the solver had promised.
    if (claims_an_answer(result.status))
        result.status = query.answer(result.bounds.lower, result.bounds.upper).value_or(Status::precision_floor);
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
