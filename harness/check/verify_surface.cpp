#include "harness/check/verify_surface.h"

#include "algorithms/kernel/interval_form.h"

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

// No farther than this from p along axis k is a point of the surface that is proven between `low` and `high`, where the
// polynomial changes its sign; bisected as long as signs are certain, since every bit of it is taken off the solver's bound.
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

// Returns the largest possible distance of p from a proven point of the surface; empty if none was found in the box.
// A witness of a coarse mesh may be far. If the surface crosses no axis through p, as at the apex of a cone, signs at
// the ends of two axes may differ: the segment between them is within e of p, too.
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
            const double found = bracketed(f, p, low, high, k);
            if (!least || found < *least) least = found;
        }
        if (least) return least;
        if (below && above) return reach;
    }
    return std::nullopt;
}

enum class Found { nothing, near, open };

// The content of one box: no point of B within r of p, surely one, or unknown.
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
    Vec3 rough;  // of `linear`
    for (int k = 0; k < 3; ++k) {
        const Interval d = Interval(form.middle[k]) - Interval(p[k]);
        constant += CGAL::square(d);
        linear[std::size_t(k)] = 2.0 * d * Interval(form.half[k]);
        rough[k] = linear[std::size_t(k)].sup();
    }
    // Which m is best hangs on the sides of the box that the nearest point lies on: least squares over the other axes.
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
        const Found found = look(f, box, p, r, lower, shown);
        if (found == Found::near) return Verdict::unsound;
        if (found == Found::nothing) continue;
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
