// Polynomials in x, y and z, read from text.
//
//     sum     = [+ -] product { + product | - product }
//     product = power { * power | / power }        a divisor must be a nonzero number
//     power   = atom [ ^ digits ]                  such as x^2
//     atom    = number | x | y | z | ( sum )
//
// Numbers are decimal ("2", "0.125", "1e-3"). Coefficients are exact numbers: 1/9 is kept as an interval that
// contains it, two neighbouring doubles wide.
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

    // Throws InputError for text that does not match the grammar above (the message gives the column, counted from
    // 1, and the remedy), powers above 40, more than 100 nested parentheses or 10 million products of terms, a
    // polynomial without x, y and z, and coefficients that are not finite. Sets the rounding mode itself.
    explicit Polynomial(std::string_view text, const Vec3& origin = Vec3::Zero());

    // Returns the polynomial of a surface, prepared for a search in its box. If the box is far from 0, the
    // polynomial is expanded about the middle of the box, because x^2 would cancel there and lose the shape of the
    // surface. Each variable is replaced in the text before anything is multiplied out, so factors such as
    // (x - 1000000)^2 lose nothing; a text that is already multiplied out has lost precision in its coefficients.
    // If values in the box exceed 2^100, or all are below 2^-100, they are scaled by a power of two, which keeps
    // the zeros, so that their squares neither overflow nor underflow. Throws like the constructor.
    static Polynomial of(const AlgebraicSurface& surface);

    // The powers are powers of (point - origin()), but all functions take points in the original coordinates.
    const Vec3& origin() const { return origin_; }

    // Sorted by powers; no coefficient is exactly 0.
    const std::vector<Term>& terms() const { return terms_; }
    int degree(int axis) const { return degrees_[static_cast<std::size_t>(axis)]; }

    Polynomial derivative(int axis) const;  // sets the rounding mode itself, too

    // Returns the value in double arithmetic, for results that are proven in another way. O(terms).
    double value(const Vec3& at) const;
    double value(const Vec3& at, Vec3& gradient) const;

    // Returns an interval that contains the values at all points of a box, computed term by term. Requires
    // UpwardRounding.
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

// Returns why this is not a surface, or an empty string if it is one. The reasons: text that is not a polynomial,
// corners of the box that are not finite, a box without volume, or a polynomial whose values overflow in its box.
std::string surface_problem(const AlgebraicSurface& surface);

}  // namespace hausbench
