#include "harness/check/verify_penetration.h"

#include "algorithms/kernel/watched.h"
#include "harness/check/verify_exact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Object.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>
#include <boost/variant/get.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
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

// Returns whether the segment pq crosses a triangle; `doubtful` if it meets an edge or a corner, or if p or q lies in
// the plane of the triangle.
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

// A solid in its pose. Omits repeated triangles and triangles with two equal corners, as the solver does.
struct Body {
    Body(const Shape& shape, const Pose& pose) : surface(shape, pose) {
        if (!surface.finite()) return;
        std::set<std::array<std::array<double, 3>, 3>> seen;
        for (Index i = 0; i < surface.count(); ++i) {
            const Element element = surface[i];
            std::array<std::array<double, 3>, 3> corners;
            for (std::size_t k = 0; k < 3; ++k)
                corners[k] = {element[k][0] + 0.0, element[k][1] + 0.0, element[k][2] + 0.0};  // -0 is 0
            std::sort(corners.begin(), corners.end());
            if (corners[0] == corners[1] || corners[1] == corners[2] ||
                WATCHED("verify_penetration: triangles that are there twice", !seen.insert(corners).second))
                continue;
            Eigen::AlignedBox3d box;
            for (const Vec3& v : element) box.extend(v);
            triangles.push_back(i);
            boxes.push_back(box);
            whole.extend(box);
        }
    }

    // Returns whether p lies inside the solid, or nothing if p lies on the surface or every tested ray meets an edge.
    std::optional<bool> holds(const Vec3& p) const {
        if (!whole.contains(p)) return false;
        const double length = 2 * whole.diagonal().norm();
        constexpr int rays = 16;
        for (int ray = 1; ray <= rays; ++ray) {
            // The rays run almost along x, so that their boxes meet few triangles. Different tilts help to avoid edges.
            const Vec3 end = p + length * Vec3(1, 1e-3 * ray, 7e-4 * (rays - ray + 1));
            Eigen::AlignedBox3d way(p);
            way.extend(end);
            int crossed = 0;
            bool doubtful = false;
            for (std::size_t k = 0; k < triangles.size() && !doubtful; ++k) {
                if (!way.intersects(boxes[k])) continue;
                const Crossing met = crossing(point(p), point(end), surface[triangles[k]]);
                doubtful = met == Crossing::doubtful;
                crossed += met == Crossing::clean;
            }
            if (!doubtful) return crossed % 2 == 1;
        }
        return std::nullopt;
    }

    // Returns whether the segment pq meets the surface; true also if this is doubtful.
    bool crossed_by(const Vec3& p, const Vec3& q) const {
        Eigen::AlignedBox3d way(p);
        way.extend(q);
        for (std::size_t k = 0; k < triangles.size(); ++k) {
            if (way.intersects(boxes[k]) && crossing(point(p), point(q), surface[triangles[k]]) != Crossing::none)
                return true;
        }
        return false;
    }

    // Returns whether the other surface meets the connected part of this surface that contains the triangle. O(n m) for
    // surfaces of n and m triangles.
    bool connected_surface_meets(Index triangle, const Body& other) const {
        std::map<std::array<double, 3>, std::vector<std::size_t>> around;
        const auto key = [](const Vec3& v) { return std::array<double, 3>{v[0] + 0.0, v[1] + 0.0, v[2] + 0.0}; };
        std::vector<std::size_t> part;
        std::vector<bool> seen(triangles.size(), false);
        for (std::size_t k = 0; k < triangles.size(); ++k) {
            for (const Vec3& v : surface[triangles[k]]) around[key(v)].push_back(k);
            if (triangles[k] == triangle) {
                part.push_back(k);
                seen[k] = true;
            }
        }
        for (std::size_t i = 0; i < part.size(); ++i) {
            const Element element = surface[triangles[part[i]]];
            for (std::size_t k = 0; k < other.triangles.size(); ++k) {
                if (boxes[part[i]].intersects(other.boxes[k]) &&
                    CGAL::do_intersect(exact(element), exact(other.surface[other.triangles[k]])))
                    return true;
            }
            for (const Vec3& v : element) {
                for (const std::size_t next : around.at(key(v))) {
                    if (!seen[next]) {
                        part.push_back(next);
                        seen[next] = true;
                    }
                }
            }
        }
        return false;
    }

