// Computes bounds on the values of a polynomial f over a box X with middle c, by four methods of interval arithmetic.
//
// natural          Bounds each term on its own, with the smallest interval for each power, and adds the bounds.
// centred          The mean value form f(c) + f'(X) (X - c). Source: Neumaier, Interval methods for systems of
//                  equations, 1990.
// affine           Affine arithmetic: each value is a linear function of the position in the box (three variables in
//                  [-1, 1]) plus an error term, which collects the errors of all products (form AF1 of Messine, 2002).
//                  Source: Stolfi and Figueiredo, Self-validated numerical methods and applications, 1997.
// modified_affine  Expands the polynomial in the same three variables and bounds each monomial. A monomial whose powers
//                  are all even does not change sign, which makes its bound tighter. Source: Martin, Shou, Voiculescu,
//                  Bowyer and Wang, Comparison of interval methods for plotting algebraic curves, CAGD 2002.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/polynomial.h"

#include <string_view>

namespace hausbench {

enum class Form { natural, centred, affine, modified_affine };
// Indexed by Form.
inline constexpr std::string_view form_names[] = {"natural", "centred", "affine", "modified_affine"};

// A linear approximation of a polynomial f over a box, with a bound on its error. The points of the box are middle +
// half * u, coordinate by coordinate, for u in [-1, 1]^3. At each of them, f is the dot product slope.u plus a number
// in `rest`. This interval contains f(middle), and its width shrinks with the square of the box size.
struct LinearForm {
    Vec3 middle, half;  // the half widths are rounded up
    Vec3 slope;         // per unit of u: about the gradient times `half`
    Interval rest;

    // Returns an interval that contains all values of f in the box.
    Interval range() const;
};

// Computes bounds on one polynomial over any number of boxes. Each thread needs its own evaluator, because an evaluator
// reuses its scratch memory. All functions require UpwardRounding (interval.h) and take at most O(terms * degree) time.
class FormEvaluator {
public:
    explicit FormEvaluator(const Polynomial& polynomial);

    // Returns an interval that contains all values of the polynomial in the box.
    Interval range(Form form, const Box& box);
    // Returns the linear approximation from which Form::modified_affine takes its bounds.
    LinearForm linear(const Box& box);

    const Polynomial& polynomial() const { return polynomial_; }
    // Returns the number of products that linear() has computed so far, directly or for Form::modified_affine.
    std::uint64_t products() const { return products_; }

private:
    // Monomials up to this total degree are summed over all terms of the polynomial before they are bounded. Monomials
    // of higher degree are bounded term by term, which limits the cost.
    static constexpr int kept = 6;

    // The power (m + h u)^p, expanded in u; along one axis, m is the middle of the box and h its half width. `low`
    // holds the coefficients up to u^kept; `even` and `odd` are the sums of the coefficients of all higher even and odd
    // powers. The coefficient of u^q is a positive number times m^(p-q), so all coefficients of even powers have the
    // same sign, and so do all coefficients of odd powers.
    struct Power {
        std::array<Interval, kept + 1> low;
        Interval even, odd;
        int top;  // min(p, kept)
    };

    void set_powers(const Vec3& middle, const Vec3& half);
    void add(const Polynomial::Term& term);  // expands a term of f and adds it to sums_, rest_ and others_
    void add_beyond(const Power& x, const Power& y, const Power& z);
    Interval& sum_of(int i, int j, int k) { return sums_[std::size_t((i * (kept + 1) + j) * (kept + 1) + k)]; }
    Interval affine(const Vec3& middle, const Vec3& half) const;

    Polynomial polynomial_;
    std::array<Polynomial, 3> derivatives_;
    std::array<std::vector<Power>, 3> powers_;
    std::vector<Interval> sums_;  // coefficients of the monomials up to degree `kept`
    Interval rest_;               // the constant plus bounds on the monomials that do not change sign
    double others_ = 0;           // upper bound on the absolute value of the sum of all other monomials
    std::uint64_t products_ = 0;
};

}  // namespace hausbench
