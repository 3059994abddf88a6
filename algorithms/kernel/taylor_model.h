// Taylor models in two variables: a polynomial p(u,v) of degree 8 with double coefficients, and a bound `error` on
// the difference between p and the represented function for all u and v in [-1, 1].
//
// See Makino and Berz: Taylor models and other validated functional inclusion methods, International Journal of
// Pure and Applied Mathematics 4 (2003). All functions require UpwardRounding (interval.h). Rounding errors of
// coefficients are added to `error`, so every result is an enclosure.
#pragma once

#include "algorithms/kernel/polynomial.h"

namespace hausbench {

struct TaylorModel {
    static constexpr int order = 8;
    static constexpr std::size_t count = (order + 1) * (order + 2) / 2;

    std::array<double, count> c{};  // by degree; within degree d from u^d to v^d
    double error = 0;

    static constexpr std::size_t start(int degree) { return std::size_t(degree) * std::size_t(degree + 1) / 2; }
    // Returns middle + half u (or half v), exactly.
    static TaylorModel variable(double middle, double half, int which);

    double spread() const;  // at least the largest |p(u,v) - p(0,0)| + error
    Interval range() const;
    // Returns an upper bound, tighter than range().sup() near a maximum because it bounds the quadratic part by its
    // largest value.
    double at_most() const;
};

// Multiplies the polynomials only: `error` is 0, and degrees above `most` are dropped without a bound. Use it only
// for polynomials that are proven in another way later.
TaylorModel product(const TaylorModel& a, const TaylorModel& b, int most);

TaylorModel operator*(const TaylorModel& a, const TaylorModel& b);
TaylorModel operator+(const TaylorModel& a, const TaylorModel& b);
TaylorModel operator*(const TaylorModel& a, const Interval& factor);

// The powers of three models, used to evaluate polynomials. If `most` is below the order, the models have no error
// bounds, as in product().
class ModelPowers {
public:
    // Computes the powers up to the degrees of f along each axis.
    ModelPowers(const std::array<TaylorModel, 3>& at, const Polynomial& f, int most = TaylorModel::order);

    TaylorModel value(const Polynomial& f) const;  // must not have higher degrees than the constructor's f

private:
    std::array<std::vector<TaylorModel>, 3> powers_;
    int most_;
};

}  // namespace hausbench
