#include "verify_penetration.h"

#include "verify_exact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>
#include <boost/variant/get.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace hausbench {
namespace {

using Predicates = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Simple_cartesian<Rational>;
using Triangle = Exact::Triangle_3;

Predicates::Point_3 point(const Vec3& v) { return {v[0], v[1], v[2]}; }
Exact::Point_3 exact(const Vec3& v) { return {Rational(v[0]), Rational(v[1]), Rational(v[2])}; }
Triangle exact(const Element& e) { return {exact(e[0]), exact(e[1]), exact(e[2])}; }

enum class Crossing { none, clean, doubtful };

// Of a segment and a triangle; doubtful where it meets an edge, a corner or the plane in one of its ends.
Crossing crossing(const Predicates::Point_3& p, const Predicates::Point_3& q, const Element& e) {
    const auto a = point(e[0]), b = point(e[1]), c = point(e[2]);
    const auto of_p = CGAL::orientation(a, b, c, p), of_q = CGAL::orientation(a, b, c, q);
    if (of_p == of_q && of_p != CGAL::COPLANAR) return Crossing::none;
    const auto ab = CGAL::orientation(p, q, a, b), bc = CGAL::orientation(p, q, b, c),
               ca = CGAL::orientation(p, q, c, a);
    const bool positive = ab == CGAL::POSITIVE || bc == CGAL::POSITIVE || ca == CGAL::POSITIVE;
    const bool negative = ab == CGAL::NEGATIVE || bc == CGAL::NEGATIVE || ca == CGAL::NEGATIVE;
    if (positive && negative) return Crossing::none;
    const bool touches = ab == CGAL::COPLANAR || bc == CGAL::COPLANAR || ca == CGAL::COPLANAR ||
                         of_p == CGAL::COPLANAR || of_q == CGAL::COPLANAR;
    return touches ? Crossing::doubtful : Crossing::clean;
}

// A solid in its pose.
struct Body {
    Body(const Shape& shape, const Pose& pose) : surface(shape, pose) {
        for (Index i = 0; i < surface.count(); ++i) {
            Eigen::AlignedBox3d box;
            for (const Vec3& v : surface[i]) box.extend(v);
            boxes.push_back(box);
            whole.extend(box);
        }
    }

    // Whether p lies inside; none on the surface itself, or where every ray meets an edge.
    std::optional<bool> holds(const Vec3& p) const {
        if (!whole.contains(p)) return false;
        const double length = 2 * whole.diagonal().norm();
        constexpr int rays = 16;
        for (int ray = 1; ray <= rays; ++ray) {
            // Along x, a little tilted, so that few boxes lie on its way.
            const Vec3 end = p + length * Vec3(1, 1e-3 * ray, 7e-4 * (rays - ray + 1));
            Eigen::AlignedBox3d way(p);
            way.extend(end);
            int crossed = 0;
            bool doubtful = false;
            for (Index i = 0; i < surface.count() && !doubtful; ++i) {
                if (!way.intersects(boxes[std::size_t(i)])) continue;
                const Crossing found = crossing(point(p), point(end), surface[i]);
                doubtful = found == Crossing::doubtful;
                crossed += found == Crossing::clean;
            }
            if (!doubtful) return crossed % 2 == 1;
        }
        return std::nullopt;
    }

    // Whether the segment meets the surface.
    bool crossed_by(const Vec3& p, const Vec3& q) const {
        Eigen::AlignedBox3d way(p);
        way.extend(q);
        for (Index i = 0; i < surface.count(); ++i) {
            if (way.intersects(boxes[std::size_t(i)]) && crossing(point(p), point(q), surface[i]) != Crossing::none)
                return true;
        }
        return false;
    }

    Standing surface;
    std::vector<Eigen::AlignedBox3d> boxes;
    Eigen::AlignedBox3d whole;
};

bool nearer(const Rational& squared, double r) { return squared < Rational(r) * Rational(r); }

// Whether a common point of two triangles is nearer to p than r; of two in one plane: whether there is one at all.
bool meet_near(const Element& e, const Element& other, const Vec3& p, double r) {
    const Triangle a = exact(e), b = exact(other);
    if (a.is_degenerate() || b.is_degenerate()) return true;
    const auto common = CGAL::intersection(a, b);
    if (!common) return false;
    if (const auto* at = boost::get<Exact::Point_3>(&*common)) return nearer(CGAL::squared_distance(exact(p), *at), r);
    if (const auto* along = boost::get<Exact::Segment_3>(&*common))
        return nearer(CGAL::squared_distance(exact(p), *along), r);
    return true;
}

// The triangles of a body that are nearer to p than r.
std::vector<Index> near(const Standing& surface, const Vec3& p, double r) {
    std::vector<Index> found;
    for (Index i = 0; i < surface.count(); ++i)
        if (!surface.beyond(i, p, r) && nearer(squared_distance(p, surface[i]), r)) found.push_back(i);
    return found;
}

std::string unsound(const char* bound, double value, const std::string& why) {
    return fmt::format("{} {:.17g}: {}", bound, value, why);
}

}  // namespace