    Standing surface;
    std::vector<Index> triangles;            // indices of the triangles that are not omitted
    std::vector<Eigen::AlignedBox3d> boxes;  // the box of each of these triangles
    Eigen::AlignedBox3d whole;
};

bool nearer(const Rational& squared, double r) { return squared < Rational(r) * Rational(r); }

// Returns whether two triangles share a point that is nearer to p than r. To be safe, returns true if a triangle is
// degenerate, or if they overlap in one plane.
bool meet_near(const Element& e, const Element& other, const Vec3& p, double r) {
    const Triangle a = exact(e), b = exact(other);
    if (a.is_degenerate() || b.is_degenerate()) return true;
    // CGAL 5 and 6 return different types here; both convert to this one.
    const CGAL::Object common = CGAL::intersection(a, b);
    if (common.empty()) return false;
    if (const auto* at = CGAL::object_cast<Exact::Point_3>(&common))
        return nearer(CGAL::squared_distance(exact(p), *at), r);
    if (const auto* along = CGAL::object_cast<Exact::Segment_3>(&common))
        return nearer(CGAL::squared_distance(exact(p), *along), r);
    return true;
}

// Returns the triangles of a body that are nearer to p than r.
std::vector<Index> near(const Body& body, const Vec3& p, double r) {
    std::vector<Index> indices;
    for (const Index i : body.triangles)
        if (!body.surface.beyond(i, p, r) && nearer(squared_distance(p, body.surface[i]), r)) indices.push_back(i);
    return indices;
}

std::string unsound(const char* bound, double value, const std::string& why) {
    return fmt::format("{} {:.17g}: {}", bound, value, why);
}

}  // namespace

// The two solids, and results of earlier checks.
struct PenetrationChecker::Pair {
    Pair(const Shape& a, const Pose& a_pose, const Shape& b, const Pose& b_pose, Stop given)
        : source(a, a_pose),
          target(b, WATCHED_ELSE("verify_penetration: poses", b_pose, Pose{})),
          stop(std::move(given)) {
        double largest = 0;
        for (const Body* body : {&source, &target}) {
            if (!body->surface.finite() || body->triangles.empty()) return;
            largest = std::max(largest, body->surface.points().cwiseAbs().maxCoeff());
            const double size = body->whole.diagonal().norm();
            if (!std::isfinite(8 * size)) return;  // a ray would end at infinity
            // Its square underflows, and a ray may end too early.
            if (WATCHED("verify penetration: rays through tiny solids", !(size > 0x1p-500))) return;
        }
        usable = true;
        slack = 1e-10 * largest;
    }

    // Checks a lower bound by its witness. Returns `holds` if it is proven, `unsound` and the reason if it is refuted,
    // else `no_witness` or `not_checked`.
    Verdict lower(double lower, const Witness& witness, std::string& reason) const {
        if (!std::isfinite(lower)) {
            reason = "lower is infinite, and no two points are that far apart";
            return Verdict::unsound;
        }
        const bool forward = witness.direction == Witness::Direction::source_to_target;
        const Vec3& p = forward ? witness.source_point : witness.target_point;
        if (!p.allFinite()) return Verdict::no_witness;
        const Body &body = forward ? source : target, &other = forward ? target : source;
        const std::vector<Index> at = near(body, p, 2 * slack);
        if (WATCHED("verify_penetration: the witness lies on its surface", at.empty())) {
            reason = unsound("lower", lower, "the witness is not on its surface");
            return Verdict::unsound;
        }
        const auto inside = other.holds(p);
        if (WATCHED("verify_penetration: the witness lies in the other solid",
                    inside != std::optional(true) && near(other, p, 2 * slack).empty())) {
            if (!inside) return Verdict::not_checked;
            reason = unsound("lower", lower, "the witness does not lie in the other solid");
            return Verdict::unsound;
        }
        const double r = lower - 4 * slack;  // p and the nearest point may each be off by 2 * slack
        if (!(r > 0)) return Verdict::holds;
        bool settled = true;
        std::vector<Vec3> outside;  // nearer points that do not bound the common volume
        const std::vector<Index> around = near(body, p, r);
        for (const Index i : near(other, p, r)) {
            if (stop && stop()) return Verdict::not_checked;
            const Element element = other.surface[i];
            const Vec3 q = p + rough_offset(p, element);
            const bool cut = std::any_of(around.begin(), around.end(),
                                         [&](Index k) { return meet_near(element, body.surface[k], p, r); });
            if (WATCHED_ELSE(
                    "verify_penetration: a nearer triangle that crosses the first solid",
                    !cut &&
                        WATCHED_ELSE("verify_penetration: nearer triangles within the first solid",
                                     body.holds(q) == std::optional(false) && near(body, q, 2 * slack).empty(), true),
                    body.holds(q) != std::optional(true))) {
                outside.push_back(q);
            } else if (same_part(p, q)) {
                reason = bounded(lower, p, q);
                return Verdict::unsound;
            } else {
                settled = false;
            }
        }
        if (settled && !outside.empty()) return beside(lower, p, at.front(), body, other, outside, reason);
        return settled ? Verdict::holds : Verdict::not_checked;
    }

