#include "algorithms/surfaces/enclosure/feet.h"

#include "algorithms/kernel/taylor_model.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/surfaces/enclosure/beside.h"

#include <cmath>

namespace hausbench::surface_enclosure {
namespace {

constexpr int order = TaylorModel::order;

using Models = std::array<TaylorModel, 3>;

double squared_length(const Models& t) { return (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]).at_most(); }

// A piece of A as the graph of a polynomial P: coordinate `axis` as a function of the other two, up to an error. This
// is step 1 of the proof in feet.h.
class Graph {
public:
    Graph(const SurfaceTree::Node& piece, SurfaceTree& source, int axis) : piece_(piece), source_(source), axis_(axis) {
        for (int k = 0, which = 0; k < 3; ++k) {
            if (k != axis)
                y_[std::size_t(k)] = TaylorModel::variable(piece.form.middle[k], piece.form.half[k], which++);
        }
    }

    // Finds the polynomial P with Newton's method: its value over the middle of the piece, then its coefficients,
    // degree by degree. Proves nothing. Returns false on failure.
    bool find(const Vec3& p) {
        Vec3 at = piece_.form.middle, gradient;
        at[axis_] = p[axis_];
        for (int step = 0; step < 6; ++step) {
            const double f = source_.polynomial().value(at, gradient);
            at[axis_] -= f / gradient[axis_];
        }
        if (!(std::abs(at[axis_] - piece_.form.middle[axis_]) <= 4 * piece_.form.half[axis_])) return false;
        TaylorModel& height = y_[std::size_t(axis_)];
        height.c[0] = at[axis_];
        for (int d = 1; d <= order; ++d) {
            const TaylorModel f = ModelPowers(y_, source_.polynomial(), d).value(source_.polynomial());
            for (std::size_t i = TaylorModel::start(d); i < TaylorModel::start(d + 1); ++i)
                height.c[i] -= f.c[i] / gradient[axis_];
        }
        return true;
    }

    // Proves that the piece lies within M / m of the graph of P, and sets this as the error of coordinate `axis`. Here
    // |f_A| <= M on the graph, and |df_A/dx| >= m along the axis. Returns false if m is not positive: the piece may
    // then not be a graph.
    bool prove(Counters& counters) {
        TaylorModel& height = y_[std::size_t(axis_)];
        const Interval values = height.range();
        Box wide = piece_.box;
        if (WATCHED("feet: the box of the slope holds the graph", true))
            wide.low[axis_] = std::min(wide.low[axis_], values.inf());
        wide.high[axis_] = std::max(wide.high[axis_], values.sup());
        const Interval slope = source_.derivative(axis_, wide, counters);
        const double least = std::max(slope.inf(), -slope.sup());
        if (!(least > 0)) return false;
        const Interval f = ModelPowers(y_, source_.polynomial()).value(source_.polynomial()).range();
        height.error = WATCHED("feet: how far A is from its polynomial", magnitude(f) / least);
        return true;
    }

    const Models& points() const { return y_; }

private:
    const SurfaceTree::Node& piece_;
    SurfaceTree& source_;
    int axis_;
    Models y_;
};

// Finds polynomials t: t(y) is about the vector from a point y of the graph to its closest point z on B. Proves
// nothing. Newton's method solves z - y + m * grad f_B(z) = 0 and f_B(z) = 0 for z and a factor m, first for the middle
// of the piece, then degree by degree.
class Feet {
public:
    Feet(const Models& y, const SurfaceTree& target) : y_(y), target_(target) {}

    bool find(const Vec3& foot) {
        const Vec3 y(y_[0].c[0], y_[1].c[0], y_[2].c[0]);
        const auto middle = target_.newton(y, foot);
        if (!middle) return false;
        std::array<TaylorModel, 4> unknown;
        for (std::size_t k = 0; k < 3; ++k) unknown[k].c[0] = middle->at[Eigen::Index(k)];
        unknown[3].c[0] = middle->factor;
        for (int d = 1; d <= order; ++d) correct(unknown, middle->inverse, d);
        double size = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t i = 0; i < TaylorModel::count; ++i) to_foot_[k].c[i] = unknown[k].c[i] - y_[k].c[i];
            size = std::max(size, std::abs(to_foot_[k].c[0]));
        }
        // Sets a component of t to 0 if it is only rounding noise. Otherwise y + t might leave a box that the piece
        // touches from inside, as with two cylinders around one axis that end at the same sides of the box.
        for (TaylorModel& t : to_foot_) {
            if (std::abs(t.c[0]) + t.spread() < 0x1p-36 * size) t = {};
        }
        return true;
    }

    const Models& to_foot() const { return to_foot_; }

