#include "algorithms/session/scaled.h"

#include "algorithms/error.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace hausbench {
namespace {

// Scales a bound back to the unit of the input. If this rounds, widens the result with `outward`, which is next_down
// for a lower bound and next_up for an upper bound.
double scaled_back(double value, int exponent, double (*outward)(double)) {
    const double original = std::ldexp(value, -exponent);
    return std::ldexp(original, exponent) == value || std::isinf(value) ? original : outward(original);
}

// Scales a point back to the unit of the input. Returns whether this rounded a coordinate; the rounding error is at
// most 2^-1075, half of the least positive double.
bool scaled_back(Vec3& point, int exponent) {
    bool rounded = false;
    for (double& value : point) {
        const double original = std::ldexp(value, -exponent);
        rounded |= std::isfinite(value) && std::ldexp(original, exponent) != value;
        value = original;
    }
    return rounded;
}

// Scales a length and keeps it positive and finite.
double scaled_tolerance(double value, int exponent) {
    return std::clamp(std::ldexp(value, exponent), std::numeric_limits<double>::denorm_min(),
                      std::numeric_limits<double>::max());
}

// Returns an upper bound, in scaled units, on the absolute value of every number that occurs while the points of a
// shape are moved by the pose, including products and partial sums. The derivation of widening() calls it S.
double posed_extent(const PreparedShape& shape, const Pose& pose) {
    double translation = 0;
    for (const double t : pose.translation)
        translation = std::max(translation, std::abs(std::ldexp(t, shape.exponent())));
    return WATCHED("session: the extent of the rotation", 3 * (pose.rotation.cwiseAbs().maxCoeff() * shape.largest())) +
           WATCHED("session: the extent of the translation", translation);
}

// Returns how far the points of a shape, as the solver sees them, may be from the points that the query is about, in
// scaled units. The query is about points that are posed and rounded in the unit of the input; the solver scales
// first, and poses and rounds in scaled units. The distance between the shapes changes by at most the sum of the
// results for A and B.
//
// Without a pose, only scaling counts. A rounded coordinate is off by at most 2^-1075, so a point by less than
// 2^-1074, which is shape.lost().
//
// With a pose, the query is about the point fl(R * v + t), and the solver measures fl(R * v' + t'). Let e be the
// exponent, and s = 2^e the factor by which shapes are scaled; v' and t' are s * v and s * t as rounded. Let C be a
// coordinate of the second point, and D the same coordinate of the first point times s.
//
// If v' = s * v and t' = s * t, and no product underflows in either unit, then C = D: scaling by s commutes with each
// rounding, and a sum that underflows is exact.
//
// Otherwise both are compared with the exact value s * (R * v + t). Let r = max|R_ij| and
// S = 3 * r * max|v'| + max|t'|. Let q = 2^(max(e, 0) - 1074), so that an underflow in either unit loses at most q / 2
// in scaled units.
//   - Rounding products and sums costs 4u * (1 + 4u) * S for each of C and D: 8.01u * S.
//   - Three products for C and three for D may underflow, and so may t': (3 + 3 + 1) * q / 2.
//   - The products for C contain the error of v': 3 * r * 2^-1075 = 1.5 * r * lost.
// So |C - D| <= 8.01u * S + 3.5 * q + 1.5 * r * lost and, in length, with sqrt(3) < 1.733, at most
//     13.9u * S + 6.1 * q + 2.6 * r * lost.
// The code uses 14, 8 and 3 instead of 13.9, 6.1 and 2.6. The rest covers its own rounding, which is less than 8u of
// the result, and its own underflow, which is less than q.
double widening(const PreparedShape& shape, const Pose& pose) {
    const int exponent = shape.exponent();
    if (pose.is_identity()) return WATCHED("session: what scaling a shape at rest loses", shape.lost());
    if (exponent == 0) return 0;
    double least = infinity;
    for (const double entry : pose.rotation.reshaped()) {
        if (entry != 0) least = std::min(least, std::abs(entry));
    }
    const bool exact_translation = pose.translation.unaryExpr([&](double t) {
        return std::ldexp(std::ldexp(t, exponent), -exponent);
    }) == pose.translation;
    // A lower bound on the exponent of every nonzero product of a matrix entry and a coordinate. Exponents are added
    // because the product itself may underflow.
    const auto exponent_of = [](double x) { return std::isfinite(x) ? std::ilogb(x) : 0; };
    const int product = exponent_of(least) + exponent_of(shape.smallest());
    const bool same_bits =
        WATCHED_ELSE("session: a source that lost something is not posed to the same bits", shape.lost() == 0, true) &&
        WATCHED_ELSE("session: a translation that underflows", exact_translation, true) &&
        WATCHED_ELSE("session: products that underflow in scaled units", product >= -1022, true) &&
        WATCHED_ELSE("session: products that underflow in the units of the input", product - exponent >= -1022, true);
    if (same_bits) return 0;
    const double most = pose.rotation.cwiseAbs().maxCoeff();
    return WATCHED("session: what a pose makes of the source's loss", 3 * (most * shape.lost())) +
           WATCHED("session: roundings of a pose", 14 * unit_roundoff * posed_extent(shape, pose)) +
           WATCHED("session: underflows of a pose",
                   8 * std::ldexp(1.0, WATCHED("session: the unit in which products underflow", std::max(exponent, 0)) -
                                           1074));
}

Pose scaled(Pose pose, int exponent) {
    for (double& value : pose.translation) value = std::ldexp(value, exponent);
    return pose;
}

Query scaled(const Query& query, int exponent) {
    Query out = query;
    out.source_pose = scaled(query.source_pose, exponent);
    out.target_pose = scaled(query.target_pose, exponent);
    if (WATCHED("session: the tolerance in scaled units", query.tolerance.of == Tolerance::Of::absolute))
        out.tolerance.value = scaled_tolerance(query.tolerance.value, exponent);
    out.floor = std::min(std::ldexp(query.floor, exponent),
                         WATCHED_ELSE("session: a floor stays finite", std::numeric_limits<double>::max(), infinity));
    out.cutoff = std::ldexp(query.cutoff, exponent);
    for (Statistic& statistic : out.statistics)
        if (WATCHED("distribution: lengths of statistics are scaled", takes_length(statistic)))
            statistic.argument = std::ldexp(statistic.argument, exponent);
    return out;
}

// Scales the bounds of statistics back to the unit of the input. If scaling or posing rounded the shapes (`wider` > 0),
// their areas may have changed by any factor, because a triangle may be as small as the rounding error, so the bounds
// become trivial. They also become trivial for the share within a length that scaling rounds. If scaling back rounded
// the witness of the first statistic, the lower bound decreases by as much, see scale_back().
void scale_statistics_back(const Query& query, Result& result, int exponent, double wider, bool witness_rounded) {
    for (std::size_t i = 0; i < std::min(result.statistics.size(), query.statistics.size()); ++i) {
        const Statistic& statistic = query.statistics[i];
        Bounds& bounds = result.statistics[i];
        if (takes_length(statistic)) {
            const bool exact = std::ldexp(std::ldexp(statistic.argument, exponent), -exponent) == statistic.argument ||
                               std::isinf(std::ldexp(statistic.argument, exponent));
            if (wider > 0 || WATCHED("distribution: a length that scaling rounds", !exact))
                bounds = is_share(statistic) ? Bounds{0, 1} : Bounds{};
        }
        if (is_share(statistic)) {
            if (wider > 0) bounds = {0, 1};
        } else if (WATCHED("distribution: areas of shapes that scaling changes are unknown", wider > 0)) {
            bounds = {};
        } else {
            bounds = {scaled_back(bounds.lower, exponent, next_down), scaled_back(bounds.upper, exponent, next_up)};
            if (i == 0 && WATCHED("scaled: a witness of statistics that scaling back rounded", witness_rounded))
                bounds.lower = next_down(bounds.lower);
            bounds.lower = std::max(bounds.lower, 0.0);
        }
    }
    if (!result.statistics.empty()) result.bounds = result.statistics.front();
}

// Scales an answer back to the unit of the input, after widening its bounds by `wider`, a length in scaled units.
// Returns whether this rounded the far point of the witness.
bool scale_back(Result& result, Trace& trace, int exponent, double wider) {
    const bool source_rounded = scaled_back(result.witness.source_point, exponent);
    const bool target_rounded = scaled_back(result.witness.target_point, exponent);
    const bool forward = result.witness.direction == Witness::Direction::source_to_target;
    const bool point_rounded = forward ? source_rounded : target_rounded;
    const auto down = [&](double& lower) {
        if (wider > 0) lower = std::max(0.0, next_down(lower - wider));
        if (exponent != 0)
            lower =
                std::max(scaled_back(lower, exponent, next_down),
                         WATCHED_ELSE("session: a lower bound that is scaled back is not negative", 0.0, -infinity));
        // The bound must hold for the witness point as reported. Rounding moved this point by less than 2^-1074;
        // next_down() subtracts at least as much.
        if (WATCHED("session: a witness point that scaling back rounds", point_rounded))
            lower =
                std::max(next_down(lower),
                         WATCHED_ELSE("session: a lower bound below a rounded point is not negative", 0.0, -infinity));
    };
    const auto up = [&](double& upper) {
        if (wider > 0) upper = next_up(upper + wider);
        if (exponent != 0)
            upper =
                scaled_back(WATCHED_ELSE("session: an upper bound that is too small, replayed", upper, 0.999 * upper),
                            exponent, next_up);
    };
    for_each_bound(result, trace, down, up);
    for (Certificate& certificate : result.certificates)
        if (WATCHED("session: what a certificate proves is scaled back", true)) up(certificate.proven);
    for (auto& [name, value] : result.reported) {
        auto* length = std::get_if<double>(&value);
        if (WATCHED("session: lengths that a solver reports are scaled back",
                    length && name.starts_with(length_prefix)))
            *length = std::ldexp(*length, -exponent);
    }
    return point_rounded;
}

// Sets the witness point of a point set to the point of the input, moved by `pose`. Scaling may have rounded the point
// by which the solver found it; the bounds allow for that (`wider` in Scaled::answer).
void restore_point(const PreparedShape& shape, const Pose& pose, Index element, Vec3& point) {
    if (shape.lost() == 0 || kind_of(shape.shape()) != ShapeKind::points) return;
    const Points& points = shape.original();
    if (element >= 0 && element < points.rows()) point = posed(points.middleRows(element, 1), pose).row(0);
}

}  // namespace

