#include "algorithms/session/moving_target.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"

#include <cmath>
#include <utility>

namespace hausbench {
namespace {

// How to undo the motion g of a target: leave the target in place, and move the source to another pose instead.
// Rounding changes a distance d by at most stretch * d + wider.
struct Undone {
    Pose source, back;   // the other pose of the source; g, to move witness points back
    double stretch = 0;  // more than 0 because g may not be perfectly rigid
    double wider = 0;    // all other rounding
    double slack = 0;    // upper bound on the total change, over all distances that can occur
};

double largest(const auto& entries) { return entries.cwiseAbs().maxCoeff(); }

// Returns how to undo the motion g; nothing if g is not rigid, or if coordinates become too large or too small.
//
// The query is about A posed by p(x) = P * x + s and B posed by g(x) = R * x + t, and about their points as rounded.
// The solver measures B without a motion against A posed by q(x) = Q * x + w, where Q = fl(R^T * P) and
// w = fl(R^T * (s - t)). So q is p followed by the inverse of g, up to rounding.
//
// `stretch`: |g(x) - g(y)|^2 = (x - y)^T * R^T * R * (x - y), so g multiplies any distance by a factor between 1 - e
// and 1 + e, where e is the Frobenius norm |R^T * R - I|.
//
// `wider`, first part, in exact arithmetic: g(q(x)) - p(x) = (R * Q - P) * x + (R * w + t - s). Let M_A be the largest
// |coordinate| of A. In each coordinate, the difference is at most 3 * max|R * Q - P| * M_A + max|R * w + t - s|,
// where max|.| is the largest |entry|; its length is at most sqrt(3) < 1.74 times this. This covers corners, and
// points of faces move no farther than corners.
//
// `wider`, second part, for rounding: let S_p, S_q and S_g be the largest |coordinate| in any step of posing A by p, A
// by q and B by g, and u = 2^-53. In each coordinate:
//   - The residuals R * Q - P (times x) and R * w + t - s, as computed, err by 4u * (3.01 * S_q + S_p) and
//     5u * (3.01 * S_q + S_p + S_g).
//   - Each of the three posings errs by 4.1u times its S. The error of posing by q is then turned by g. Together
//     4.1u * (1.01 * S_q + S_p + S_g).
//   - The two points of the witness are moved by g and rounded. The source point is then off by
//     4.1u * (3.01 * S_q + S_g), the target point by 4.1u * S_g. The error of the source point counts twice, because
//     the lower bound must hold for the witness as shown, whose source point is off A by as much.
// The sum is at most 56u * S_q + 14u * S_p + 22u * S_g in each coordinate, and sqrt(3) times this in length, which is
// less than 100u * (S_p + S_q + S_g).
std::optional<Undone> undo(double source_largest, const Pose& p, double target_largest, const Pose& g) {
    Undone undone;
    undone.back = g;
    const Eigen::Matrix3d& r = g.rotation;
    const double stretch = (r.transpose() * r - Eigen::Matrix3d::Identity()).norm();
    if (WATCHED("undone motion: only rigid ones", !(stretch <= 0x1p-40))) return std::nullopt;
    // 32u: the norm itself is rounded; entries of R are about 1 at most
    undone.stretch = WATCHED("undone motion: what it stretches", stretch + 32 * unit_roundoff);
    undone.source.rotation = r.transpose() * p.rotation;
    undone.source.translation = r.transpose() * (p.translation - g.translation);
    const Pose& q = undone.source;
    const auto extent = [](double most, const Pose& pose) {
        return 3 * (largest(pose.rotation) * most) + largest(pose.translation);
    };
    const double posed_by_q = extent(source_largest, q);
    const double rounding = 100 * unit_roundoff * (extent(source_largest, p) + posed_by_q + extent(target_largest, g));
    const double turned = 3 * (largest(r * q.rotation - p.rotation) * source_largest);
    const double moved = largest(r * q.translation + g.translation - p.translation);
    undone.wider = 1.74 * (WATCHED("undone motion: the product of the matrices", turned) +
                           WATCHED("undone motion: the sum of the translations", moved)) +
                   WATCHED("undone motion: rounding", rounding);
    undone.slack = undone.wider + undone.stretch * (4 * (posed_by_q + target_largest));
    // Coordinates must be neither too large for the solver nor so small that the sums above underflow.
    const double most = std::max(posed_by_q, target_largest);
    if (!(WATCHED_ELSE("undone motion: what is left is too small", most >= 0x1p-300, true) &&
          most <= largest_safe_coordinate))
        return std::nullopt;
    return undone;
}

// Returns how to undo the motion of the target of a query, or nullopt if this is impossible or not allowed (see
// MovingTarget). Point sets are excluded because a witness must be exactly one of their points, and moving it back
// rounds it.
std::optional<Undone> undo(const SolverInfo& info, const Query& query, const ShapeExtent& source,
                           const ShapeExtent& target) {
    if (!info.can(Ability::undone_motion) ||
        WATCHED("undone motion: not of a solver that takes it", info.can(Ability::moving_target)) ||
        source.kind != ShapeKind::mesh || target.kind != ShapeKind::mesh || query.target_pose.is_identity() ||
        query.wanted.certificate)
        return std::nullopt;
    const bool asks = query.is_question();
    if (WATCHED("undone motion: is h above this?", asks) || query.tolerance.of != Tolerance::Of::absolute)
        return std::nullopt;
    std::optional<Undone> undone = undo(source.largest, query.source_pose, target.largest, query.target_pose);
    if (undone && !(64 * undone->slack <= query.tolerance.value)) undone.reset();
    return undone;
}

// Returns the query to solve instead of `query` if the motion is undone. move_back() turns its answer into an answer to
// `query`.
Query undone_query(const Query& query, const Undone& undone) {
    Query changed = query;
    changed.source_pose = undone.source;
    changed.target_pose = Pose{};
    changed.tolerance.value -= WATCHED("undone motion: room in the tolerance", 4 * undone.slack);
    changed.floor = std::max(query.floor - WATCHED("undone motion: room at the floor", undone.slack), 0.0);
    changed.cutoff = query.cutoff + WATCHED("undone motion: room at the cutoff", undone.slack);
    return changed;
}

// Turns an answer to undone_query() into an answer to the original query: widens the bounds and moves the witness
// points back.
void move_back(Result& result, Trace& trace, const Undone& undone) {
    const auto down = [&](double& lower) {
        lower = std::max(0.0, WATCHED_ELSE("undone motion: the lower bound",
                                           next_down(lower * (1 - undone.stretch) - undone.wider), lower));
    };
    const auto up = [&](double& upper) { upper = next_up(upper * (1 + undone.stretch) + undone.wider); };
    for_each_bound(result, trace, down, up);
    for (Vec3* point : {&result.witness.source_point, &result.witness.target_point})
        if (WATCHED("undone motion: the witness", true))
            *point = undone.back.rotation * *point + undone.back.translation;
}

ShapeExtent extent_of(const PreparedShape& shape) { return {kind_of(shape.shape()), shape.largest()}; }

}  // namespace

bool copies_targets(const SolverInfo& info, const Query& query, const ShapeExtent& source, const ShapeExtent& target) {
    if (info.can(Ability::moving_target)) return false;
    const auto copied = [&](const Query& directed, const ShapeExtent& a, const ShapeExtent& b) {
        return !directed.target_pose.is_identity() && !undo(info, directed, a, b);
    };
    Query back = query;
    std::swap(back.source_pose, back.target_pose);
    const bool both = query.quantity == Quantity::symmetric && !info.offers(Quantity::symmetric);
    return copied(query, source, target) || (both && copied(back, target, source));
}

// The state of a chain of nearby poses. The first answer makes the state of the wrapped solver, because a solver over a
// copy of the target does not exist before.
struct MovingTarget::Chain final : State {
    std::unique_ptr<State> of_solver;
    const Chain* opposite = nullptr;  // from learn_from(); the next answer passes it on to the solver

