#include "verify.h"

#include "verify_surface.h"

#include <CGAL/Exact_rational.h>
#include <CGAL/Interval_nt.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/squared_distance_3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace hausbench {

namespace {

using Interval = CGAL::Interval_nt<false>;
using Rational = CGAL::Exact_rational;
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
        out[i] = ((pose.rotation(i, 0) * v[0] + pose.rotation(i, 1) * v[1]) + pose.rotation(i, 2) * v[2]) + pose.translation[i];
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

// A double at or above the square root, and one at or below: guessed in floating point, settled in rationals.
double root_at_least(const Rational& square) {
    double root = std::sqrt(CGAL::to_double(square));
    if (!std::isfinite(root)) return std::numeric_limits<double>::infinity();
    while (Rational(root) * Rational(root) < square) root = up(root);
    return root;
}
double root_at_most(const Rational& square) {
    double root = std::sqrt(CGAL::to_double(square));
    if (!std::isfinite(root)) root = std::numeric_limits<double>::max();
    while (root > 0 && Rational(root) * Rational(root) > square) root = down(root);
    return root;
}

// A foot on the element that is about the nearest; only its quality, not the proof, hangs on it.
Vec3 rough_foot(const Vec3& p, const Element& e) {
    if (e.size() == 1) return e[0];
    const Vec3 ab = e[1] - e[0], ac = e[2] - e[0], normal = ab.cross(ac);
    const double area = normal.squaredNorm();
    if (area > 0) {
        const double v = normal.dot((p - e[0]).cross(ac)) / area, w = normal.dot(ab.cross(p - e[0])) / area;
        if (v >= 0 && w >= 0 && v + w <= 1) return e[0] + v * ab + w * ac;
    }
    Vec3 best = e[0];
    for (int i = 0; i < 3; ++i) {
        const Vec3 &s = e[std::size_t(i)], &t = e[std::size_t((i + 1) % 3)];
        const double length = (t - s).squaredNorm();
        const double at = length > 0 ? std::clamp((p - s).dot(t - s) / length, 0.0, 1.0) : 0.0;
        const Vec3 foot = s + at * (t - s);
        if ((p - foot).squaredNorm() < (p - best).squaredNorm()) best = foot;
    }
    return best;
}

// True only if every point of the element is proven to be at least r away from p. Upward rounding must be on.
bool separated(const Vec3& p, const Element& e, double r) {
    Vec3 n = p - rough_foot(p, e);
    const double largest = n.cwiseAbs().maxCoeff();
    if (!(largest > 0) || !std::isfinite(largest)) return false;
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

struct Checker::Shapes {
    const Shape &source, &target;
};

Checker::Checker(const Shape& source, const Shape& target) : shapes_(new Shapes{source, target}) {}
Checker::~Checker() = default;

bool Checker::lower_holds(double lower, const Witness& witness, const Pose& pose, double& shown) const {
    const Vec3 p = witness.source_point;
    // How far p is from A posed: from the element the witness names, else from the nearest.
    const auto off = [&](Index i) {
        Element corners = element(shapes_->source, i);
        for (Vec3& v : corners) v = moved(v, pose);
        return corners;
    };
    std::optional<Rational> off_squared;
    if (witness.source_element >= 0 && witness.source_element < element_count(shapes_->source)) {
        off_squared = squared_distance(p, off(witness.source_element));
    } else {
        double nearest = std::numeric_limits<double>::infinity();
        for (Index i = 0; i < element_count(shapes_->source); ++i) {
            const Element corners = off(i);
            const double d = (p - rough_foot(p, corners)).squaredNorm();
            if (d < nearest) nearest = d, off_squared = squared_distance(p, corners);
        }
    }
    const double e = off_squared ? root_at_least(*off_squared) : std::numeric_limits<double>::infinity();
    const double r = e == 0 ? lower : up(lower + e);

    std::vector<Index> doubtful;  // those that interval arithmetic does not settle
    {
        CGAL::Protect_FPU_rounding<true> upward;
        for (Index i = 0; i < element_count(shapes_->target); ++i) {
            if (!separated(p, element(shapes_->target, i), r)) doubtful.push_back(i);
        }
    }
    std::optional<Rational> nearest;
    for (Index i : doubtful) {
        const Rational d = squared_distance(p, element(shapes_->target, i));
        if (!nearest || d < *nearest) nearest = d;
    }
    shown = nearest ? down(root_at_most(*nearest) - e) : lower;
    if (e == 0 && nearest) shown = root_at_most(*nearest);
    return !nearest || Rational(r) * Rational(r) <= *nearest;
}

void verify_rows(std::vector<Row>& rows, const std::function<const Shape*(const std::string&)>& load) {
    using SceneKey = std::tuple<std::string, std::string, std::vector<double>>;
    std::map<SceneKey, std::vector<std::size_t>> scenes;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Case& c = rows[i].asked;
        const Bounds& b = rows[i].outcome.bounds;
        if (std::isnan(b.lower) || std::isnan(b.upper)) {
            if (!rows[i].outcome.solver_status.empty()) {  // it did answer
                rows[i].check = {Verdict::unsound, Verdict::unsound, "a bound is not a number"};
            }
            continue;
        }
        std::vector<double> pose(c.pose.rotation.data(), c.pose.rotation.data() + 9);
        pose.insert(pose.end(), c.pose.translation.data(), c.pose.translation.data() + 3);
        scenes[{c.source, c.target, pose}].push_back(i);
    }
    for (const auto& [key, members] : scenes) {
        const Shape *source = load(std::get<0>(key)), *target = load(std::get<1>(key));
        if (!source || !target) continue;
        const bool surfaces = kind_of(*source) == ShapeKind::surface && kind_of(*target) == ShapeKind::surface;
        const Checker checker(*source, *target);
        double best = 0;  // the largest verified lower bound; 0 always holds
        std::map<std::vector<double>, bool> known;  // many rows share a witness and a bound
        for (std::size_t i : members) {
            const Outcome& outcome = rows[i].outcome;
            const Vec3& p = outcome.witness.source_point;
            if (!(outcome.bounds.lower > 0)) {  // 0 needs no witness
                rows[i].check.lower = outcome.bounds.lower <= 0 ? Verdict::holds : Verdict::unsound;
                continue;
            }
            if (!p.allFinite()) {
                rows[i].check.lower = Verdict::no_witness;
                continue;
            }
            const std::vector<double> same{p[0], p[1], p[2], double(outcome.witness.source_element), outcome.bounds.lower};
            double shown = 0;
            if (surfaces) {
                rows[i].check.lower = check_surface_lower(std::get<AlgebraicSurface>(*source), std::get<AlgebraicSurface>(*target), outcome.bounds.lower, p, shown);
                if (rows[i].check.lower == Verdict::holds) best = std::max(best, outcome.bounds.lower);
                if (rows[i].check.lower == Verdict::unsound) {
                    rows[i].check.reason = fmt::format("lower {:.17g}: the target has a point {:.17g} from the witness", outcome.bounds.lower, shown);
                }
                continue;
            }
            const auto before = known.find(same);
            const bool holds = before != known.end() ? before->second : std::isfinite(outcome.bounds.lower) &&
                               checker.lower_holds(outcome.bounds.lower, outcome.witness, rows[i].asked.pose, shown);
            known[same] = holds;
            rows[i].check.lower = holds ? Verdict::holds : Verdict::unsound;
            if (holds) best = std::max(best, outcome.bounds.lower);
            else rows[i].check.reason = fmt::format("lower {:.17g} is above what its witness shows ({:.17g})", outcome.bounds.lower, shown);
        }
        // Without a witness a lower bound can still be refuted: it is above an upper bound that is certified.
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i : members) {
            if (rows[i].asked.certified == 1 && rows[i].check.lower == Verdict::holds) least = std::min(least, rows[i].outcome.bounds.upper);
        }
        for (std::size_t i : members) {
            const double lower = rows[i].outcome.bounds.lower;
            if (rows[i].check.lower != Verdict::no_witness || !(lower > least) || least < best) continue;
            rows[i].check.lower = Verdict::unsound;
            rows[i].check.reason = fmt::format("lower {:.17g} is above the certified upper bound {:.17g} of another row", lower, least);
        }
        for (std::size_t i : members) {
            const Bounds& b = rows[i].outcome.bounds;
            rows[i].check.upper = b.upper >= best && b.upper >= b.lower ? Verdict::holds : Verdict::unsound;
            if (rows[i].check.upper != Verdict::unsound) continue;
            if (!rows[i].check.reason.empty()) rows[i].check.reason += "; ";
            rows[i].check.reason += b.upper < b.lower ? fmt::format("upper {:.17g} is below lower {:.17g}", b.upper, b.lower)
                                                  : fmt::format("upper {:.17g} is below the verified lower bound {:.17g}", b.upper, best);
        }
    }
    for (Row& row : rows) {
        if (row.check.lower != Verdict::unsound && row.check.upper != Verdict::unsound) continue;
        row.outcome.status = "unsound";
        row.outcome.reason = row.check.reason;
    }
}

}  // namespace hausbench
