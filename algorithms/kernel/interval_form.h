// Bounds of a polynomial over a box, in four forms of interval arithmetic.
//
// natural          term by term, with sharp powers
// centred          the mean value form f(c) + f'(X) (X - c), see Neumaier: Interval methods for systems of equations, 1990
// affine           affine arithmetic, Stolfi and Figueiredo: Self-validated numerical methods and applications, 1997; the
//                  errors of products go into one shared error term (form AF1 of Messine 2002)
// modified_affine  Martin, Shou, Voiculescu, Bowyer, Wang: Comparison of interval methods for plotting algebraic curves,
//                  CAGD 2002: the polynomial is expanded exactly in the noise symbols, and terms whose powers are all even
//                  are known not to change sign
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/polynomial.h"

#include <string_view>

namespace hausbench {

enum class Form { natural, centred, affine, modified_affine };
// Indexed by Form.
inline constexpr std::string_view form_names[] = {"natural", "centred", "affine", "modified_affine"};

// A linear form of f over the box with middle c and half widths r: at every point c + r u (componentwise,
// |u| <= 1), f = slope.u + e for some e in `rest`. The part of `rest` beyond f(c) shrinks with the square of the
// box.
struct LinearForm {
    Vec3 middle, half;  // half widths rounded up
    Vec3 slope;
    Interval rest;

    Interval range() const;  // of f
};

// Evaluates one polynomial over boxes. It holds working memory, so use one per thread. All functions require
// UpwardRounding. A range or linear form costs O(terms + degree), with a constant of about 100 products.
class FormEvaluator {
public:
    explicit FormEvaluator(const Polynomial& polynomial);

    Interval range(Form form, const Box& box);
    LinearForm linear(const Box& box);

    const Polynomial& polynomial() const { return polynomial_; }
    std::uint64_t products() const { return products_; }  // computed so far, for linear forms only

private:
    // Monomials in u up to this total degree are kept one by one, summed over the terms of f. Monomials of higher
    // degree are bounded term by term.
    static constexpr int kept = 6;

    // (m + h u)^p along one axis: the coefficients of the powers up to `kept`, and two sums of the coefficients
    // beyond, one over even and one over odd powers. Coefficients of the same parity have the same sign, because
    // the coefficient of u^q is a positive number times m^(p-q).
    struct Power {
        std::array<Interval, kept + 1> low;
        Interval even, odd;
        int top;  // min(p, kept)
    };

    void set_powers(const Vec3& middle, const Vec3& half);
    void add(const Polynomial::Term& term);  // to sums_, rest_ and others_
    void add_beyond(const Power& x, const Power& y, const Power& z);
    Interval& sum_of(int i, int j, int k) { return sums_[std::size_t((i * (kept + 1) + j) * (kept + 1) + k)]; }
    Interval affine(const Vec3& middle, const Vec3& half) const;

    Polynomial polynomial_;
    std::array<Polynomial, 3> derivatives_;
    std::array<std::vector<Power>, 3> powers_;
    std::vector<Interval> sums_;  // coefficients of the kept monomials
    Interval rest_;
    double others_ = 0;  // bound of the monomials that may have either sign
    std::uint64_t products_ = 0;
};

}  // namespace hausbench
