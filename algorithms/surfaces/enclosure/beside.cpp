#include "algorithms/surfaces/enclosure/beside.h"

#include "algorithms/kernel/watched.h"

#include <cmath>

namespace hausbench::surface_enclosure {
namespace {

// Returns an interval that contains f_B(y + t) for all points y of the piece of A, where f_B is the polynomial of B.
// Returns nothing if y + t may leave the box of B. Subtracts a multiple of the linear form of A, which is 0 on the
// piece, to make the interval tighter.
std::optional<Interval> moved(const SurfaceTree::Node& piece, SurfaceTree& target, const Vec3& t, Counters& counters) {
    Box box;
    for (int k = 0; k < 3; ++k) {
        box.low[k] = -(-piece.box.low[k] - t[k]);  // rounded down
        box.high[k] = piece.box.high[k] + t[k];
        if (box.low[k] < target.box().low[k] || box.high[k] > target.box().high[k]) return std::nullopt;
    }
    const LinearForm &of_a = piece.form, of_b = target.form(box, counters);
    const double size = of_a.slope.squaredNorm();
    const Interval share(size > 0 ? of_a.slope.dot(of_b.slope) / size : 0.0);
    Interval sum = of_b.rest - share * of_a.rest;
    // A point of the piece is y = c + r * u (componentwise), where c is the middle of its box, r the half widths, and
    // |u| <= 1. Expresses the linear form over the moved box in this u.
    double most = 0;
    for (int k = 0; k < 3; ++k) {
        const Interval slope = Interval(of_b.slope[k]) / Interval(of_b.half[k]);
        sum += slope * (Interval(of_a.middle[k]) + Interval(t[k]) - Interval(of_b.middle[k]));
        most += magnitude(slope * Interval(of_a.half[k]) - share * Interval(of_a.slope[k]));
    }
    return sum + Interval(-most, most);
}

}  // namespace

double apart_at_most(const Vec3& a, const Vec3& b) {
    Interval sum(0.0);
    for (int k = 0; k < 3; ++k) sum += CGAL::square(Interval(a[k]) - Interval(b[k]));
    return CGAL::sqrt(sum).sup();
}

double next_to(const SurfaceTree::Node& piece, SurfaceTree& target, Counters& counters) {
    const auto here = moved(piece, target, Vec3::Zero(), counters);
    return here ? within(piece, target, magnitude(*here), counters) : infinity;
}

double within(const SurfaceTree::Node& piece, SurfaceTree& target, double most, Counters& counters) {
    for (int k = 0; k < 3; ++k) {
        if (WATCHED("beside: the piece lies in B's box",
                    !(piece.box.low[k] >= target.box().low[k] && piece.box.high[k] <= target.box().high[k])))
            return infinity;
    }
    Vec3 gradient;
    target.polynomial().value(piece.form.middle, gradient);
    int axis = 0;
    gradient.cwiseAbs().maxCoeff(&axis);
    if (!(std::abs(gradient[axis]) > 0)) return infinity;
    // Guesses how far to widen the box from the slope in the middle, then checks the guess with the smallest slope in
    // the widened box.
    for (const double room : {1.25, 4.0}) {
        const double t = room * most / std::abs(gradient[axis]);
        Box wide = piece.box;
        wide.low[axis] = -(t - wide.low[axis]);
        wide.high[axis] += t;
        if (!(wide.low[axis] >= target.box().low[axis] && wide.high[axis] <= target.box().high[axis])) return infinity;
        const Interval slope = target.derivative(axis, wide, counters);
        const double least = std::max(slope.inf(), -slope.sup());
        if (!(least > 0)) return infinity;
        const double needed = most / least;
        if (needed <= t) return needed;
    }
    return infinity;
}

double beside(const SurfaceTree::Node& piece, SurfaceTree& target, const Vec3& p, const Vec3& foot, double limit,
              Counters& counters) {
    const Vec3 n = foot - p;
    const double size = n.norm();
    if (!(size > 0)) return infinity;
    const auto here = moved(piece, target, Vec3::Zero(), counters);
    if (!here || WATCHED("beside: f_B has one sign on the piece", here->inf() <= 0 && here->sup() >= 0))
        return infinity;
    const double sign = here->inf() > 0 ? 1 : -1;
    Vec3 gradient;
    target.polynomial().value(foot, gradient);
    const double fall = -sign * gradient.dot(n) / size;  // decrease of |f_B| per unit of length along n
    if (!(fall > 0)) return infinity;
    double further = 0;
    for (int tries = 0; tries < 3; ++tries) {
        const Vec3 t = (1 + further / size) * n;
        const double most = apart_at_most(t, Vec3::Zero());
        if (most >= limit) return infinity;
        const auto there = moved(piece, target, t, counters);
        if (!there) return infinity;
        const double left = sign > 0 ? there->sup() : -there->inf();
        if (left <= 0) return most;
        further += WATCHED("beside: farther than the foot", 1.05 * left / fall);
    }
    return infinity;
}

}  // namespace hausbench::surface_enclosure
