#include "harness/check/verify_surface.h"

#include "algorithms/kernel/interval_form.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hausbench {

namespace {

constexpr int boxes_at_most = 1000000;

Interval value_at(const Polynomial& f, const Vec3& p) {
    return f.natural({Interval(p[0]), Interval(p[1]), Interval(p[2])});
}

bool changes_sign(const Interval& a, const Interval& b) {
    return (a.sup() <= 0 && b.inf() >= 0) || (a.inf() >= 0 && b.sup() <= 0);
}

// Returns a distance e such that the surface f = 0 has a point within e of p, on the line through p parallel to axis k.
// `low` and `high` are points of this line between which f changes sign. Bisects between them while the signs are
// certain, because the solver's lower bound has to hold with e added.
double bracketed(const Polynomial& f, const Vec3& p, Vec3 low, Vec3 high, int k) {
    const Interval at_low = value_at(f, low);
    for (int step = 0; step < 60; ++step) {
        Vec3 middle = low;
        middle[k] = 0.5 * (low[k] + high[k]);
        if (!(middle[k] > low[k] && middle[k] < high[k])) break;
        const Interval value = value_at(f, middle);
        if (changes_sign(at_low, value))
            high = middle;
        else if (changes_sign(value, value_at(f, high)))
            low = middle;
        else
            break;
    }
    return std::max(high[k] - p[k], p[k] - low[k]);
}

// Returns an upper bound on the distance from p to a proven point of the surface f = 0, or nothing if none is found in
// the box. Looks for a change of sign along the three axes through p, at growing distances, because the witness of a
// coarse mesh may be far off the surface. If the surface crosses none of these axes, as near the apex of a cone, the
// signs at ends of two axes may still differ. The surface then crosses the segment between these ends, which lies
// within `reach` of p.
std::optional<double> off_surface(const Polynomial& f, const Box& box, const Vec3& p) {
    if ((p.array() < box.low.array()).any() || (p.array() > box.high.array()).any()) return std::nullopt;
    const Interval here = value_at(f, p);
    if (here.inf() == 0 && here.sup() == 0) return 0;
    const double size = (box.high - box.low).maxCoeff();
    for (double e = 0x1p-52 * std::max(p.cwiseAbs().maxCoeff(), size); e < 4 * size; e *= 4) {
        std::optional<double> least;
        double reach = 0;
        bool below = here.sup() <= 0, above = here.inf() >= 0;
        for (int k = 0; k < 3; ++k) {
            Vec3 low = p, high = p;
            low[k] = std::max(box.low[k], -(e - p[k]));
            high[k] = std::min(box.high[k], p[k] + e);
            reach = std::max({reach, high[k] - p[k], p[k] - low[k]});
            const Interval at_low = value_at(f, low), at_high = value_at(f, high);
            below = below || at_low.sup() <= 0 || at_high.sup() <= 0;
            above = above || at_low.inf() >= 0 || at_high.inf() >= 0;
            if (!changes_sign(at_low, at_high)) continue;
            const double distance = bracketed(f, p, low, high, k);
            if (!least || distance < *least) least = distance;
        }
        if (least) return least;
        if (below && above) return WATCHED("verify: a witness far from its surface costs how far it is", reach);
    }
    return std::nullopt;
}

enum class Found { nothing, near, open };

// Examines one box. Returns `nothing` if no point of B in it is nearer to p than r. Returns `near` if a point of B in
// it is nearer to p than `lower`, and sets `shown` to an upper bound on its distance. Otherwise returns `open`; the
// caller then subdivides the box.
Found look(FormEvaluator& f, const Box& box, const Vec3& p, double r, double lower, double& shown) {
    Interval gap(0.0), far(0.0);
    for (int k = 0; k < 3; ++k) {
        const double before = -(p[k] - box.low[k]), after = -(box.high[k] - p[k]);  // rounded down
        gap += CGAL::square(Interval(std::max({before, after, 0.0})));
        far += CGAL::square(Interval(std::max(p[k] - box.low[k], box.high[k] - p[k])));
    }
    const Interval square = CGAL::square(Interval(r));
    if (gap.inf() >= square.sup()) return Found::nothing;
    const LinearForm form = f.linear(box);
    const Interval range = form.range();
    if (range.inf() > 0 || range.sup() < 0) return Found::nothing;

    std::array<Interval, 3> linear;
    Interval constant = -square;
    Vec3 rough;  // `linear` in doubles
    for (int k = 0; k < 3; ++k) {
        const Interval d = Interval(form.middle[k]) - Interval(p[k]);
        constant += CGAL::square(d);
        linear[std::size_t(k)] = 2.0 * d * Interval(form.half[k]);
        rough[k] = linear[std::size_t(k)].sup();
    }
    // Tries eight values of m in |y - p|^2 - r^2 - m * f(y), which must be nonnegative in the box (verify_surface.h):
    // 0, and for each set of axes the m that minimises the slope along these axes (least squares). If the point of B
    // nearest to p lies on sides of the box, the axes across these sides are best ignored.
    std::array<double, 8> candidates{};
    for (unsigned free = 1; free < 8; ++free) {
        const Vec3 axes(free & 1, free >> 1 & 1, free >> 2);
        const Vec3 slope = form.slope.cwiseProduct(axes);
        if (slope.squaredNorm() > 0) candidates[free] = rough.dot(slope) / slope.squaredNorm();
    }
    for (const double candidate : candidates) {
        const Interval m(candidate);
        const Interval least = constant - m * form.rest;
        double spread = 0;
        for (int k = 0; k < 3; ++k) spread += magnitude(linear[std::size_t(k)] - m * Interval(form.slope[k]));
        if (least.inf() >= spread) return Found::nothing;
    }

    if (CGAL::sqrt(far).sup() < lower &&
        changes_sign(value_at(f.polynomial(), box.low), value_at(f.polynomial(), box.high))) {
        shown = CGAL::sqrt(far).sup();
        return Found::near;
    }
    return Found::open;
}

}  // namespace

Verdict check_surface_lower(const AlgebraicSurface& source, const AlgebraicSurface& target, double lower, const Vec3& p,
                            double& shown) {
    const UpwardRounding upward;
    shown = 0;
    const auto e = off_surface(Polynomial::of(source), {source.box.row(0), source.box.row(1)}, p);
    if (!e) return Verdict::unsound;
    const double r = lower + *e;
    FormEvaluator f{Polynomial::of(target)};
    std::vector<Box> boxes{{target.box.row(0), target.box.row(1)}};
    for (int looked = 0; !boxes.empty(); ++looked) {
        if (looked == boxes_at_most) return Verdict::not_checked;
        const Box box = boxes.back();
        boxes.pop_back();
        const Found answer = look(f, box, p, r, lower, shown);
        if (answer == Found::near) return Verdict::unsound;
        if (answer == Found::nothing) continue;
        const Vec3 middle = 0.5 * (box.low + box.high);
        if (((box.high - box.low).array() < 0x1p-48 * (1 + p.cwiseAbs().maxCoeff())).all()) return Verdict::not_checked;
        for (int c = 0; c < 8; ++c) {
            Box child = box;
            for (int k = 0; k < 3; ++k) (c >> k & 1 ? child.low : child.high)[k] = middle[k];
            boxes.push_back(child);
        }
    }
    return Verdict::holds;
}

}  // namespace hausbench
