// A polynomial bounded over a box, in four forms of interval arithmetic.
//
// natural          the terms one by one, with sharp powers
// centred          the mean value form f(c) + f'(X) (X - c), see Neumaier: Interval methods for systems of equations, 1990
// affine           affine arithmetic, Stolfi and Figueiredo: Self-validated numerical methods and applications, 1997; what
//                  products add goes into one shared error term (form AF1 of Messine 2002)
// modified_affine  Martin, Shou, Voiculescu, Bowyer, Wang: Comparison of interval methods for plotting algebraic curves,
//                  CAGD 2002: the polynomial is expanded exactly in the noise symbols, and of a term whose powers are all
//                  even it is known that it does not change its sign
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/polynomial.h"

#include <string_view>

namespace hausbench {

enum class Form { natural, centred, affine, modified_affine };
// By Form.
inline constexpr std::string_view form_names[] = {"natural", "centred", "affine", "modified_affine"};

// f over the box of middle c and half widths r: for every point c + r u (componentwise, |u| <= 1) there is a number e in
// `rest` with f = slope.u + e. What `rest` holds beyond f(c) shrinks with the square of the box.
struct LinearForm {
    Vec3 middle, half;  // half widths rounded up
    Vec3 slope;
    Interval rest;

    Interval range() const;  // of f
};

// Holds working memory: one a thread. All of it wants UpwardRounding. A range or linear form costs O(terms + degree), with a
// constant of about 100 products.
class FormEvaluator {
public:
    explicit FormEvaluator(const Polynomial& polynomial);

    Interval range(Form form, const Box& box);
    LinearForm linear(const Box& box);

    const Polynomial& polynomial() const { return polynomial_; }
    std::uint64_t products() const { return products_; }  // multiplied so far for linear forms

private:
    // Of all monomials in u these are kept one by one, summed over the terms of f; those beyond are bounded term by term.
    static constexpr int kept = 6;  // total degree

    // (m + h u)^p along one axis: its coefficients up to `kept`, and the sums of those beyond of even and of odd powers. All
    // those of one parity have the same sign, because that of u^q is a positive number times m^(p-q).
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
    std::vector<Interval> sums_;  // coefficients of the monomials kept
    Interval rest_;
    double others_ = 0;  // of monomials that may have either sign
    std::uint64_t products_ = 0;
};

}  // namespace hausbench
