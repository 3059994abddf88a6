// Quadrics in a box, and the distance between two of them by means that share nothing with the solvers: plain doubles,
// the exact Taylor expansion of a polynomial of degree two, roots of parabolas along lines, and d(p, B) being
// 1-Lipschitz in p.
//
// Rounding: values are below 1e4, so errors of double arithmetic are below 1e-10, which every decision allows for.
// `slack` covers the change of a distance by such an error. Apart from that, bounds are proven.
#pragma once

#include "tests/support/random.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <string>
#include <vector>

namespace hausbench {

struct Quadric {
    Eigen::Matrix3d form = Eigen::Matrix3d::Zero();  // x.form x + linear.x + constant, exactly
    Vec3 linear = Vec3::Zero();
    double constant = 0;
    std::string text, kind;
    Vec3 low = Vec3::Constant(-2), high = Vec3::Constant(2);  // the box

    double value(const Vec3& p) const { return p.dot(form * p) + linear.dot(p) + constant; }
    Vec3 gradient(const Vec3& p) const { return 2 * form * p + linear; }

    // Adds sign * (n.x + d)^2.
    void add_square(double sign, const Vec3& n, double d) {
        form += sign * n * n.transpose();
        linear += sign * 2 * d * n;
        constant += sign * d * d;
    }
    void add_product(const Vec3& n, double d, const Vec3& m, double e) {
        form += 0.5 * (n * m.transpose() + m * n.transpose());
        linear += e * n + d * m;
        constant += d * e;
    }
    void add_linear(const Vec3& n, double d) { linear += n, constant += d; }

    AlgebraicSurface surface() const {
        AlgebraicSurface s{text, Points(2, 3)};
        s.box.row(0) = low;
        s.box.row(1) = high;
        return s;
    }
};

inline std::string linear_text(const Vec3& n, double d) {
    return fmt::format("(({})*x + ({})*y + ({})*z + ({}))", n[0], n[1], n[2], d);
}

// Makes one of eleven kinds in turn. All numbers are multiples of 1/8, so text and coefficients mean the same polynomial.
inline Quadric random_quadric(Random& random, int kind) {
    Quadric q;
    const auto eighths = [&](int least, int most) { return double(least + int(random.below(most - least + 1))) / 8; };
    Vec3 n[3];
    double d[3];
    do {
        for (int i = 0; i < 3; ++i) {
            n[i] = Vec3(eighths(-10, 10), eighths(-10, 10), eighths(-10, 10));
            d[i] = eighths(-12, 12);
        }
    } while (std::abs(n[0].dot(n[1].cross(n[2]))) < 0.4 * n[0].norm() * n[1].norm() * n[2].norm() ||
             std::min({n[0].norm(), n[1].norm(), n[2].norm()}) < 0.5);
    for (int k = 0; k < 3; ++k) q.low[k] = eighths(-16, -8), q.high[k] = eighths(8, 16);
    const auto square = [&](int i) { return linear_text(n[i], d[i]) + "^2"; };
    struct Kind {
        const char* name;
        int squares[3];  // signs of the squares
        int linear;      // sign of the last form, which is not squared
        double constant;
    };
    static constexpr Kind kinds[] = {{"ellipsoid", {1, 1, 1}, 0, -1},
                                     {"hyperboloid of one sheet", {1, 1, -1}, 0, -0.5},
                                     {"hyperboloid of two sheets", {1, -1, -1}, 0, -0.125},
                                     {"cone", {1, 1, -1}, 0, 0},
                                     {"elliptic paraboloid", {1, 1, 0}, -1, 0},
                                     {"hyperbolic paraboloid", {1, -1, 0}, -1, 0},
                                     {"elliptic cylinder", {1, 1, 0}, 0, -1},
                                     {"hyperbolic cylinder", {1, -1, 0}, 0, -0.5},
                                     {"parabolic cylinder", {1, 0, 0}, -1, 0},
                                     {"parallel planes", {1, 0, 0}, 0, -0.25},
                                     {"crossing planes", {0, 0, 0}, 0, 0}};
    const Kind& k = kinds[kind % 11];
    q.kind = k.name;
    if (q.kind == "crossing planes") {
        q.add_product(n[0], d[0], n[1], d[1]);
        q.text = linear_text(n[0], d[0]) + "*" + linear_text(n[1], d[1]);
        return q;
    }
    q.text = fmt::format("({})", k.constant);
    q.constant = k.constant;
    for (int i = 0; i < 3; ++i) {
        if (k.squares[i] == 0) continue;
        q.add_square(k.squares[i], n[i], d[i]);
        q.text += (k.squares[i] > 0 ? " + " : " - ") + square(i);
    }
    if (k.linear) q.add_linear(-n[2], -d[2]), q.text += " - " + linear_text(n[2], d[2]);
    return q;
}

namespace quadric_reference {

constexpr double slack = 1e-7;

// Returns true if the box, given by its centre and half widths, certainly contains no point of the quadric.
inline bool misses(const Quadric& q, const Vec3& c, const Vec3& half) {
    return std::abs(q.value(c)) > q.gradient(c).cwiseAbs().dot(half) + half.dot(q.form.cwiseAbs() * half) + 1e-9;
}

// Returns a point of the quadric in the box, if its sign changes along an axis-parallel line through the centre.
inline std::optional<Vec3> point_in(const Quadric& q, const Vec3& c, const Vec3& half) {
    for (int k = 0; k < 3; ++k) {
        const double a = q.form(k, k), b = q.gradient(c)[k], f = q.value(c), root = b * b - 4 * a * f;
        if (root < 0) continue;
        const double s = -0.5 * (b + std::copysign(std::sqrt(root), b));
        for (const double t : {s != 0 ? f / s : 0.0, a != 0 ? s / a : 0.0}) {
            if (!(std::abs(t) <= half[k])) continue;
            Vec3 at = c, before = c, after = c;
            at[k] += t;
            before[k] = std::max(q.low[k], at[k] - 0.5 * slack), after[k] = std::min(q.high[k], at[k] + 0.5 * slack);
            const double first = q.value(before), last = q.value(after);
            if (std::abs(first) > 1e-10 && std::abs(last) > 1e-10 && (first > 0) != (last > 0)) return at;
        }
    }
    return std::nullopt;
}

struct Range {
    double lower, upper;
};

struct Entry {
    double key;
    Vec3 c, half;
    bool operator<(const Entry& other) const { return key < other.key; }  // the largest key first
};

template <class Do> void children(const Entry& e, Do&& act) {
    for (int i = 0; i < 8; ++i) {
        const Vec3 half = 0.5 * e.half;
        act(Vec3(e.c + half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1))), half);
    }
}