private:
    // Improves the coefficients of degree d of z and m (`unknown`) with one step of Newton's method. `inverse` is the
    // inverse of the Jacobian in the middle of the piece.
    void correct(std::array<TaylorModel, 4>& unknown, const Eigen::Matrix4d& inverse, int d) const {
        const ModelPowers powers({unknown[0], unknown[1], unknown[2]}, target_.polynomial(), d);
        std::array<TaylorModel, 4> residual;
        for (std::size_t k = 0; k < 3; ++k)
            residual[k] = product(unknown[3], powers.value(target_.derivative(static_cast<int>(k))), d);
        residual[3] = powers.value(target_.polynomial());
        for (std::size_t i = TaylorModel::start(d); i < TaylorModel::start(d + 1); ++i) {
            Eigen::Vector4d of;
            for (std::size_t k = 0; k < 4; ++k) {
                of[Eigen::Index(k)] = residual[k].c[i];
                if (k < 3) of[Eigen::Index(k)] += unknown[k].c[i] - y_[k].c[i];
            }
            const Eigen::Vector4d change = inverse * of;
            for (std::size_t k = 0; k < 4; ++k) unknown[k].c[i] -= change[Eigen::Index(k)];
        }
    }

    const Models& y_;
    const SurfaceTree& target_;
    Models to_foot_;
};

Models longer(const Models& t, double factor) {  // the proof holds for any t, so rounding here needs no bound
    Models out = t;
    for (TaylorModel& of : out) {
        for (double& c : of.c) c *= factor;
    }
    return out;
}

// Returns whether y and y + t lie in the box for every y of the piece.
bool stays_inside(const SurfaceTree::Node& piece, const Models& t, const Box& box) {
    for (int k = 0; k < 3; ++k) {
        const Interval moved = Interval(piece.box.low[k], piece.box.high[k]) + t[std::size_t(k)].range();
        if (!(piece.box.low[k] >= box.low[k] && piece.box.high[k] <= box.high[k])) return false;
        if (!(moved.inf() >= box.low[k] && moved.sup() <= box.high[k])) return false;  // false for NaN, too
    }
    return true;
}

}  // namespace

double along_feet(const SurfaceTree::Node& piece, SurfaceTree& source, SurfaceTree& target, const Vec3& p,
                  const Vec3& foot, double limit, Counters& counters) {
    Vec3 gradient;
    source.polynomial().value(p, gradient);
    int axis = 0;
    gradient.cwiseAbs().maxCoeff(&axis);
    const Interval slope = source.derivative(axis, piece.box, counters);
    if (slope.inf() <= 0 && slope.sup() >= 0) return infinity;
    ++counters.polynomial_evaluations;
    Graph graph(piece, source, axis);
    if (!graph.find(p)) return infinity;
    Feet feet(graph.points(), target);
    if (!feet.find(foot)) return infinity;
    Models t = feet.to_foot();
    if (!(CGAL::sqrt(Interval(std::max(squared_length(t), 0.0))).inf() < limit)) return infinity;
    if (!graph.prove(counters)) return infinity;
    const Models& y = graph.points();
    const Polynomial& f = target.polynomial();
    const Interval here = ModelPowers(y, f).value(f).range();
    if (WATCHED("feet: both signs of f_B on the piece", !(here.inf() > 0 || here.sup() < 0)))
        return within(piece, target, magnitude(here), counters);
    const double sign = here.inf() > 0 ? 1 : -1;
    const Vec3 way(t[0].c[0], t[1].c[0], t[2].c[0]);
    f.value(Vec3(y[0].c[0], y[1].c[0], y[2].c[0]) + way, gradient);
    // The decrease of |f_B| at the end of t, per unit of s, if t is multiplied by 1 + s.
    const double fall = -sign * gradient.dot(way);
    if (!(fall > 0)) return infinity;
    double further = 0;
    for (int tries = 0; tries < 4; ++tries) {
        if (tries > 0) t = longer(feet.to_foot(), 1 + further);
        const Interval there = ModelPowers({y[0] + t[0], y[1] + t[1], y[2] + t[2]}, f).value(f).range();
        const double left = sign > 0 ? there.sup() : -there.inf();
        if (left <= 0) {
            if (WATCHED("feet: the box of B", !stays_inside(piece, t, target.box()))) return infinity;
            return CGAL::sqrt(Interval(std::max(squared_length(t), 0.0))).sup();
        }
        further += WATCHED("feet: farther than the foot", 1.1 * left / fall);
        if (!(further < 0.25)) return infinity;
    }
    return infinity;
}

}  // namespace hausbench::surface_enclosure
