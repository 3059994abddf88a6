// Polynomials in x, y and z, read from text.
//
//     sum     = [+ -] product { + product | - product }
//     product = power { * power | / power }        a divisor must be a nonzero number
//     power   = atom [ ^ digits ]                  such as x^2
//     atom    = number | x | y | z | ( sum )
//
// Numbers are decimal ("2", "0.125", "1e-3"). Coefficients are never rounded: one that no double equals, such as 1/9,
// is stored as an interval that contains it.
#pragma once

#include "algorithms/kernel/geometry.h"
#include "algorithms/kernel/interval.h"

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// A polynomial in x, y and z, expanded into a sum of terms. Each term is a coefficient times powers of x - o_x, y - o_y
// and z - o_z, where o is origin().
class Polynomial {
public:
    struct Term {
        std::array<int, 3> powers;
        Interval coefficient;
    };

    // Parses a polynomial and expands it around `origin`. Throws InputError if the text does not match the grammar
    // above; the message gives the column, counted from 1, and says what to change. Also throws InputError for a
    // constant, powers above 40, more than 100 nested parentheses, a coefficient that is not finite, or more than 10
    // million products of terms. Does not require UpwardRounding.
    explicit Polynomial(std::string_view text, const Vec3& origin = Vec3::Zero());

    // Returns the polynomial of a surface in a form that is accurate in the surface's box.
    //
    // If the box is far from 0, the origin is the middle of the box: with origin 0, large terms such as x^2 would
    // cancel each other and lose the shape of the surface. x is replaced with o_x + (x - o_x) before anything is
    // expanded, so a factor such as (x - 1000000)^2 loses no precision. A text that its author has already expanded has
    // lost precision in its rounded coefficients.
    //
    // If some values in the box may exceed 2^100, or all are below 2^-100, the polynomial is multiplied by a power of
    // two, so that squares of its values neither overflow nor underflow. This does not change the zeros. Throws like
    // the constructor.
    static Polynomial of(const AlgebraicSurface& surface);

    // Returns the point around which the polynomial is expanded. Only code that reads terms() needs it: all functions
    // take points in the original coordinates.
    const Vec3& origin() const { return origin_; }

    // Returns the terms, sorted by powers. No coefficient is exactly 0.
    const std::vector<Term>& terms() const { return terms_; }
    int degree(int axis) const { return degrees_[static_cast<std::size_t>(axis)]; }

    Polynomial derivative(int axis) const;  // does not require UpwardRounding

    // Returns the value computed with doubles, without an error bound. Use it only for results that are verified in
    // another way. O(terms).
    double value(const Vec3& at) const;
    double value(const Vec3& at, Vec3& gradient) const;

    // Returns an interval that contains all values in a box. It is computed term by term, so it is wide if terms cancel
    // each other; interval_form.h has tighter bounds. Requires UpwardRounding.
    Interval natural(const std::array<Interval, 3>& box) const;

private:
    Polynomial() = default;
    void finish();
    void normalise(const Points& box);

    Vec3 origin_ = Vec3::Zero();
    std::vector<Term> terms_;
    std::vector<double> middles_;  // the middles of the coefficients, for value()
    std::array<int, 3> degrees_{};
};

// Checks whether the data define a surface. Returns an error message if the text is not a polynomial, if the box has a
// coordinate that is not finite, if the box has no volume, or if the polynomial overflows in the box. Returns an empty
// string if the data are valid.
std::string surface_problem(const AlgebraicSurface& surface);

}  // namespace hausbench