struct PenetrationChecker::Pair {
    Pair(const Shape& a, const Pose& a_pose, const Shape& b, const Pose& b_pose, Stop asked)
        : source(a, a_pose), target(b, b_pose), stop(std::move(asked)) {
        double largest = 0;
        for (const Body* body : {&source, &target}) {
            if (!body->surface.finite()) return;
            largest = std::max(largest, body->surface.points().cwiseAbs().maxCoeff());
        }
        usable = true;
        slack = 1e-10 * largest;
    }

    // Proven, refuted with the reason, or neither.
    Verdict lower(double lower, const Witness& witness, std::string& reason) const {
        const bool forward = witness.direction == Witness::Direction::source_to_target;
        const Vec3& p = forward ? witness.source_point : witness.target_point;
        if (!p.allFinite()) return Verdict::no_witness;
        const Body &own = forward ? source : target, &other = forward ? target : source;
        if (near(own.surface, p, 2 * slack).empty()) {
            reason = unsound("lower", lower, "the witness is no point of its surface");
            return Verdict::unsound;
        }
        const auto inside = other.holds(p);
        if (inside == std::optional(false) && near(other.surface, p, 2 * slack).empty()) {
            reason = unsound("lower", lower, "the witness does not lie in the other solid");
            return Verdict::unsound;
        }
        const double r = lower - 4 * slack;  // what rounding explains, at both ends
        if (!(r > 0)) return Verdict::holds;
        bool settled = true;
        const std::vector<Index> around = near(own.surface, p, r);
        for (const Index i : near(other.surface, p, r)) {
            if (stop && stop()) return Verdict::not_checked;
            const Element element = other.surface[i];
            const Vec3 q = p + rough_offset(p, element);
            const bool cut = std::any_of(around.begin(), around.end(),
                                         [&](Index k) { return meet_near(element, own.surface[k], p, r); });
            if (!cut && own.holds(q) == std::optional(false)) continue;
            // Both ends lie on a surface: the segment between them without its ends is what must not cross one.
            const Vec3 begin = p + 1e-3 * (q - p), end = p + 0.999 * (q - p), middle = 0.5 * (p + q);
            if (own.holds(middle) == std::optional(true) && other.holds(middle) == std::optional(true) &&
                !own.crossed_by(begin, end) && !other.crossed_by(begin, end)) {
                reason = unsound(
                    "lower", lower,
                    fmt::format("the same part of the volume is bounded {:.17g} from the witness", (q - p).norm()));
                return Verdict::unsound;
            }
            settled = false;
        }
        return settled ? Verdict::holds : Verdict::not_checked;
    }

    // A vertex of one in the other, further than `length` from the other's surface; none if there is none. O(|A| |B|).
    std::optional<Vec3> deeper_than(double length) const {
        for (const auto& [own, other] : {std::pair{&source, &target}, std::pair{&target, &source}}) {
            const Points& vertices = own->surface.points();
            for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
                const Vec3 p = vertices.row(v).transpose();
                if (!other->whole.contains(p) || other->holds(p) != std::optional(true)) continue;
                if (stop && stop()) return std::nullopt;
                if (deep(other->surface, p, length)) return p;
            }
        }
        return std::nullopt;
    }

    static bool deep(const Standing& surface, const Vec3& p, double length) {
        for (Index i = 0; i < surface.count(); ++i)  // most are settled by a point that is clearly nearer
            if (!surface.beyond(i, p, length) && rough_offset(p, surface[i]).norm() < 0.999 * length) return false;
        return near(surface, p, length).empty();
    }

    Body source, target;
    Stop stop;
    double slack = 0;
    bool usable = false;                                               // the poses leave all coordinates finite
    mutable double shallow = std::numeric_limits<double>::infinity();  // no vertex is deeper: found for an earlier row
};

PenetrationChecker::PenetrationChecker(const Shape& source, const Pose& source_pose, const Shape& target,
                                       const Pose& target_pose, Stop stop)
    : pair_(std::make_unique<Pair>(source, source_pose, target, target_pose, std::move(stop))) {}

PenetrationChecker::~PenetrationChecker() = default;

Check PenetrationChecker::check(const Bounds& bounds, const Witness& witness) const {
    Check result;
    if (!pair_->usable) return result;
    const auto add = [&](const std::string& reason) { result.reason += (result.reason.empty() ? "" : "; ") + reason; };
    std::string reason;
    result.lower = bounds.lower <= 0 ? Verdict::holds : pair_->lower(bounds.lower, witness, reason);
    if (!reason.empty()) add(reason);
    result.upper = Verdict::holds;
    const double upper = bounds.upper + 4 * pair_->slack;
    if (upper < bounds.lower) {
        result.upper = Verdict::unsound;
        add(unsound("upper", bounds.upper, "it is below lower"));
    } else if (upper < pair_->shallow) {
        if (const auto deeper = pair_->deeper_than(upper)) {
            result.upper = Verdict::unsound;
            add(unsound("upper", bounds.upper,
                        fmt::format("the vertex ({:.9g}, {:.9g}, {:.9g}) lies deeper in the other solid", (*deeper)[0],
                                    (*deeper)[1], (*deeper)[2])));
        } else {
            pair_->shallow = upper;
        }
    }
    if (pair_->stop && pair_->stop()) return {};
    return result;
}

}  // namespace hausbench
