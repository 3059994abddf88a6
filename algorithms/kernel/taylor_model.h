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

    std::array<double, count> c{};  // coefficients of 1, u, v, u^2, u v, v^2, u^3, ..., v^8
    double error = 0;

    // Returns the index in `c` of the first coefficient of a degree.
    static constexpr std::size_t start(int degree) { return std::size_t(degree) * std::size_t(degree + 1) / 2; }
    // Returns the exact model of middle + half * u (for `which` = 0) or middle + half * v (for `which` = 1).
    static TaylorModel variable(double middle, double half, int which);

    // Returns an upper bound on how far values of the function are from the constant term of the polynomial.
    double spread() const;
    // Returns an interval that contains all values of the function.
    Interval range() const;
    // Returns an upper bound on the function. If the function has a maximum inside, the bound is tighter than
    // range().sup(), because it completes the squares in the quadratic part.
    double at_most() const;
};

// Multiplies the polynomials of two models and drops the terms of degree above `most`. The result has no error bound:
// use it only to find a polynomial whose properties are proven later.
TaylorModel product(const TaylorModel& a, const TaylorModel& b, int most);

// Return Taylor models of the product and the sum of two functions, and of a function times a number. The last one
// holds for every number in the interval `factor`.
TaylorModel operator*(const TaylorModel& a, const TaylorModel& b);
TaylorModel operator+(const TaylorModel& a, const TaylorModel& b);
TaylorModel operator*(const TaylorModel& a, const Interval& factor);

// Evaluates polynomials in x, y and z at three Taylor models, from the powers of these models. If `most` is below
// TaylorModel::order, terms of higher degree than `most` are dropped, and results have no error bounds.
class ModelPowers {
public:
    // Computes the powers of the models `at`, which stand for x, y and z, up to the degree of f in each variable.
    ModelPowers(const std::array<TaylorModel, 3>& at, const Polynomial& f, int most = TaylorModel::order);

    // Returns the Taylor model of f(x, y, z). f must have the same origin as the polynomial that the constructor
    // received, and no higher degrees.
    TaylorModel value(const Polynomial& f) const;

private:
    std::array<std::vector<TaylorModel>, 3> powers_;
    int most_;
};

}  // namespace hausbench