PreparedPair prepare_pair(const SolverInfo& info, Shape source, Shape target) {
    if (!scalable(info, kind_of(source), kind_of(target)))
        return {std::make_shared<PreparedShape>(std::move(source)), std::make_shared<PreparedShape>(std::move(target))};
    const int exponent = scale_exponent(std::max(magnitude(points_of(source)), magnitude(points_of(target))));
    return {std::make_shared<PreparedShape>(std::move(source), exponent),
            std::make_shared<PreparedShape>(std::move(target), exponent)};
}

bool scalable(const SolverInfo& info, ShapeKind source, ShapeKind target) {
    // A surface cannot be scaled: it is given by the coefficients of a polynomial in the coordinates of the input.
    return !info.original_coordinates && source != ShapeKind::surface && target != ShapeKind::surface;
}

Scaled::Scaled(const SolverInfo& info, PreparedPair pair, std::unique_ptr<Solver> solver, Make make)
    : info_(info),
      pair_(std::move(pair)),
      scalable_(scalable(info, kind_of(pair_.source->shape()), kind_of(pair_.target->shape()))),
      solver_(std::move(solver)),
      make_(std::move(make)) {}

// Returns whether the pose makes coordinates so large that both shapes must be scaled anew. Throws InputError if the
// pose moves a surface or makes a coordinate that is not finite; the message calls the shape `name`.
bool Scaled::leaves_range(const PreparedShape& shape, const Pose& pose, const char* name) const {
    if (pose.is_identity()) return false;
    if (kind_of(shape.shape()) == ShapeKind::surface) {
        throw InputError(
            "query: an algebraic surface cannot be moved; write the motion into its polynomial, or triangulate it "
            "first");
    }
    const double extent = posed_extent(shape, pose);
    if (extent <= largest_safe_coordinate && std::ldexp(extent, -shape.exponent()) < 0x1p1023) return false;
    const Points there = posed(shape.original(), pose);
    if (WATCHED("session: a posed shape that is not finite", !there.allFinite())) {
        throw InputError(fmt::format(
            "query: the pose moves a point of {} beyond the largest double, 1.8e308; give a smaller rotation "
            "and translation, or both shapes in a larger unit",
            name));
    }
    return WATCHED("session: scaling by the posed extents",
                   scalable_ && std::ldexp(magnitude(there), shape.exponent()) > largest_safe_coordinate);
}

