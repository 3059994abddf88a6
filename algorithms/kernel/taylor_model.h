// Taylor models of functions of two variables u and v in [-1, 1].
//
// A Taylor model of a function f consists of a polynomial p(u, v) of degree 8 with double coefficients, and a bound
// `error`: |f(u, v) - p(u, v)| <= error for all u and v in [-1, 1]. Sums and products of models include the rounding
// errors of their coefficients in `error`, so this holds for every result. All functions require UpwardRounding
// (interval.h).
//
// Source: Makino and Berz, Taylor models and other validated functional inclusion methods, International Journal of
// Pure and Applied Mathematics 4 (2003).
#pragma once

#include "algorithms/kernel/polynomial.h"

namespace hausbench {

struct TaylorModel {
    static constexpr int order = 8;
    static constexpr std::size_t count = (order + 1) * (order + 2) / 2;

    std::array<double, count> c{};  // of 1, u, v, u^2, u v, v^2, u^3, ..., v^8
    double error = 0;

    // Returns the index in `c` of the first coefficient of a degree.
    static constexpr std::size_t start(int degree) { return std::size_t(degree) * std::size_t(degree + 1) / 2; }
    // Returns the exact model of middle + half * u if `which` is 0, and of middle + half * v otherwise.
    static TaylorModel variable(double middle, double half, int which);

    // Returns an upper bound on |f(u, v) - p(0, 0)|.
    double spread() const;
    // Returns an interval that contains all values of f.
    Interval range() const;
    // Returns an upper bound on f. It is tighter than range().sup() if f has a maximum, because it completes the
    // squares in the quadratic part instead of adding the absolute values of its terms.
    double at_most() const;
};

// Returns the product of the polynomials without its terms of degrees above `most`. The result has error 0, so it
// proves nothing: use it only to find a polynomial whose properties are proven later.
TaylorModel product(const TaylorModel& a, const TaylorModel& b, int most);

// Return models of the product and the sum of two functions, and of a function times any number in `factor`.
TaylorModel operator*(const TaylorModel& a, const TaylorModel& b);
TaylorModel operator+(const TaylorModel& a, const TaylorModel& b);
TaylorModel operator*(const TaylorModel& a, const Interval& factor);

// The powers of three models that stand for x, y and z, to evaluate polynomials in x, y, z at these models. If `most`
// is below `order`, all degrees above it are dropped and results have no error bounds, as in product().
class ModelPowers {
public:
    // Computes the powers of each model up to the degree of f along its axis. `at` holds the models of x, y and z.
    ModelPowers(const std::array<TaylorModel, 3>& at, const Polynomial& f, int most = TaylorModel::order);

    // Returns the model of f(x, y, z). This f must have the origin of the constructor's f, and no higher degrees.
    TaylorModel value(const Polynomial& f) const;

private:
    std::array<std::vector<TaylorModel>, 3> powers_;
    int most_;
};

}  // namespace hausbench
