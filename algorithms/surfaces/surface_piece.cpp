#include "algorithms/surfaces/surface_piece.h"

#include <cmath>

namespace hausbench {
namespace {

Vec3 clamped(const Vec3& p, const Box& box) { return p.cwiseMax(box.low).cwiseMin(box.high); }

Interval squared(const std::array<Interval, 3>& v) {
    return CGAL::square(v[0]) + CGAL::square(v[1]) + CGAL::square(v[2]);
}

// Returns an upper bound on n.(y - c) for all points y of the piece, where c is the middle of its box. Uses the formula
// of surface_piece.h, with the number l that makes it smallest.
double support(const LinearForm& f, const Vec3& n) {
    const Vec3 q = n.cwiseProduct(f.half);
    const auto cost = [&](double l) {
        return std::max(-l * f.rest.inf(), -l * f.rest.sup()) + std::abs(q[0] - l * f.slope[0]) +
               std::abs(q[1] - l * f.slope[1]) + std::abs(q[2] - l * f.slope[2]);
    };
    double best = 0, least = cost(0);
    for (int k = 0; k < 3; ++k) {  // `cost` is convex and piecewise linear in l, so its minimum is at a kink
        if (f.slope[k] == 0) continue;
        const double l = q[k] / f.slope[k], c = cost(l);
        if (c < least) {
            best = l;
            least = c;
        }
    }
    const Interval l(best);
    double sum = (-l * f.rest).sup();
    for (int k = 0; k < 3; ++k) sum += magnitude(Interval(n[k]) * Interval(f.half[k]) - l * Interval(f.slope[k]));
    return sum;
}

// Returns an interval that contains n.(p - c).
Interval along(const Vec3& n, const Vec3& p, const Vec3& c) {
    Interval sum(0.0);
    for (int k = 0; k < 3; ++k) sum += Interval(n[k]) * (Interval(p[k]) - Interval(c[k]));
    return sum;
}

Interval length(const Vec3& n) { return CGAL::sqrt(squared({Interval(n[0]), Interval(n[1]), Interval(n[2])})); }

}  // namespace

Vec3 seed_on(const SurfacePiece& piece, const Vec3& p) {
    const LinearForm& f = piece.form;
    const Vec3 normal = f.slope.cwiseQuotient(f.half);
    const double size = normal.squaredNorm(), rest = 0.5 * (f.rest.inf() + f.rest.sup());
    Vec3 y = clamped(p, piece.box);
    if (!(size > 0) || !std::isfinite(size)) return y;
    for (int i = 0; i < 3; ++i) y = clamped(Vec3(y - ((normal.dot(y - f.middle) + rest) / size) * normal), piece.box);
    return y;
}

double distance_at_least(const SurfacePiece& piece, const Vec3& p) {
    std::array<Interval, 3> gap;
    for (int k = 0; k < 3; ++k) {  // the mode rounds up, so the negative of a result is rounded down
        const double before = -(p[k] - piece.box.low[k]), after = -(piece.box.high[k] - p[k]);
        gap[std::size_t(k)] = Interval(std::max(std::max(before, after), 0.0));
    }
    double best = CGAL::sqrt(squared(gap)).inf();
    const Vec3 n = p - seed_on(piece, p);
    const Interval size = length(n);
    if (!(size.inf() > 0) || !std::isfinite(size.sup())) return best;
    const double shown =
        (Interval((along(n, p, piece.form.middle) - Interval(support(piece.form, n))).inf()) / size).inf();
    return std::max(best, shown);
}

double distance_at_most(const SurfacePiece& piece, const Vec3& p) {
    const LinearForm& f = piece.form;
    std::array<Interval, 3> far;
    for (int k = 0; k < 3; ++k)
        far[std::size_t(k)] = Interval(magnitude(Interval(f.middle[k]) - Interval(p[k])) + f.half[k]);
    const double corners = CGAL::sqrt(squared(far)).sup();
    // For a point y of the piece, splits y - p into a part along n and a part across n. The part across n is at most as
    // long as the part of c - p across n plus half the diagonal of the box, where c is the middle of the box.
    const Vec3 n = seed_on(piece, f.middle) - p;
    const Interval size = length(n);
    if (!(size.inf() > 0) || !std::isfinite(size.sup())) return corners;
    const Interval before = along(n, f.middle, p);
    const double high = (Interval((before + Interval(support(f, n))).sup()) / size).sup();
    const double low = (Interval((-before + Interval(support(f, -n))).sup()) / size).sup();
    const double straight = std::max(std::max(high, low), 0.0);
    const Interval t = before / CGAL::square(size);
    std::array<Interval, 3> across;
    for (int k = 0; k < 3; ++k) across[std::size_t(k)] = Interval(f.middle[k]) - Interval(p[k]) - t * Interval(n[k]);
    const Interval aside = CGAL::sqrt(squared(across)) + length(f.half);
    return std::min(corners, CGAL::sqrt(CGAL::square(Interval(straight)) + CGAL::square(Interval(aside.sup()))).sup());
}

}  // namespace hausbench
