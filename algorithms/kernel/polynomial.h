// Polynomials in x, y and z, read from text.
//
//     sum     = [+ -] product { + product | - product }
//     product = power { * power | / power }        a divisor must be a nonzero number
//     power   = atom [ ^ digits ]                  such as x^2
//     atom    = number | x | y | z | ( sum )
//
// Numbers are decimal ("2", "0.125", "1e-3"). Coefficients are not rounded: if no double is equal to one, it is kept as
// an interval that contains it. For 1/9, the ends of the interval are two neighbouring doubles.
#pragma once

#include "algorithms/kernel/geometry.h"
#include "algorithms/kernel/interval.h"

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

// A polynomial in x, y and z, multiplied out: a sum of terms. Each term is a coefficient times powers of x - o_x,
// y - o_y and z - o_z, where o is the origin.
class Polynomial {
public:
    struct Term {
        std::array<int, 3> powers;
        Interval coefficient;
    };

    // Reads a text in x, y and z, and multiplies it out to terms with this origin. Throws InputError for text that does
    // not match the grammar above (the message gives the column, counted from 1, and says what to change), powers above
    // 40, more than 100 nested parentheses, more than 10 million products of terms, a polynomial without x, y and z,
    // and coefficients that are not finite. Sets the rounding mode itself.
    explicit Polynomial(std::string_view text, const Vec3& origin = Vec3::Zero());

    // Returns the polynomial of a surface in a form that is accurate in the surface's box.
    //
    // If the box is far from 0, the origin is the middle of the box: with origin 0, large terms such as x^2 would
    // cancel each other and lose the shape of the surface. The text is read with x replaced by o_x + (x - o_x) before
    // anything is multiplied out, so a factor such as (x - 1000000)^2 loses no precision. A text that was multiplied
    // out by its author has lost it already, in its rounded coefficients.
    //
    // If some values in the box may exceed 2^100, or all are below 2^-100, the polynomial is multiplied by a power of
    // two, so that squares of its values neither overflow nor underflow. This does not change the zeros. Throws like
    // the constructor.
    static Polynomial of(const AlgebraicSurface& surface);

    // The origin matters only to code that reads terms(). All functions take points in the original coordinates.
    const Vec3& origin() const { return origin_; }

    // Sorted by powers. No coefficient is exactly 0.
    const std::vector<Term>& terms() const { return terms_; }
    int degree(int axis) const { return degrees_[static_cast<std::size_t>(axis)]; }

    Polynomial derivative(int axis) const;  // sets the rounding mode itself, too

    // Returns the value as computed with doubles, without an error bound: use it only for results that are proven in
    // another way. O(terms).
    double value(const Vec3& at) const;
    double value(const Vec3& at, Vec3& gradient) const;

    // Returns an interval that contains the values at all points of a box. It is computed term by term, so it is wide
    // if terms cancel each other (see interval_form.h). Requires UpwardRounding.
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

// Returns a message if the data do not define a surface, or an empty string if they do. The possible reasons are a text
// that is not a polynomial, a box whose corners are not finite, a box without volume, and a polynomial whose values
// overflow in the box.
std::string surface_problem(const AlgebraicSurface& surface);

}  // namespace hausbench
