#include "exact_roots.h"
#include "verify.h"

#include <CGAL/Interval_nt.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/squared_distance_3.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace hausbench {
namespace {

using Interval = CGAL::Interval_nt<false>;
using Exact = CGAL::Simple_cartesian<Rational>;

using Element = std::vector<Vec3>;  // one corner or three

Element element(const Shape& shape, Index i) {
    if (const auto* set = std::get_if<PointSet>(&shape)) return {set->points.row(i)};
    const auto& mesh = std::get<TriangleMesh>(shape);
    Element corners;
    for (int k = 0; k < 3; ++k) corners.emplace_back(mesh.vertices.row(mesh.triangles(i, k)));
    return corners;
}

// The definition of a posed point (algorithms/scene.h), written again on purpose.
Vec3 moved(const Vec3& v, const Pose& pose) {
    if (pose.is_identity()) return v;
    Vec3 out;
    for (int i = 0; i < 3; ++i) {
        out[i] = ((pose.rotation(i, 0) * v[0] + pose.rotation(i, 1) * v[1]) + pose.rotation(i, 2) * v[2]) +
                 pose.translation[i];
    }
    return out;
}

Exact::Point_3 exact(const Vec3& v) { return {Rational(v[0]), Rational(v[1]), Rational(v[2])}; }

// CGAL's triangle distance wants a triangle that is one; a degenerate one is the union of its edges.
Rational squared_distance(const Vec3& p, const Element& e) {
    const Exact::Point_3 q = exact(p);
    if (e.size() == 1) return CGAL::squared_distance(q, exact(e[0]));
    const Exact::Point_3 a = exact(e[0]), b = exact(e[1]), c = exact(e[2]);
    if (!CGAL::collinear(a, b, c)) return CGAL::squared_distance(q, Exact::Triangle_3(a, b, c));
    const auto edge = [&](const Exact::Point_3& s, const Exact::Point_3& t) {
        return s == t ? CGAL::squared_distance(q, s) : CGAL::squared_distance(q, Exact::Segment_3(s, t));
    };
    return std::min({edge(a, b), edge(b, c), edge(c, a)});
}

double up(double x) { return std::nextafter(x, std::numeric_limits<double>::infinity()); }
double down(double x) { return std::nextafter(x, -std::numeric_limits<double>::infinity()); }

// From p to a foot on the element that is about the nearest; only its quality, not the proof, hangs on it. Scaled by the
// largest difference, so that no square is too large or too small for a double.
Vec3 rough_offset(const Vec3& p, Element e) {
    double scale = 0;
    for (Vec3& v : e) v -= p, scale = std::max(scale, v.cwiseAbs().maxCoeff());
    if (!(scale > 0) || !std::isfinite(scale) || e.size() == 1) return e[0];
    for (Vec3& v : e) v /= scale;
    const Vec3 ab = e[1] - e[0], ac = e[2] - e[0], normal = ab.cross(ac);
    const double area = normal.squaredNorm();
    if (area > 0) {
        const double v = -normal.dot(e[0].cross(ac)) / area, w = -normal.dot(ab.cross(e[0])) / area;
        if (v >= 0 && w >= 0 && v + w <= 1) return scale * (e[0] + v * ab + w * ac);
    }
    Vec3 best = e[0];
    for (int i = 0; i < 3; ++i) {
        const Vec3 &s = e[std::size_t(i)], &t = e[std::size_t((i + 1) % 3)];
        const double length = (t - s).squaredNorm();
        const Vec3 foot = s + (length > 0 ? std::clamp(-s.dot(t - s) / length, 0.0, 1.0) : 0.0) * (t - s);
        if (foot.squaredNorm() < best.squaredNorm()) best = foot;
    }
    return scale * best;
}

// True only if every point of the element is proven to be at least r away from p. Upward rounding must be on.
bool separated(const Vec3& p, const Element& e, double r) {
    Vec3 n = -rough_offset(p, e);
    const double largest = n.cwiseAbs().maxCoeff();
    if (!(largest > 0) || !n.allFinite()) return false;
    n /= largest;  // any direction will do
    const Interval nx(n[0]), ny(n[1]), nz(n[2]);
    const Interval bound = Interval(r) * CGAL::sqrt(nx * nx + ny * ny + nz * nz);
    for (const Vec3& v : e) {
        const Interval along = nx * (Interval(p[0]) - Interval(v[0])) + ny * (Interval(p[1]) - Interval(v[1])) +
                               nz * (Interval(p[2]) - Interval(v[2]));
        if (!(along.inf() >= bound.sup())) return false;
    }
    return true;
}

}  // namespace

Checker::Checker(const Shape& source, const Shape& target, Stop stop)
    : source_(source), target_(target), stop_(std::move(stop)) {}

Verdict Checker::lower(double lower, const Witness& witness, const Pose& pose, double& shown) const {
    shown = 0;
    const Vec3 p = witness.source_point;
    // How far p is from A posed: from the element the witness names, else from the nearest.
    const auto off = [&](Index i) -> std::optional<Element> {  // none where posing it leaves the range of doubles
        Element corners = element(source_, i);
        for (Vec3& v : corners) {
            v = moved(v, pose);
            if (!v.allFinite()) return std::nullopt;
        }
        return corners;
    };
    std::optional<Element> nearest_off;
    if (witness.source_element >= 0 && witness.source_element < element_count(source_)) {
        nearest_off = off(witness.source_element);
    } else {
        double least = std::numeric_limits<double>::infinity();
        for (Index i = 0; i < element_count(source_); ++i) {
            const auto corners = off(i);
            if (!corners) continue;
            const double d = rough_offset(p, *corners).stableNorm();
            if (!nearest_off || d < least) least = d, nearest_off = corners;
        }
    }
    if (!nearest_off) return Verdict::not_checked;
    const double e = root_at_least(squared_distance(p, *nearest_off));
    if (!std::isfinite(e)) return Verdict::unsound;
    const double r = e == 0 ? lower : up(lower + e);

    std::vector<Index> doubtful;  // those that interval arithmetic does not settle
    {
        CGAL::Protect_FPU_rounding<true> upward;
        for (Index i = 0; i < element_count(target_); ++i) {
            if (!std::isfinite(r) || !separated(p, element(target_, i), r)) doubtful.push_back(i);
        }
    }
    if (doubtful.empty()) return shown = lower, Verdict::holds;
    std::optional<Rational> nearest;
    for (Index i : doubtful) {
        if (stop_ && stop_()) return Verdict::not_checked;
        const Rational d = squared_distance(p, element(target_, i));
        if (!nearest || d < *nearest) nearest = d;
    }
    const double distance = root_at_most(*nearest);
    shown = e == 0 ? distance : std::max(0.0, down(distance - e));
    const Rational wanted = Rational(lower) + Rational(e);
    return wanted * wanted <= *nearest ? Verdict::holds : Verdict::unsound;
}

}  // namespace hausbench
