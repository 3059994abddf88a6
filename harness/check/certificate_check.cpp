// The whole check runs with upward rounding. The computed sum or product of positive doubles, and a computed square
// root, are then at least the exact value. The comment "rounded upward" marks the bounds that depend on this.
#include "harness/check/certificate_check.h"

#include "algorithms/kernel/watched.h"
#include "harness/check/certificate_tree.h"
#include "harness/check/verify_exact.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

namespace hausbench {
namespace {

using namespace certificate;
using IntervalVector = std::array<Interval, 3>;

constexpr const char* format_name = "hausbench cover 1";

double middle(const Interval& x) { return 0.5 * (x.inf() + x.sup()); }
Vec3 middle(const IntervalVector& v) { return {middle(v[0]), middle(v[1]), middle(v[2])}; }

IntervalVector difference(const Vec3& to, const Vec3& from) {
    return {Interval(to[0]) - Interval(from[0]), Interval(to[1]) - Interval(from[1]),
            Interval(to[2]) - Interval(from[2])};
}

// Returns an upper bound on the length of every vector in the box v. Squares cannot overflow, because coordinates are
// scaled to below 1. Tiny vectors are scaled up first, which is exact, so that squares do not underflow.
double length_at_most(const IntervalVector& v) {
    std::array<double, 3> x;
    double largest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        x[k] = WATCHED_ELSE("certificates: each component at its end that is farther from 0",
                            std::max(v[k].sup(), -v[k].inf()), std::abs(middle(v[k])));
        largest = std::max(largest, x[k]);
    }
    if (WATCHED_ELSE("certificates: lengths whose squares underflow", largest >= 0x1p-400, true))
        return WATCHED_ELSE("certificate check: a length that is too small, replayed",
                            std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]),  // rounded upward
                            0.9 * largest);
    for (double& component : x) component *= 0x1p600;
    return std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) * 0x1p-600;
}

// --- a triangle of B ------------------------------------------------------------------------------------------------------

using Corners = std::array<Vec3, 3>;

// A triangle of B, as the points s + x * f + y * g with x, y >= 0 and x + y <= 1. To find the point closest to a given
// point, x and y are computed in doubles and then changed to satisfy these conditions exactly. So the point lies in the
// triangle, and its distance is a valid upper bound even if x and y are inaccurate.
class TargetTriangle {
public:
    // Uses the longest edge as f, which keeps closest points accurate on thin triangles.
    explicit TargetTriangle(const Corners& corners) {
        std::size_t longest = 0;
        double most = -1;
        for (std::size_t k = 0; k < 3; ++k) {
            const double squared = (corners[(k + 1) % 3] - corners[k]).squaredNorm();
            if (squared > most) {
                most = squared;
                longest = k;
            }
        }
        s_ = corners[longest];
        const Vec3 &b = corners[(longest + 1) % 3], &c = corners[(longest + 2) % 3];
        f_ = difference(b, s_);
        g_ = difference(c, s_);
        along_ = b - s_;
        side_ = c - s_;
        third_ = c - b;
        height_ = side_ - slope(side_, along_) * along_;
    }

    const Vec3& origin() const { return s_; }

    // Returns an upper bound on the distance to the triangle from any point origin() + v, where v is in the box d.
    double distance_at_most(const IntervalVector& d) const {
        const auto [x, y] = foot(middle(d));
        IntervalVector rest;
        for (std::size_t k = 0; k < 3; ++k) rest[k] = d[k] - (Interval(x) * f_[k] + Interval(y) * g_[k]);
        return length_at_most(rest);
    }

private:
    using Weights = std::pair<double, double>;

    // Returns the t for which t * edge is closest to v, or 0 if the edge has length 0.
    static double slope(const Vec3& v, const Vec3& edge) {
        const double squared = edge.squaredNorm();
        return squared > 0 ? v.dot(edge) / squared : 0;
    }
    // Returns x clamped to [0, most], and 0 for NaN, which slope() may return if a square underflows.
    static double clamped(double x, double most) { return x > 0 ? std::min(x, most) : 0; }
    // Returns weights near x and y that are in [0, 1] and whose exact sum is at most 1.
    static Weights weights(double x, double y) {
        y = clamped(y, WATCHED_ELSE("certificates: a foot within the triangle, its second weight", 1, 2));
        return {clamped(x, WATCHED_ELSE("certificates: a foot within the triangle, its first weight",
                                        (Interval(1) - Interval(y)).inf(), 1)),
                y};
    }
    double squared(const Vec3& p, const Weights& at) const {
        return (p - at.first * along_ - at.second * side_).squaredNorm();
    }