    static std::string bounded(double lower, const Vec3& p, const Vec3& q) {
        return unsound("lower", lower,
                       fmt::format("the same part of the volume is bounded {:.17g} from the witness", (q - p).norm()));
    }

    // Returns whether the segment pq is proven to lie in both solids. Ignores 8 * slack at either end, because p and q
    // may lie on a surface.
    bool within_both(const Vec3& p, const Vec3& q) const {
        const double length = (q - p).norm(), step = 8 * slack / length;
        if (!(step < 0.25)) return false;
        const Vec3 begin = p + step * (q - p), end = q - step * (q - p), middle = 0.5 * (p + q);
        return source.holds(middle) == std::optional(true) && target.holds(middle) == std::optional(true) &&
               WATCHED_ELSE("verify_penetration: another part of the volume refutes nothing",
                            !source.crossed_by(begin, end) && !target.crossed_by(begin, end), true);
    }

    // Returns whether p and q, points on the surfaces, are proven to bound the same part of the common volume: a
    // segment inside both solids joins them. Because the segment pq may run along a surface, also tries segments
    // between inner points near p and q.
    bool same_part(const Vec3& p, const Vec3& q) const {
        if (within_both(p, q)) return true;
        const double aside = std::max(1e-4 * (q - p).norm(), 64 * slack);
        const std::vector<Vec3> around_p = inner_points(p, aside), around_q = inner_points(q, aside);
        return std::any_of(around_p.begin(), around_p.end(), [&](const Vec3& a) {
            return std::any_of(around_q.begin(), around_q.end(), [&](const Vec3& b) { return within_both(a, b); });
        });
    }

    // Returns up to four points at about this distance from the surface point p. The segments from p to them are proven
    // to lie inside both solids.
    std::vector<Vec3> inner_points(const Vec3& p, double distance) const {
        std::vector<Vec3> points;
        for (int direction = 0; direction < 24 && points.size() < 4;
             ++direction) {  // 3 rotations of one vector, 8 sign patterns
            Vec3 way(1, 0.7, 0.4);
            for (int k = 0; k < 3; ++k)
                if ((direction >> k & 1) != 0) way[k] = -way[k];
            const int turn = direction / 8;
            const Vec3 q = p + distance * Vec3(way[turn], way[(turn + 1) % 3], way[(turn + 2) % 3]);
            if (within_both(p, q)) points.push_back(q);
        }
        return points;
    }

    // Returns the verdict on `lower` if the surface of `other` is nearer to the witness p, a point on the surface of
    // `body`, but only at points outside `body`. These do not bound the part of the common volume at p. If `other`
    // bounds this part elsewhere, the bound holds. Otherwise `other` encloses the part, so the depth is the distance to
    // its whole surface, and the bound is refuted.
    Verdict beside(double lower, const Vec3& p, Index at, const Body& body, const Body& other,
                   const std::vector<Vec3>& outside, std::string& reason) const {
        if (WATCHED_ELSE("verify_penetration: an enclosed part is as far from the whole of the other mesh",
                         body.connected_surface_meets(at, other), true))
            return Verdict::holds;
        bool within = false;  // a vertex of the other mesh may lie inside `body`
        for (const Index i : other.triangles) {
            if (stop && stop()) return Verdict::not_checked;
            for (const Vec3& v : other.surface[i]) {
                if (body.holds(v) == std::optional(false)) continue;
                if (same_part(p, v)) return Verdict::holds;
                within = true;
            }
        }
        if (within) return Verdict::not_checked;
        reason = bounded(lower, p, *std::min_element(outside.begin(), outside.end(), [&](const Vec3& a, const Vec3& b) {
                             return (a - p).norm() < (b - p).norm();
                         }));
        return Verdict::unsound;
    }

