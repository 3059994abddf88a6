// Polynomials in x, y and z, read from text.
//
//     sum     = [+ -] product { + product | - product }
//     product = power { * power | / power }        what stands after / must be a number other than 0
//     power   = atom [ ^ whole number ]            such as x^2
//     atom    = number | x | y | z | ( sum )
//
// Numbers are decimal ("2", "0.125", "1e-3"). The coefficients meant are the exact ones: 1/9 is kept as an interval that
// holds it, two neighbouring doubles wide.
#pragma once

#include "geometry.h"
#include "interval.h"

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

class Polynomial {
public:
    struct Term {
        std::array<int, 3> powers;
        Interval coefficient;
    };

    // Throws InputError for text that is none of the above (the column, from 1, and the remedy), powers above 40, more
    // than 100 nested parentheses or 10 million products of terms, a polynomial without x, y and z, or coefficients that are not finite.
    // Sets the rounding mode for itself.
    explicit Polynomial(std::string_view text);

    // In the order of powers; no term's coefficient is exactly 0.
    const std::vector<Term>& terms() const { return terms_; }
    int degree(int axis) const { return degrees_[static_cast<std::size_t>(axis)]; }

    Polynomial derivative(int axis) const;  // sets the rounding mode for itself, too

    // In double arithmetic, for what is proven otherwise. O(terms).
    double value(const Vec3& at) const;
    double value(const Vec3& at, Vec3& gradient) const;

    // Encloses the value at a point of a box, by its terms. Wants UpwardRounding.
    Interval natural(const std::array<Interval, 3>& box) const;

private:
    Polynomial() = default;
    void finish();

    std::vector<Term> terms_;
    std::vector<double> middles_;  // of the coefficients
    std::array<int, 3> degrees_{};
};

// What keeps this from being a surface, empty where it is one: text that is no polynomial, corners of the box that are not
// finite, a box without volume, a polynomial whose values overflow in its box.
std::string surface_problem(const AlgebraicSurface& surface);

}  // namespace hausbench
