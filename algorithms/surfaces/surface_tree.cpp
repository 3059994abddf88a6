#include "algorithms/surfaces/surface_tree.h"

#include "algorithms/surfaces/surface_descent.h"

#include <Eigen/LU>

#include <cmath>

namespace hausbench {
namespace {

constexpr int deepest = 46;  // at this depth a box is a few ulps wide

bool holds_zero(const Interval& x) { return x.inf() <= 0 && x.sup() >= 0; }

// Returns whether `middle` lies strictly between the two sides of the box. If no double does, one half would be
// the whole box again.
bool divides(const Box& box, const Vec3& middle, int axis) {
    return box.low[axis] < middle[axis] && middle[axis] < box.high[axis];
}

}  // namespace

SurfaceTree::SurfaceTree(const AlgebraicSurface& surface)
    : box_{surface.box.row(0), surface.box.row(1)},
      evaluator_(Polynomial::of(surface)),
      derivatives_{FormEvaluator(polynomial().derivative(0)), FormEvaluator(polynomial().derivative(1)),
                   FormEvaluator(polynomial().derivative(2))} {
    const LinearForm whole = evaluator_.linear(box_);
    if (holds_zero(whole.range())) nodes_.push_back({{box_, whole}});
}

bool SurfaceTree::may_split(std::int32_t i) const {
    const Node& node = (*this)[i];
    const auto divided = [&](int axis) { return divides(node.box, node.form.middle, axis); };
    return node.depth < deepest && (divided(0) || divided(1) || divided(2));
}

void SurfaceTree::split(std::int32_t i, Counters& counters) {
    const Node node = (*this)[i];
    if (node.first >= 0) return;
    const auto first = static_cast<std::int32_t>(nodes_.size());
    const Vec3& m = node.form.middle;
    int undivided = 0;  // the axes that are not halved, one bit each
    for (int k = 0; k < 3; ++k) undivided |= divides(node.box, m, k) ? 0 : 1 << k;
    for (int c = 0; c < 8; ++c) {
        if (c & undivided) continue;
        Box box = node.box;
        for (int k = 0; k < 3; ++k) {
            if (!(undivided >> k & 1)) (c >> k & 1 ? box.low : box.high)[k] = m[k];
        }
        ++counters.polynomial_evaluations;
        const LinearForm f = evaluator_.linear(box);
        if (holds_zero(f.range())) nodes_.push_back({{box, f}, -1, 0, node.depth + 1});
    }
    Node& split = nodes_[static_cast<std::size_t>(i)];
    split.first = first;
    split.count = static_cast<std::int32_t>(nodes_.size()) - first;
}

LinearForm SurfaceTree::form(const Box& box, Counters& counters) {
    ++counters.polynomial_evaluations;
    return evaluator_.linear(box);
}

Interval SurfaceTree::derivative(int axis, const Box& box, Counters& counters) {
    ++counters.polynomial_evaluations;
    return derivatives_[static_cast<std::size_t>(axis)].range(Form::modified_affine, box);
}

std::optional<SurfaceTree::CriticalPoint> SurfaceTree::newton(const Vec3& p, const Vec3& start) const {
    CriticalPoint point{start, 0, {}};
    Vec3 gradient;
    polynomial().value(start, gradient);
    point.factor = (p - start).dot(gradient) / gradient.squaredNorm();
    for (int step = 0; step < 6; ++step) {
        const double f = polynomial().value(point.at, gradient);
        Eigen::Matrix4d jacobian = Eigen::Matrix4d::Identity();
        for (int k = 0; k < 3; ++k) {
            Vec3 row;
            derivative(k).value(point.at, row);
            jacobian.block<1, 3>(k, 0) += point.factor * row.transpose();
        }
        jacobian.block<3, 1>(0, 3) = gradient;
        jacobian.block<1, 3>(3, 0) = gradient.transpose();
        jacobian(3, 3) = 0;
        point.inverse = jacobian.inverse();
        Eigen::Vector4d residual;
        residual << point.at - p + point.factor * gradient, f;
        const Eigen::Vector4d change = point.inverse * residual;
        if (!change.allFinite()) return std::nullopt;
        point.at -= change.head<3>();
        point.factor -= change[3];
    }
    return point;
}

// Proves that the surface has a point near p: finds a segment through p, parallel to an axis, at whose ends the
// polynomial has opposite signs. Tries the axis of the steepest slope first, and longer and longer segments.
std::optional<SurfacePoint> SurfaceTree::prove(const Vec3& p, Counters& counters) const {
    Vec3 g;
    const double f = polynomial().value(p, g);
    const double ulps = 0x1p-51 * (std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]));
    // Tries several axes, because a segment must stay in the box: if p is on an edge of the box, only the axis along
    // this edge will do.
    for (int tried = 0; tried < 3; ++tried) {
        int axis = 0;
        g.cwiseAbs().maxCoeff(&axis);
        if (!(std::abs(g[axis]) > 0)) return std::nullopt;
        double room = 1.5 * std::abs(f / g[axis]) + ulps;
        for (int step = 0; step < 4; ++step, room *= 16) {
            const double low = std::max(box_.low[axis], p[axis] - room),
                         high = std::min(box_.high[axis], p[axis] + room);
            std::array<Interval, 3> at{Interval(p[0]), Interval(p[1]), Interval(p[2])};
            counters.polynomial_evaluations += 2;
            at[std::size_t(axis)] = Interval(low);
            const Interval first = polynomial().natural(at);
            at[std::size_t(axis)] = Interval(high);
            const Interval last = polynomial().natural(at);
            if ((first.sup() <= 0 && last.inf() >= 0) || (first.inf() >= 0 && last.sup() <= 0)) {
                return SurfacePoint{p, std::max(high - p[axis], p[axis] - low)};
            }
        }
        g[axis] = 0;
    }
    return std::nullopt;
}

// First walks along tangent planes. If y - p is then not normal to the surface, y is not the nearest point: tangent
// planes mislead if the surface curves strongly, compared with the distance from p to y. Newton's method still works
// there, so it is tried next.
std::optional<SurfacePoint> SurfaceTree::nearby(const Vec3& p, const Vec3& seed, Counters& counters) const {
    ++counters.closest_point_queries;
    const SurfaceDescent surface(polynomial(), box_);
    Vec3 y = surface.descend(p, surface.onto(seed));
    const double distance = (p - y).squaredNorm();
    Vec3 g;
    polynomial().value(y, g);
    if (g.cross(p - y).squaredNorm() > 1e-10 * g.squaredNorm() * distance) {
        const auto better = newton(p, y);
        if (better && surface.holds(better->at) && (p - better->at).squaredNorm() < distance)
            y = surface.onto(better->at);
    }
    return prove(y, counters);
}

}  // namespace hausbench
