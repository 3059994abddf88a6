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

#include "algorithms/kernel/geometry.h"
#include "algorithms/kernel/interval.h"

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
    explicit Polynomial(std::string_view text, const Vec3& origin = Vec3::Zero());

    // Returns the polynomial of a surface for a search in its box. Far from 0 it is expanded about the middle of the
    // box: x^2 would cancel there and lose the surface. Each variable is replaced in the text before anything is
    // multiplied out, so factors such as (x - 1000000)^2 lose nothing; a text that is already multiplied out has lost
    // it in its coefficients. Values beyond 2^100 in the box, or all below 2^-100, are scaled by a power of two, so
    // that their squares neither overflow nor underflow; the zeros stay. Throws like the constructor.
    static Polynomial of(const AlgebraicSurface& surface);

    // The powers are those of x - origin(), y - ..., but every function takes points in plain coordinates.
    const Vec3& origin() const { return origin_; }

    // In the order of powers; no term's coefficient is exactly 0.
    const std::vector<Term>& terms() const { return terms_; }
    int degree(int axis) const { return degrees_[static_cast<std::size_t>(axis)]; }

    Polynomial derivative(int axis) const;  // sets the rounding mode for itself, too

    // Evaluates in double arithmetic, for uses that are proven otherwise. O(terms).
    double value(const Vec3& at) const;
    double value(const Vec3& at, Vec3& gradient) const;

    // Encloses the value at a point of a box, by its terms. Wants UpwardRounding.
    Interval natural(const std::array<Interval, 3>& box) const;

private:
    Polynomial() = default;
    void finish();
    void normalise(const Points& box);

    Vec3 origin_ = Vec3::Zero();
    std::vector<Term> terms_;
    std::vector<double> middles_;  // of the coefficients
    std::array<int, 3> degrees_{};
};

// Returns the reason why this is not a surface, empty if it is one: text that is not a polynomial, corners of the box
// that are not finite, a box without volume, or a polynomial whose values overflow in its box.
std::string surface_problem(const AlgebraicSurface& surface);

}  // namespace hausbench