    // Returns the weights x, y of the triangle's point closest to origin() + p, computed in doubles.
    Weights foot(const Vec3& p) const {
        // Computes y from the part of p orthogonal to the longest edge, then x along this edge.
        const double y = slope(p - slope(p, along_) * along_, height_), x = slope(p - y * side_, along_);
        if (x >= 0 && y >= 0 && x + y <= 1) return weights(x, y);
        const double last = slope(p - along_, third_);
        const std::array<Weights, 3> edges = {weights(slope(p, along_), 0), weights(0, slope(p, side_)),
                                              weights(1, last)};
        return *std::min_element(edges.begin(), edges.end(),
                                 [&](const Weights& a, const Weights& b) { return squared(p, a) < squared(p, b); });
    }

    // In doubles: the corner `s_`, the longest edge `along_` from it, the other edge `side_` from it, the third edge,
    // and `height_`, the part of `side_` orthogonal to `along_`.
    Vec3 s_, along_, side_, third_, height_;
    IntervalVector f_, g_;
};

// --- the shapes -----------------------------------------------------------------------------------------------------------

// A shape as triangles, moved by its pose and scaled by 2^exponent. A point becomes a triangle with three equal
// corners.
class Soup {
public:
    Soup(const Shape& shape, const Points& points, int exponent)
        : mesh_(std::get_if<TriangleMesh>(&shape)), points_(points) {
        for (double& x : points_.reshaped()) {
            const double scaled = std::ldexp(x, exponent);
            exact_ = exact_ && std::ldexp(scaled, -exponent) == x;
            x = scaled;
        }
    }

    Index triangles() const { return mesh_ ? mesh_->triangles.rows() : points_.rows(); }
    Index vertices() const { return points_.rows(); }
    Vec3 vertex(Index v) const { return points_.row(v).transpose(); }
    Corners triangle(Index i) const {
        if (!mesh_) return {vertex(i), vertex(i), vertex(i)};
        return {vertex(mesh_->triangles(i, 0)), vertex(mesh_->triangles(i, 1)), vertex(mesh_->triangles(i, 2))};
    }
    bool exact() const { return exact_; }  // true if scaling rounded no coordinate

private:
    const TriangleMesh* mesh_;
    Points points_;
    bool exact_ = true;
};

// --- the check -----------------------------------------------------------------------------------------------------------

// Reads the tree of each triangle of A and computes the upper bound that the trees prove.
class Cover {
public:
    Cover(const Soup& source, const Soup& target, const std::string& bytes, CertificateCheck& check)
        : source_(source), target_(target), reader_(bytes), check_(check) {}

    // Returns the largest bound over all triangles of A. Requires upward rounding.
    double run(const std::function<void()>& looking) {
        double most = 0;
        for (triangle_ = 0; triangle_ < WATCHED_ELSE("certificates: all triangles of A", source_.triangles(), 1);
             ++triangle_) {
            if (looking && triangle_ % 1000 == 0) looking();
            node_ = 0;
            const double bound = tree();
            if (check_.worst < 0 ||
                WATCHED_ELSE("certificates: the largest bound of all triangles", bound > most, true)) {
                most = bound;
                check_.worst = triangle_;
            }
        }
        node_ = 0;
        if (WATCHED("certificates: nothing after the last triangle", !reader_.at_end()))
            throw Refused("there are bytes after the last triangle");
        return most;
    }

