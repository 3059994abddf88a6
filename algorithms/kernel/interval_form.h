// Bounds on the values of a polynomial f over a box X with middle c, by four methods of interval arithmetic.
//
// natural          Bounds each term on its own, with the smallest interval for each power, and adds the bounds.
// centred          The mean value form f(c) + f'(X) (X - c). Source: Neumaier, Interval methods for systems of
//                  equations, 1990.
// affine           Affine arithmetic: numbers are linear functions of the position in the box, which is three variables
//                  in [-1, 1], plus an error; the errors of all products go into one shared error term (form AF1 of
//                  Messine, 2002). Source: Stolfi and Figueiredo, Self-validated numerical methods and applications,
//                  1997.
// modified_affine  Expands the polynomial exactly in these three variables, and uses that a term whose powers are all
//                  even does not change sign. Source: Martin, Shou, Voiculescu, Bowyer and Wang, Comparison of interval
//                  methods for plotting algebraic curves, CAGD 2002.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/polynomial.h"

#include <string_view>

namespace hausbench {

enum class Form { natural, centred, affine, modified_affine };
// Indexed by Form.
inline constexpr std::string_view form_names[] = {"natural", "centred", "affine", "modified_affine"};

// A linear function that approximates f over a box, and the error. The points of the box are middle + half * u with u
// in [-1, 1]^3 (products by coordinate). At each of them, f = slope.u + e, for some e in the interval `rest`. This
// interval contains f(middle), and its width shrinks with the square of the size of the box.
struct LinearForm {
    Vec3 middle, half;  // the half widths are rounded up
    Vec3 slope;         // for u, so it is the gradient times `half`
    Interval rest;

    // Returns an interval that contains all values of f.
    Interval range() const;
};

// Evaluates one polynomial over boxes. It holds scratch memory, so each thread needs its own. All functions require
// UpwardRounding. A range or linear form takes O(terms + degree) time, up to about 100 products of intervals per term.
class FormEvaluator {
public:
    explicit FormEvaluator(const Polynomial& polynomial);

    // Returns an interval that contains all values in the box.
    Interval range(Form form, const Box& box);
    // Returns the linear form that modified_affine uses.
    LinearForm linear(const Box& box);

    const Polynomial& polynomial() const { return polynomial_; }
    // Returns the number of products of intervals computed so far. Only linear(), which modified_affine uses, counts
    // them.
    std::uint64_t products() const { return products_; }

private:
    // Expanded in u, each term of f gives many monomials. Up to this total degree, each monomial has one coefficient,
    // summed over all terms of f. Monomials of higher degree are bounded for each term on its own.
    static constexpr int kept = 6;

    // The expanded power (m + h u)^p along one axis, where m is the middle of the box and h its half width: the
    // coefficients of u^0 to u^kept, and the sums of the coefficients of all higher even powers and of all higher odd
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
    Interval rest_;               // the constant, and an interval for the monomials that do not change sign
    double others_ = 0;           // upper bound on the absolute value of the sum of all other monomials
    std::uint64_t products_ = 0;
};

}  // namespace hausbench
