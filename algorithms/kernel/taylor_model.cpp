#include "algorithms/kernel/taylor_model.h"

#include "algorithms/kernel/watched.h"

#include <cmath>
#include <limits>

namespace hausbench {
namespace {

constexpr double epsilon = 0x1p-52;      // |fl(x) - x| <= epsilon |x|, if fl rounds upward without underflow
constexpr double underflow = 0x1p-1000;  // more than all products of one operator can lose by underflow

// For each degree, the sum of the absolute values of its coefficients, rounded up.
using Norms = std::array<double, TaylorModel::order + 1>;

Norms norms(const TaylorModel& a) {
    Norms n{};
    for (int d = 0; d <= TaylorModel::order; ++d) {
        for (std::size_t i = TaylorModel::start(d); i < TaylorModel::start(d + 1); ++i)
            n[std::size_t(d)] += std::abs(a.c[i]);
    }
    return n;
}

double sum(const Norms& n) {
    double s = 0;
    for (const double x : n) s += x;
    return s;
}

// Adds the product of two polynomials to `out`, except for terms of degree above `most`.
void multiply(const TaylorModel& a, const TaylorModel& b, int most, TaylorModel& out) {
    for (int d = 0; d <= most; ++d) {
        const std::size_t from = TaylorModel::start(d);
        for (int i = 0; i + d <= most; ++i) {
            const double* other = b.c.data() + TaylorModel::start(i);
            double* to = out.c.data() + TaylorModel::start(d + i);
            for (int x = 0; x <= d; ++x) {
                const double factor = a.c[from + std::size_t(x)];
                if (factor == 0) continue;
                for (int y = 0; y <= i; ++y) to[x + y] += factor * other[y];
            }
        }
    }
}

// Returns an upper bound on linear * v + square * v^2 for |v| <= 1.
double most_on_line(const Interval& linear, const Interval& square) {
    const double b = magnitude(linear), a = square.sup();
    if (!(a < 0)) return b + a;
    return std::min(b, (CGAL::square(Interval(b)) / (Interval(-4.0) * Interval(a))).sup());
}

}  // namespace

TaylorModel TaylorModel::variable(double middle, double half, int which) {
    TaylorModel x;
    x.c[0] = middle;
    x.c[which == 0 ? 1 : 2] = half;
    return x;
}

double TaylorModel::spread() const {
    double s = error;
    for (std::size_t i = 1; i < count; ++i) s += std::abs(c[i]);
    return s;
}

Interval TaylorModel::range() const {
    const double s = spread();
    return Interval(c[0]) + Interval(-s, s);
}

// Let a, h and b be the coefficients of u^2, u v and u. If a < 0, completing the square gives, for every v,
//     a u^2 + (h v + b) u = a (u + (h v + b) / (2 a))^2 - (h v + b)^2 / (4 a) <= (h v + b)^2 / (-4 a).
// The right side is a quadratic polynomial in v alone. Together with the terms v and v^2 of p, it is bounded by
// most_on_line(). If the coefficient of v^2 is the smaller one, u and v are exchanged. Terms of degree 3 and more are
// bounded by their absolute values.
double TaylorModel::at_most() const {
    double higher = WATCHED("Taylor model, maximum: error", error);
    for (std::size_t i = start(3); i < count; ++i) higher += std::abs(c[i]);
    const bool swap = c[5] < c[3];
    const double b = swap ? c[2] : c[1], other_b = swap ? c[1] : c[2];
    const double a = swap ? c[5] : c[3], other_a = swap ? c[3] : c[5], h = c[4];
    double most = std::abs(b) + std::abs(other_b) + std::abs(h) + std::max(a, 0.0) + std::max(other_a, 0.0);
    if (a < 0) {
        const Interval quarter = Interval(1.0) / (Interval(-4.0) * Interval(a));
        const Interval linear = Interval(other_b) + 2.0 * Interval(h) * Interval(b) * quarter;
        const Interval square = Interval(other_a) + CGAL::square(Interval(h)) * quarter;
        most = std::min(most, (CGAL::square(Interval(b)) * quarter).sup() + most_on_line(linear, square));
    }
    return c[0] + most + WATCHED_ELSE("Taylor model, maximum: higher degrees", higher, error);
}

TaylorModel product(const TaylorModel& a, const TaylorModel& b, int most) {
    TaylorModel out;
    multiply(a, b, most, out);
    return out;
}

// The error of the result is the sum of three parts:
//   - the dropped products of terms whose degrees sum to more than `order`: `beyond`,
//   - the products with the errors of a and b,
//   - rounding. The coefficient of u^i v^j is a sum of (i + 1) (j + 1) products, which is at most 25, for u^4 v^4. Each
//     product is rounded, and so is each sum. Over all coefficients together, rounding costs at most 1.01 * 26 epsilon
//     times the sum of the absolute values of all products, which is at most all_a * all_b. The code uses 27 epsilon.
TaylorModel operator*(const TaylorModel& a, const TaylorModel& b) {
    TaylorModel out;
    multiply(a, b, TaylorModel::order, out);
    const Norms of_a = norms(a), of_b = norms(b);
    const double all_a = sum(of_a), all_b = sum(of_b);
    double beyond = 0, from = 0;  // `from`: the norm of all degrees of b that are too high for degree i of a
    for (int i = 1; i <= TaylorModel::order; ++i) {
        from += of_b[std::size_t(TaylorModel::order + 1 - i)];
        beyond += of_a[std::size_t(i)] * from;
    }
    out.error = WATCHED("Taylor model, product: error of b", all_a * b.error) +
                WATCHED("Taylor model, product: error of a", all_b * a.error) +
                WATCHED("Taylor model, product: both errors", a.error * b.error) +
                WATCHED("Taylor model, product: degrees beyond the order", beyond) +
                WATCHED("Taylor model, product: rounding", 27 * epsilon * (all_a * all_b)) +
                WATCHED("Taylor model, product: underflow", underflow);
    return out;
}

TaylorModel operator+(const TaylorModel& a, const TaylorModel& b) {
    TaylorModel out;
    double rounded = 0;
    for (std::size_t i = 0; i < TaylorModel::count; ++i) {
        out.c[i] = a.c[i] + b.c[i];
        rounded += std::abs(out.c[i]);
    }
    // Rounding a sum upward costs at most epsilon |exact sum| <= epsilon (1 + epsilon) |rounded sum|; the code uses 2
    // epsilon (epsilon is 2^-52). Sums do not underflow. A negative sum that overflows is rounded up to a finite
    // number, which nothing would notice, so models that large get an infinite error.
    out.error = rounded < 0x1p1000 ? WATCHED("Taylor model, sum: errors", a.error + b.error) +
                                         WATCHED("Taylor model, sum: rounding", 2 * epsilon * rounded)
                                   : std::numeric_limits<double>::infinity();
    return out;
}

TaylorModel operator*(const TaylorModel& a, const Interval& factor) {
    const double middle = 0.5 * factor.inf() + 0.5 * factor.sup(), off = magnitude(factor - Interval(middle));
    TaylorModel out;
    double size = 0;
    for (std::size_t i = 0; i < TaylorModel::count; ++i) {
        out.c[i] = middle * a.c[i];
        size += std::abs(a.c[i]);
    }
    const double most = std::abs(middle);
    out.error = WATCHED("Taylor model, factor: error", (most + off) * a.error) +
                WATCHED("Taylor model, factor: its width and rounding", (off + epsilon * most) * size) + underflow;
    return out;
}

ModelPowers::ModelPowers(const std::array<TaylorModel, 3>& at, const Polynomial& f, int most) : most_(most) {
    for (int k = 0; k < 3; ++k) {
        auto& powers = powers_[std::size_t(k)];
        powers.push_back(TaylorModel::variable(1, 0, 0));
        TaylorModel x = at[std::size_t(k)];
        if (WATCHED("polynomial: the origin of Taylor models", f.origin()[k] != 0))
            x = x + TaylorModel::variable(-f.origin()[k], 0, 0);
        for (int i = 1; i <= f.degree(k); ++i) {
            powers.push_back(i == 1                      ? x
                             : most < TaylorModel::order ? product(powers.back(), x, most)
                                                         : powers.back() * x);
        }
    }
}

TaylorModel ModelPowers::value(const Polynomial& f) const {
    TaylorModel sum;
    for (const Polynomial::Term& term : f.terms()) {
        const TaylorModel* factors[3];
        int n = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            if (term.powers[k] > 0) factors[n++] = &powers_[k][std::size_t(term.powers[k])];
        }
        TaylorModel monomial = n == 0 ? powers_[0][0] : *factors[0];
        for (int i = 1; i < n; ++i)
            monomial = most_ < TaylorModel::order ? product(monomial, *factors[i], most_) : monomial * *factors[i];
        sum = sum + monomial * term.coefficient;
    }
    return sum;
}

}  // namespace hausbench