    // Returns a vertex of one mesh that lies inside the other solid, at least `length` away from its surface. Returns
    // nothing if there is none. O(|A| |B|).
    std::optional<Vec3> deeper_than(double length) const {
        for (const auto& [body, other] : {std::pair{&source, &target}, std::pair{&target, &source}}) {
            std::set<std::array<double, 3>> seen;
            for (const Index i : body->triangles) {
                for (const Vec3& p : body->surface[i]) {
                    if (!other->whole.contains(p) || !seen.insert({p[0], p[1], p[2]}).second) continue;
                    if (stop && stop()) return std::nullopt;
                    if (WATCHED("verify_penetration: vertices that lie deeper",
                                other->holds(p) == std::optional(true) && deep(*other, p, length)))
                        return p;
                }
            }
        }
        return std::nullopt;
    }

    // Returns whether p is at least `length` away from the surface of the body.
    static bool deep(const Body& body, const Vec3& p, double length) {
        const Standing& surface = body.surface;
        for (const Index i : body.triangles)  // often a triangle is clearly nearer, which is cheap to see
            if (!surface.beyond(i, p, length) && rough_offset(p, surface[i]).norm() < 0.999 * length) return false;
        return near(body, p, length).empty();
    }

    Body source, target;
    Stop stop;
    double slack = 0;
    bool usable = false;  // coordinates are finite, sizes neither too large nor too small
    double proven = 0;    // the largest lower bound that held, minus 4 * slack
    double shallow = std::numeric_limits<double>::infinity();  // an earlier search has shown that no vertex is deeper
};

PenetrationChecker::PenetrationChecker(const Shape& source, const Pose& source_pose, const Shape& target,
                                       const Pose& target_pose, Stop stop)
    : pair_(std::make_unique<Pair>(source, source_pose, target, target_pose, std::move(stop))) {}

PenetrationChecker::~PenetrationChecker() = default;

Check PenetrationChecker::check(const Bounds& bounds, const Witness& witness) {
    Check result;
    if (!pair_->usable) return result;
    const auto add = [&](const std::string& reason) { result.reason += (result.reason.empty() ? "" : "; ") + reason; };
    std::string reason;
    result.lower = bounds.lower <= 0 ? Verdict::holds : pair_->lower(bounds.lower, witness, reason);
    if (!reason.empty()) add(reason);
    if (result.lower == Verdict::holds) pair_->proven = std::max(pair_->proven, bounds.lower - 4 * pair_->slack);
    const double upper = bounds.upper + 4 * pair_->slack;
    result.upper = Verdict::holds;
    const auto refuted = [&](const std::string& why) {
        result.upper = Verdict::unsound;
        add(unsound("upper", bounds.upper, why));
    };
    if (upper < bounds.lower) {
        refuted("it is below lower");
    } else if (upper < 0) {
        refuted("a depth is at least 0");
    } else if (std::isfinite(upper) && upper < pair_->shallow) {
        const auto deeper = pair_->deeper_than(upper);
        if (deeper)
            refuted(fmt::format("the vertex ({:.9g}, {:.9g}, {:.9g}) lies deeper in the other solid", (*deeper)[0],
                                (*deeper)[1], (*deeper)[2]));
        else
            pair_->shallow = upper;
    }
    if (pair_->stop && pair_->stop()) return {};
    return result;
}

bool PenetrationChecker::refutes(const Bounds& bounds, std::string& reason) const {
    if (!pair_->usable || bounds.upper + 4 * pair_->slack >= pair_->proven) return false;
    reason = unsound("upper", bounds.upper,
                     fmt::format("it is below the verified lower bound {:.17g} of another row", pair_->proven));
    return true;
}

}  // namespace hausbench
