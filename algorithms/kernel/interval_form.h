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

#include "box.h"
#include "polynomial.h"

#include <string_view>

namespace hausbench {

enum class Form { natural, centred, affine, modified_affine };
inline constexpr std::string_view form_names[] = {"natural", "centred", "affine", "modified_affine"};  // by Form

// f over the box of middle c and half widths r: for every point c + r u (componentwise, |u| <= 1) there is a number e in
// `rest` with f = slope.u + e. What `rest` holds beyond f(c) shrinks with the square of the box.
struct LinearForm {
    Vec3 middle, half;  // half widths rounded up
    Vec3 slope;
    Interval rest;

    Interval range() const;  // of f
};

// Holds working memory: one a thread. All of it wants UpwardRounding.
class FormEvaluator {
public:
    explicit FormEvaluator(const Polynomial& polynomial);

    Interval range(Form form, const Box& box);
    LinearForm linear(const Box& box);

    const Polynomial& polynomial() const { return polynomial_; }

private:
    void expand(const Vec3& middle, const Vec3& half);  // into work_: the coefficients of f(middle + half u)
    Interval affine(const Vec3& middle, const Vec3& half) const;

    Polynomial polynomial_;
    std::array<Polynomial, 3> derivatives_;
    std::array<std::size_t, 3> sizes_;    // degrees + 1
    std::vector<Interval> dense_, work_;  // coefficients by powers, z fastest
};

}  // namespace hausbench
