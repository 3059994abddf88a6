#include "algorithms/session/moving_target.h"

#include "algorithms/kernel/rounding.h"

#include <cmath>
#include <utility>

namespace hausbench {
namespace {

// How to undo the motion g of a target: measure the source in another pose against the target at rest.
struct Undone {
    Pose source, back;   // the other pose, and g, which moves a witness back
    double stretch = 0;  // g changes a distance by at most this fraction of it
    double wider = 0;    // everything else changes it by at most this length
    double slack = 0;    // bound of both for every distance that can occur
};

double largest(const auto& entries) { return entries.cwiseAbs().maxCoeff(); }

// A is posed by p(x) = P x + s and B by g(x) = R x + t; the distance is between their points as rounded. The solver
// measures B at rest against A posed by q(x) = Q x + w, where Q = fl(R^T P) and w = fl(R^T (s - t)), so q is about
// p followed by the inverse of g.
//
// Stretch. |g(x) - g(y)|^2 = (x - y)^T R^T R (x - y), so g changes no distance by more than a factor of
// 1 -+ |R^T R - I|, in the Frobenius norm.
// Wider. g(q(x)) - p(x) = (R Q - P) x + (R w + t - s). With M_A the largest |coordinate| of A, this is at most
// 3 max|R Q - P| M_A + max|R w + t - s| in each coordinate, and sqrt 3 < 1.74 times that in length. Faces move no
// farther than their corners.
// Rounding. S_p, S_q, S_g are the largest |coordinate| in any step of posing A by p, A by q, B by g. In each
// coordinate, with u = 2^-53:
//   - The two residuals as computed err by 4u (3.01 S_q + S_p) and 5u (3.01 S_q + S_p + S_g).
//   - Posing errs by 4.1u S each, and the error of posing by q is then turned by g: 4.1u (1.01 S_q + S_p + S_g).
//   - Points of the witness are moved by g and rounded, 4.1u (3.01 S_q + S_g) and 4.1u S_g. The lower bound must
//     hold for the witness as shown, which is off A by as much, so this counts twice.
// Together this is at most 56u S_q + 14u S_p + 22u S_g, and in length 100u (S_p + S_q + S_g).
std::optional<Undone> undo(double source_largest, const Pose& p, double target_largest, const Pose& g) {
    Undone undone;
    undone.back = g;
    const Eigen::Matrix3d& r = g.rotation;
    const double stretch = (r.transpose() * r - Eigen::Matrix3d::Identity()).norm();
    if (!(stretch <= 0x1p-40)) return std::nullopt;
    undone.stretch = stretch + 32 * unit_roundoff;  // for its own rounding: entries of R are hardly more than 1
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
    undone.wider = 1.74 * (turned + moved) + rounding;
    undone.slack = undone.wider + undone.stretch * (4 * (posed_by_q + target_largest));
    // Coordinates must be neither too large for the solver nor so small that the sums above underflow.
    const double most = std::max(posed_by_q, target_largest);
    if (!(most >= 0x1p-300 && most <= largest_safe_coordinate)) return std::nullopt;
    return undone;
}

// Point sets are excluded because their witness must be one of their points, to the bit.
std::optional<Undone> undo(const SolverInfo& info, const Query& query, const ShapeExtent& source,
                           const ShapeExtent& target) {
    if (!info.can(Ability::undone_motion) || info.can(Ability::moving_target) || source.kind != ShapeKind::mesh ||
        target.kind != ShapeKind::mesh || query.target_pose.is_identity() || query.wanted.certificate)
        return std::nullopt;
    const bool asks = query.floor >= query.cutoff;
    if (asks || query.tolerance.of != Tolerance::Of::absolute) return std::nullopt;
    std::optional<Undone> undone = undo(source.largest, query.source_pose, target.largest, query.target_pose);
    if (undone && !(64 * undone->slack <= query.tolerance.value)) undone.reset();
    return undone;
}

// Returns the query to ask so that its answer, after move_back(), answers `query`.
Query undone_query(const Query& query, const Undone& undone) {
    Query asked = query;
    asked.source_pose = undone.source;
    asked.target_pose = Pose{};
    asked.tolerance.value -= 4 * undone.slack;
    asked.floor = std::max(query.floor - undone.slack, 0.0);
    asked.cutoff = query.cutoff + undone.slack;
    return asked;
}

void move_back(Result& result, Trace& trace, const Undone& undone) {
    const auto down = [&](double& lower) {
        lower = std::max(0.0, next_down(lower * (1 - undone.stretch) - undone.wider));
    };
    const auto up = [&](double& upper) { upper = next_up(upper * (1 + undone.stretch) + undone.wider); };
    for_each_bound(result, trace, down, up);
    for (Vec3* point : {&result.witness.source_point, &result.witness.target_point})
        *point = undone.back.rotation * *point + undone.back.translation;
}

ShapeExtent extent_of(const PreparedShape& shape) { return {kind_of(shape.shape()), shape.largest()}; }

}  // namespace

bool copies_targets(const SolverInfo& info, const Query& query, const ShapeExtent& source, const ShapeExtent& target) {
    if (info.can(Ability::moving_target)) return false;
    const auto copied = [&](const Query& one, const ShapeExtent& a, const ShapeExtent& b) {
        return !one.target_pose.is_identity() && !undo(info, one, a, b);
    };
    Query back = query;
    std::swap(back.source_pose, back.target_pose);
    const bool both = query.quantity == Quantity::symmetric && !info.offers(Quantity::symmetric);
    return copied(query, source, target) || (both && copied(back, target, source));
}

// The solver's state. The first answer makes it, because a solver over a copy does not exist before.
struct MovingTarget::Chain final : State {
    std::unique_ptr<State> of_solver;
    const Chain* opposite = nullptr;  // for the next answer

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

// Makes a solver for one answer, with its own structures over the target, so every pose pays for them and concurrent answers share
// nothing unfinished. Changes the query to one about a target at rest.
std::unique_ptr<PreparedSolver> MovingTarget::prepared_over_a_copy(Query& query) const {
    SharedShape still = target_->shape();
    if (!query.target_pose.is_identity() && !maker_->info().can(Ability::moving_target)) {
        Shape shape = target_->shape();
        points_of(shape) = posed(points_of(shape), query.target_pose);
        still = std::move(shape);
        query.target_pose = Pose{};
    }
    QuerySet once = queries_;
    once.moves = queries_.moves || !query.source_pose.is_identity();
    once.target_moves = !query.target_pose.is_identity();
    once.threads = query.threads;
    return std::make_unique<PreparedSolver>(*maker_, source_, std::make_shared<PreparedShape>(std::move(still)), once);
}

Result MovingTarget::solve(const Query& query, State* state, Trace& trace) const {
    const WallClock clock;
    auto* chain = static_cast<Chain*>(state);
    const Chain* opposite = chain ? std::exchange(chain->opposite, nullptr) : nullptr;
    const SolverInfo& info = maker_->info();
    const std::optional<Undone> undone = undo(info, query, extent_of(*source_), extent_of(*target_));
    Query asked = undone ? undone_query(query, *undone) : query;
    std::unique_ptr<PreparedSolver> made;
    if (!kept_ || (!info.can(Ability::moving_target) && !asked.target_pose.is_identity())) {
        made = prepared_over_a_copy(asked);
        asked.time_limit = clock.left(asked.time_limit);
    }
    const PreparedSolver& solver = made ? *made : *kept_;
    if (chain && !chain->of_solver) chain->of_solver = solver.begin();
    State* own = chain ? chain->of_solver.get() : nullptr;
    if (own && opposite && opposite->of_solver) own->learn_from(*opposite->of_solver);
    Result result = solver.solve(asked, own, trace);
    if (undone) move_back(result, trace, *undone);
    return result;
}

}  // namespace hausbench