// Returns whether the poses make both shapes so small that products of coordinates would underflow. Checks 64 points at
// a time and stops at the first that is large enough. A coordinate of 0 counts as small, because it may have
// underflowed when the shape was scaled.
bool Scaled::shrinks(const Query& query) const {
    if (!scalable_ || (query.source_pose.is_identity() && query.target_pose.is_identity())) return false;
    double most = 0;
    for (const auto& [shape, pose] :
         {std::pair{pair_.source.get(), &query.source_pose}, std::pair{pair_.target.get(), &query.target_pose}}) {
        constexpr Eigen::Index some = 64;
        const Points& points = points_of(shape->shape());
        const Pose there = scaled(*pose, shape->exponent());
        for (Eigen::Index i = 0; i < points.rows() && most < smallest_safe_magnitude; i += some)
            most = std::max(most, magnitude(posed(points.middleRows(i, std::min(some, points.rows() - i)), there)));
    }
    return WATCHED("session: poses that shrink both shapes",
                   WATCHED_ELSE("session: poses that shrink both shapes to nothing in scaled units",
                                most < smallest_safe_magnitude, (most > 0 && most < smallest_safe_magnitude)));
}

// Poses both shapes in the unit of the input, then scales them by a new power of two.
PreparedPair Scaled::at_rest(const Query& query) const {
    const auto shape_there = [](const PreparedShape& prepared, const Pose& pose) {
        Shape shape = prepared.shape();
        points_of(shape) = posed(prepared.original(), pose);
        return shape;
    };
    return prepare_pair(
        info_, shape_there(*pair_.source, query.source_pose),
        shape_there(*pair_.target, WATCHED_ELSE("session: the far target is posed", query.target_pose, Pose{})));
}