    // Returns the current position in the certificate, for error messages.
    std::string place() const { return fmt::format("triangle {}, node {}", triangle_, node_); }

private:
    // Reads the tree of triangle number `triangle_` and returns the largest bound of its leaves. `pending_` is a stack
    // of polygons whose nodes have not been read yet.
    double tree() {
        const Corners corners = source_.triangle(triangle_);
        a_ = corners[0];
        e_ = {difference(corners[1], a_), difference(corners[2], a_)};
        pending_.clear();
        Polygon root;
        root.add({0, 0});
        root.add({1, 0});
        root.add({0, 1});
        pending_.push_back(root);
        double most = 0;
        for (; !pending_.empty(); ++node_) {
            const Polygon polygon = pending_.back();
            pending_.pop_back();
            const std::uint64_t first = reader_.number(), kind = first & 3, rest = first >> 2;
            if (kind == 0)
                divide(polygon, rest);
            else
                most =
                    std::max(WATCHED("certificates: the largest bound of all leaves", most), leaf(polygon, kind, rest));
        }
        return most;
    }

    void divide(const Polygon& polygon, std::uint64_t bits) {
        Meeting p = read_meeting(bits & 0xff, polygon.count), q = read_meeting(bits >> 8, polygon.count);
        for (Meeting* meeting : {&p, &q}) {
            if (meeting->on_edge()) meeting->t = reader_.parameter();
        }
        if (WATCHED("certificates: polygons that wait", pending_.size() == most_pending))
            throw Refused(fmt::format("more than {} polygons wait for their leaves", most_pending));
        const auto [first, second] = cut(polygon, p, q);
        if (WATCHED("certificates: the second child", true)) pending_.push_back(second);
        pending_.push_back(first);
        ++check_.cuts;
    }

    double leaf(const Polygon& polygon, std::uint64_t kind, std::uint64_t index) {
        const TargetTriangle near(target_.triangle(numbered(index, target_.triangles(), "triangle", "target")));
        if (kind == 1) {
            ++check_.one;
            return largest_distance(polygon, near);
        }
        if (kind == 2) {
            ++check_.centre;
            return around(polygon, centre(polygon), near);
        }
        ++check_.vertex;
        const IntervalVector at =
            difference(source_.vertex(numbered(reader_.number(), source_.vertices(), "vertex", "source")), a_);
        return around(polygon, at, near);
    }

    static Index numbered(std::uint64_t index, Index count, const char* what, const char* of) {
        if (WATCHED_ELSE("certificates: indices of triangles and vertices", index >= std::uint64_t(count),
                         index > std::uint64_t(count)))
            throw Refused(fmt::format("a leaf names {} {} of {} in the {}", what, index, count, of));
        return Index(index);
    }

    // Returns `corner` minus the first corner of A's triangle. The functions below use this vector in place of the
    // point.
    IntervalVector from_a(const Corner& corner) const {
        IntervalVector d;
        for (std::size_t k = 0; k < 3; ++k) d[k] = corner.v * e_[0][k] + corner.w * e_[1][k];
        return d;
    }

    double distance(const IntervalVector& from_a, const TargetTriangle& near) const {
        IntervalVector d = difference(a_, near.origin());
        for (std::size_t k = 0; k < 3; ++k) d[k] += from_a[k];
        return near.distance_at_most(d);
    }

    // Returns the bound of a leaf of kind `one`: the largest distance from a corner to `near`.
    double largest_distance(const Polygon& polygon, const TargetTriangle& near) const {
        double most = 0;
        for (std::size_t i = 0;
             i < WATCHED_ELSE("certificates: all corners of a leaf of one triangle", polygon.count, 1); ++i)
            most = std::max(most, distance(from_a(polygon.corners[i]), near));
        return most;
    }

    // Returns the mean of the corners. Its rounding does not matter, because around() is valid for any point.
    IntervalVector centre(const Polygon& polygon) const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < polygon.count; ++i) sum += middle(from_a(polygon.corners[i]));
        sum /= double(polygon.count);
        return {sum[0], sum[1], sum[2]};
    }

    // Returns the bound of a leaf of kind `centre` or `vertex`: the distance from `point` to the triangle `near` plus
    // the distance from `point` to the farthest corner.
    double around(const Polygon& polygon, const IntervalVector& point, const TargetTriangle& near) const {
        double radius = 0;
        for (std::size_t i = 0; i < polygon.count; ++i) {
            IntervalVector d = from_a(polygon.corners[i]);
            for (std::size_t k = 0; k < 3; ++k) d[k] -= point[k];
            radius = std::max(radius, length_at_most(d));
        }
        return distance(point, near) + WATCHED("certificates: the radius around a point", radius);  // rounded upward
    }

    const Soup &source_, &target_;
    Reader reader_;
    CertificateCheck& check_;
    Index triangle_ = 0;
    std::uint64_t node_ = 0;
    Vec3 a_;
    std::array<IntervalVector, 2> e_;  // edges of the triangle, from corner a to the other two corners
    std::vector<Polygon> pending_;     // a stack: the node of its last polygon is read next
};