// Bounds d(p, B) to `precision`. The upper end is infinite if no point of B was found.
inline Range distance(const Vec3& p, const Quadric& b, double precision) {
    double best = std::numeric_limits<double>::infinity();
    std::priority_queue<Entry> open;  // keyed by minus the distance to the box
    open.push({0, 0.5 * (b.low + b.high), 0.5 * (b.high - b.low)});
    for (int looked = 0; !open.empty(); ++looked) {
        const Entry top = open.top();
        if (-top.key >= best - precision || looked == 20000) return {std::max(-top.key - slack, 0.0), best};
        open.pop();
        children(top, [&](const Vec3& c, const Vec3& half) {
            const double away = ((p - c).cwiseAbs() - half).cwiseMax(0).norm();
            if (away >= best || misses(b, c, half)) return;
            if (const auto at = point_in(b, c, half)) best = std::min(best, (p - *at).norm() + slack);
            open.push({-away, c, half});
        });
    }
    return {best == std::numeric_limits<double>::infinity() ? best : std::max(best - 2 * slack, 0.0), best};
}

// Bounds h(A,B) to `precision`, or as well as `most` boxes allow. Returns nothing if no point of a surface was found.
inline std::optional<Range> hausdorff(const Quadric& a, const Quadric& b, double precision, int most) {
    Range h{0, std::numeric_limits<double>::infinity()};
    bool some = false;
    std::priority_queue<Entry> open;  // keyed by an upper bound of the distance of A's part in the box
    open.push({h.upper, 0.5 * (a.low + a.high), 0.5 * (a.high - a.low)});
    for (int looked = 0; !open.empty(); ++looked) {
        const Entry top = open.top();
        h.upper = top.key;
        if (h.upper - h.lower <= precision || looked == most) break;
        open.pop();
        children(top, [&](const Vec3& c, const Vec3& half) {
            if (misses(a, c, half)) return;
            const double radius = half.norm();
            const auto at = point_in(a, c, half);
            const Vec3 p = at.value_or(c);
            const Range d = distance(p, b, std::max(0.25 * precision, 0.25 * radius));
            if (at && std::isfinite(d.upper)) some = true, h.lower = std::max(h.lower, d.lower - slack);
            const double upper = std::min(top.key, d.upper + (p - c).norm() + radius);
            if (upper > h.lower) open.push({upper, c, half});
        });
        if (open.empty()) h.upper = h.lower + 2 * slack;
    }
    if (!some || !std::isfinite(h.upper)) return std::nullopt;
    return h;
}

// Returns whether the quadric is proven to have no point in its box.
inline bool empty(const Quadric& q) {
    std::vector<Entry> open{{0, 0.5 * (q.low + q.high), 0.5 * (q.high - q.low)}};
    while (!open.empty()) {
        const Entry top = open.back();
        open.pop_back();
        if (misses(q, top.c, top.half)) continue;
        if (point_in(q, top.c, top.half) || top.half.maxCoeff() < 0.02) return false;
        children(top, [&](const Vec3& c, const Vec3& half) { open.push_back({0, c, half}); });
    }
    return true;
}

}  // namespace quadric_reference

}  // namespace hausbench