Result Scaled::solve(const Query& query, State* state, Trace& trace) const {
    // Check both shapes before any decision, so that an invalid pose of either is always refused.
    const bool source_far = leaves_range(*pair_.source, query.source_pose, "A");
    const bool target_far =
        WATCHED("session: a target that leaves the range", leaves_range(*pair_.target, query.target_pose, "B"));
    // Statistics do not survive a rounded pose (scale_statistics_back), so such shapes are posed in their own unit.
    const bool inexact = query.quantity == Quantity::distribution &&
                         widening(*pair_.source, query.source_pose) + widening(*pair_.target, query.target_pose) > 0;
    if (!source_far && !target_far && !shrinks(query) && !inexact) return answer(*solver_, pair_, query, state, trace);
    Query still = query;
    still.source_pose = still.target_pose = Pose{};
    QuerySet once;
    once.finest_tolerance = query.tolerance.of == Tolerance::Of::absolute ? query.tolerance.value : 0;
    once.symmetric = query.quantity == Quantity::symmetric;
    once.both_ways = std::any_of(query.statistics.begin(), query.statistics.end(), needs_target);
    once.threads = query.threads;
    const PreparedPair pair = at_rest(query);
    const auto made = [&] {
        const Stoppable stoppable(WATCHED("session: building for a far pose asks no interrupt", query.interrupt));
        return make_(pair, once);
    };
    return answer(*made(), pair, still, nullptr, trace);
}

Result Scaled::answer(const Solver& solver, const PreparedPair& pair, const Query& query, State* state,
                      Trace& trace) const {
    const int exponent = pair.source->exponent();
    const double wider =
        WATCHED("session: what scaling the source loses", widening(*pair.source, query.source_pose)) +
        WATCHED("session: what scaling the target loses",
                widening(*pair.target, WATCHED_ELSE("session: what a posed target loses", query.target_pose, Pose{})));
    trace.start(exponent);
    Result result;
    {
        const Trace::Changing back(trace, [&](Result& so_far) {
            Trace none;
            if (WATCHED("trace: what is shown is scaled back", true)) scale_back(so_far, none, exponent, wider);
            scale_statistics_back(query, so_far, exponent, wider, false);
        });
        result = solver.solve(scaled(query, exponent), state, trace);
    }
    const bool witness_rounded = scale_back(result, trace, exponent, wider);
    if (WATCHED("session: the witness's point of the source stays as scaling left it", true))
        restore_point(*pair.source, query.source_pose, result.witness.source_element, result.witness.source_point);
    if (WATCHED("session: the witness's point of the target stays as scaling left it", true))
        restore_point(*pair.target, query.target_pose, result.witness.target_element, result.witness.target_point);
    if (query.quantity == Quantity::distribution) {
        scale_statistics_back(query, result, exponent, wider, witness_rounded);
        if (result.status == Status::converged && !query.within_tolerance(result.statistics))
            result.status = Status::precision_floor;
        return result;
    }
    if (info_.can(Ability::traces)) trace.finish(result.bounds.lower, result.bounds.upper);
    // If the widened bounds no longer justify the status, the tolerance is below the precision of doubles.
    if (claims_an_answer(result.status))
        result.status = query.answer(result.bounds.lower, result.bounds.upper).value_or(Status::precision_floor);
    return result;
}

}  // namespace hausbench