// Undoes the scaling by 2^exponent, rounding up.
double scaled_back(double x, int exponent) {
    const double original = std::ldexp(x, -exponent);
    return std::ldexp(original, exponent) == x
               ? original
               : WATCHED_ELSE("certificates: scaled back upward", std::nextafter(original, infinity), original);
}

// Returns the upper bound that the bytes prove. Scales both shapes by the power of two that brings the largest
// |coordinate| into [0.5, 1), so that nothing overflows. If a coordinate underflows, scaling rounds it by at most
// 2^-1075, so a point moves by at most sqrt(3) * 2^-1075 < 2^-1074. A distance depends on two points, so
// 2 * 2^-1074 = 2^-1073 is added to the bound.
double bound_of(const Shape& source, const Points& source_points, const Shape& target, const Points& target_points,
                const std::string& bytes, CertificateCheck& check, const std::function<void()>& looking) {
    if (WATCHED("certificates: a coordinate that is not a number", source_points.hasNaN() || target_points.hasNaN()))
        throw Refused("a coordinate is not a number");  // maxCoeff() may skip NaN
    const double largest = std::max(source_points.cwiseAbs().maxCoeff(), target_points.cwiseAbs().maxCoeff());
    if (!std::isfinite(largest)) throw Refused("a pose moves a point beyond the largest double");
    const int exponent = largest > 0 ? -1 - std::ilogb(largest) : 0;
    const Soup a(source, source_points, exponent), b(target, target_points, exponent);
    Cover cover(a, b, bytes, check);
    double bound = 0;
    try {
        const CGAL::Protect_FPU_rounding<true> upward(
            WATCHED_ELSE("certificates: intervals are rounded outward", CGAL_FE_UPWARD, CGAL_FE_TONEAREST));
        bound = cover.run(looking);
        if (!a.exact() || !b.exact()) bound += WATCHED("certificates: coordinates that scaling loses", 0x1p-1073);
    } catch (const Refused& refused) {
        throw Refused(fmt::format("{}: {}", cover.place(), refused.what()));
    }
    return scaled_back(bound, exponent);
}

}  // namespace

CertificateCheck check_certificate(const Shape& source, const Pose& source_pose, const Shape& target,
                                   const Pose& target_pose, const Certificate& certificate,
                                   const std::function<void()>& looking) {
    const auto begin = std::chrono::steady_clock::now();
    CertificateCheck check;
    check.found = infinity;
    try {
        if (certificate.format != format_name)
            throw Refused(fmt::format("its format is not '{}', the one that this program reads", format_name));
        if (kind_of(source) == ShapeKind::surface || kind_of(target) == ShapeKind::surface)
            throw Refused("an algebraic surface has no triangles");
        const Standing a(source, source_pose), b(target, target_pose);
        if (WATCHED_ELSE("certificates: h(B,A)", certificate.direction == Witness::Direction::source_to_target, true))
            check.found = bound_of(source, a.points(), target, b.points(), certificate.bytes, check, looking);
        else
            check.found = bound_of(target, b.points(), source, a.points(), certificate.bytes, check, looking);
        check.accepted = WATCHED_ELSE("certificates: what is claimed",
                                      check.found <= certificate.proven,  // false if `proven` is NaN
                                      true);
        if (!check.accepted)
            check.refusal = fmt::format("triangle {}: its leaves show {:.17g}, and the certificate claims {:.17g}",
                                        check.worst, check.found, certificate.proven);
    } catch (const Refused& refused) {
        check.refusal = refused.what();
    }
    check.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return check;
}

}  // namespace hausbench
