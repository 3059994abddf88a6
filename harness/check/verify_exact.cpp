#include "harness/check/verify_exact.h"

#include "algorithms/kernel/watched.h"

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

double down(double x) { return std::nextafter(x, -std::numeric_limits<double>::infinity()); }

// Returns the point moved by the pose. Repeats the operations of algorithms/kernel/geometry.h on purpose, so that the
// check shares no code with the solvers.
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

// Returns true only if interval arithmetic proves that every point of the element is at least r away from p. Requires
// upward rounding.
bool separated(const Vec3& p, const Element& e, double r) {
    Vec3 n = -rough_offset(p, e);
    const double largest = n.cwiseAbs().maxCoeff();
    if (!(largest > 0) || !n.allFinite()) return false;
    n /= largest;  // its rounding does not matter: the test is valid for any n
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

Standing::Standing(const Shape& shape, const Pose& pose) : shape_(shape), points_(&points_of(shape)) {
    if (pose.is_identity()) return;
    moved_ = *points_;
    for (Index i = 0; i < moved_.rows(); ++i) moved_.row(i) = moved(points_->row(i).transpose(), pose).transpose();
    points_ = &moved_;
}

Element Standing::operator[](Index i) const {
    if (kind_of(shape_) == ShapeKind::points) return {points_->row(i)};
    const auto& triangles = std::get<TriangleMesh>(shape_).triangles;
    return {points_->row(triangles(i, 0)), points_->row(triangles(i, 1)), points_->row(triangles(i, 2))};
}

bool Standing::beyond(Index i, const Vec3& p, double r) const {
    const auto* mesh = std::get_if<TriangleMesh>(&shape_);
    for (int k = 0; k < 3; ++k) {
        bool above = true, below = true;
        for (int c = 0; c < (mesh ? 3 : 1); ++c) {
            const double x = (*points_)(mesh ? mesh->triangles(i, c) : i, k);
            above = above && x - p[k] > WATCHED_ELSE("verify: an element is passed over only where it is far enough", r,
                                                     0.5 * r);
            below = below && p[k] - x > WATCHED_ELSE("verify: likewise on the other side", r, 0.5 * r);
        }
        if (above || below) return true;
    }
    return false;
}

// CGAL cannot compute the distance to a degenerate triangle; such a triangle is the union of its edges.
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

// Divides by the largest coordinate difference, so that squares neither overflow nor underflow.
Vec3 rough_offset(const Vec3& p, Element e) {
    double scale = 0;
    for (Vec3& v : e) {
        v -= p;
        scale = std::max(scale, v.cwiseAbs().maxCoeff());
    }
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

std::optional<Rational> nearer_than(const Standing& shape, const Vec3& p, double r, const Stop& stop, bool& stopped) {
    std::vector<Index> doubtful;
    for (Index i = 0; i < shape.count(); ++i) {
        if (!shape.beyond(i, p, r)) doubtful.push_back(i);
    }
    if (std::isfinite(r)) {
        CGAL::Protect_FPU_rounding<true> upward;
        std::erase_if(doubtful, [&](Index i) { return separated(p, shape[i], r); });
    }
    std::optional<Rational> nearest;
    for (Index i : doubtful) {
        if (stop && stop()) {
            stopped = true;
            return std::nullopt;
        }
        const Rational d = squared_distance(p, shape[i]);
        if (!nearest || d < *nearest) nearest = d;
    }
    return nearest;
}

Checker::Checker(const Shape& source, const Shape& target, Stop stop)
    : source_(source), target_(target), stop_(std::move(stop)) {}

Verdict Checker::lower(double lower, const Witness& witness, const Pose& source_pose, const Pose& target_pose,
                       double& shown) const {
    shown = 0;
    const Standing source(source_, source_pose),
        target(target_, WATCHED_ELSE("verify: the pose of the target", target_pose, Pose{}));
    const bool forward = WATCHED_ELSE("verify: which of its two points a witness shows the bound by",
                                      witness.direction == Witness::Direction::source_to_target, true);
    const Standing &from = forward ? source : target, &to = forward ? target : source;
    const Vec3 p = forward ? witness.source_point : witness.target_point;
    const Index named = forward ? witness.source_element : witness.target_element;
    if (WATCHED("verify: a pose beyond the doubles leaves nothing to check", !to.finite())) return Verdict::not_checked;
    // The element on which p should lie: the element that the witness names, otherwise the nearest. Empty if the pose
    // moves it out of the range of doubles.
    std::optional<Element> nearest_off;
    const auto off = [&](Index i) -> std::optional<Element> {
        Element corners = from[i];
        for (const Vec3& v : corners) {
            if (!v.allFinite()) return std::nullopt;
        }
        return corners;
    };
    if (named >= 0 && named < from.count()) {
        nearest_off = off(named);
    } else {
        double least = std::numeric_limits<double>::infinity();
        for (Index i = 0; i < from.count(); ++i) {
            const auto corners = off(i);
            if (!corners) continue;
            const double d = rough_offset(p, *corners).stableNorm();
            if (!nearest_off || d < least) {
                least = d;
                nearest_off = corners;
            }
        }
    }
    if (!nearest_off) return Verdict::not_checked;
    const double e = root_at_least(squared_distance(p, *nearest_off));
    if (!std::isfinite(e)) return Verdict::unsound;
    const double r = e == 0 ? lower : std::nextafter(lower + e, infinity);

    bool stopped = false;
    const std::optional<Rational> nearest = nearer_than(to, p, r, stop_, stopped);
    if (stopped) return Verdict::not_checked;
    if (!nearest) {
        shown = lower;
        return Verdict::holds;
    }
    const double distance = root_at_most(*nearest);
    shown = e == 0 ? distance : std::max(0.0, down(distance - e));
    const Rational wanted = Rational(lower) + Rational(e);
    return wanted * wanted <= *nearest ? Verdict::holds : Verdict::unsound;
}

}  // namespace hausbench