    void learn_from(const State& other) override { opposite = static_cast<const Chain*>(&other); }
};

MovingTarget::MovingTarget(std::shared_ptr<const SolverMaker> maker, SharedPreparedShape source,
                           SharedPreparedShape target, const QuerySet& queries)
    : maker_(std::move(maker)), source_(std::move(source)), target_(std::move(target)), queries_(queries) {}

Books MovingTarget::keep() {
    const SolverInfo& info = maker_->info();
    QuerySet queries = queries_;
    const bool undone = queries.target_moves && !queries.target_copied && info.can(Ability::undone_motion);
    if (undone) queries.moves = true;
    if (!queries.target_moves || info.can(Ability::moving_target) || undone) {
        kept_ = std::make_unique<PreparedSolver>(*maker_, source_, target_, queries);
        return kept_->books();
    }
    Needs needs = maker_->needs_of(*maker_->make(), {source_->shape(), target_->shape()}, queries);
    std::erase_if(needs, [](const Need& need) { return need.side == Side::target; });
    return {needs, Prepared(source_, target_, needs, maker_->builders(queries)).times()};
}

std::unique_ptr<State> MovingTarget::begin() const { return std::make_unique<Chain>(); }

// Makes a solver for one answer and builds its structures over the target anew, so that concurrent answers never share
// a structure that is still being built. If the query moves the target and the solver does not support that, builds
// them over a moved copy of the target and removes the pose of the target from `query`.
std::unique_ptr<PreparedSolver> MovingTarget::prepared_over_a_copy(Query& query) const {
    SharedShape still = target_->shape();
    if (!query.target_pose.is_identity() && !maker_->info().can(Ability::moving_target)) {
        Shape shape = target_->shape();
        if (WATCHED("session: the copy is posed", true)) points_of(shape) = posed(points_of(shape), query.target_pose);
        still = std::move(shape);
        if (WATCHED("session: the posed copy is at rest for the solver", true)) query.target_pose = Pose{};
    }
    QuerySet once = queries_;
    once.moves = WATCHED_ELSE("session: moves of an answer", queries_.moves || !query.source_pose.is_identity(), true);
    if (WATCHED("session: a posed copy is at rest", true)) once.target_moves = !query.target_pose.is_identity();
    once.threads = query.threads;
    return std::make_unique<PreparedSolver>(*maker_, source_, std::make_shared<PreparedShape>(std::move(still)), once);
}

Result MovingTarget::solve(const Query& query, State* state, Trace& trace) const {
    const WallClock clock;
    auto* chain = static_cast<Chain*>(state);
    const Chain* opposite = chain ? std::exchange(chain->opposite, nullptr) : nullptr;
    const SolverInfo& info = maker_->info();
    const std::optional<Undone> undone = undo(info, query, extent_of(*source_), extent_of(*target_));
    Query inner = undone ? undone_query(query, *undone) : query;
    std::unique_ptr<PreparedSolver> made;
    if (!kept_ || (!info.can(Ability::moving_target) && !inner.target_pose.is_identity())) {
        const Stoppable stoppable(query.interrupt);
        made = WATCHED_ELSE(
            "session: a target at rest has structures of its own in a moving session", prepared_over_a_copy(inner),
            inner.target_pose.is_identity() ? std::make_unique<PreparedSolver>(*maker_, source_, target_, queries_)
                                            : prepared_over_a_copy(inner));
        if (WATCHED("session: the time that a posed copy took", true)) inner.time_limit = clock.left(inner.time_limit);
    }
    const PreparedSolver& solver = made ? *made : *kept_;
    if (chain && !chain->of_solver) chain->of_solver = solver.begin();
    State* inner_state = chain ? chain->of_solver.get() : nullptr;
    if (inner_state && opposite && opposite->of_solver) inner_state->learn_from(*opposite->of_solver);
    if (!undone) return solver.solve(inner, inner_state, trace);
    Result result;
    {
        const Trace::Changing back(trace, [&](Result& so_far) {
            Trace none;
            move_back(so_far, none, *undone);
        });
        result = solver.solve(inner, inner_state, trace);
    }
    move_back(result, trace, *undone);
    return result;
}

}  // namespace hausbench
