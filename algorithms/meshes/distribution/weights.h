// Areas of triangles and lengths of segments, as weights of the pieces of A.
#pragma once

#include "algorithms/kernel/quad.h"
#include "algorithms/kernel/triangle.h"
#include "algorithms/kernel/watched.h"

#include <cmath>

namespace hausbench::distribution {

// The area of a triangle lies between value * (1 - area_error) and value * (1 + area_error) + extra. `extra` is not
// negligible only for triangles that are nearly a segment.
struct Area {
    double value, extra;
};
inline constexpr double area_error = 0x1p-43;

// Returns the area. |Coordinates| must be at most 1.
//
// The area is half the length of n = x * y (cross product) for two edges x and y. Let u be the unit roundoff. An edge
// errs by u in each coordinate, a product by 3u and a difference of products by one more u: each coordinate of n errs
// by 4u (|x_i| |y_j| + |x_j| |y_i|), and n by at most 8u |x| |y| in length. The length errs by 2.5u and underflow takes
// less than 2^-536 (kernel/rounding.h, point to point).
// - In double precision, u = 2^-53. If |n| >= |x| |y| / 64, this is a relative error of 8u * 64 = 2^-44, and the rest
//   is below 2^-44.
// - Otherwise the coordinates of n are computed with 113 bits, u = 2^-113, so n errs by 2^-110 |x| |y|, and rounding
//   to double adds a relative error. Then `value` is lowered by half of `extra`, which is more than twice the error.
inline Area area_of(const Triangle& t) {
    const Vec3 x = t.b - t.a, y = t.c - t.a;
    const Vec3 n{x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
    const double area = 0.5 * std::sqrt(squared_length(n));
    const double edges = std::sqrt(squared_length(x)) * std::sqrt(squared_length(y));
    if (area >= edges * WATCHED_ELSE("distribution: areas of thin triangles", 0x1p-7, 0x1p-40) && area > 0x1p-450)
        return {area, 0};
    const auto component = [&](int i, int j) {
        const Quad xi = Quad(t.b[i]) - Quad(t.a[i]), xj = Quad(t.b[j]) - Quad(t.a[j]);
        const Quad yi = Quad(t.c[i]) - Quad(t.a[i]), yj = Quad(t.c[j]) - Quad(t.a[j]);
        return static_cast<double>(xi * yj - xj * yi);
    };
    const Vec3 precise{component(1, 2), component(2, 0), component(0, 1)};
    const double extra = edges * 0x1p-107 + 0x1p-530;
    return {std::fmax(0.5 * std::sqrt(squared_length(precise)) - 0.5 * extra, 0.0), extra};
}

// Returns the length of the edge from a to b, in the form of an area. Its relative error is below 4u, far less than
// area_error; underflow takes less than 2^-530. |Coordinates| must be at most 1.
inline Area length_of(const Triangle& t) {
    const double length = std::sqrt(squared_length(t.b - t.a));
    return {length, length > 0x1p-450 ? 0 : 0x1p-449};
}

// A sum of numbers that are not negative, with a relative error below 4u for fewer than 2^50 of them: adds the rounding
// error of each step to a second sum.
class Sum {
public:
    void add(double value) {
        const double sum = sum_ + value;
        lost_ += sum_ >= value ? (sum_ - sum) + value : (value - sum) + sum_;
        sum_ = sum;
    }
    double value() const { return sum_ + lost_; }

private:
    double sum_ = 0, lost_ = 0;
};

}  // namespace hausbench::distribution
