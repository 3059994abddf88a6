// Functions that are affine on a triangle, given by their values at the corners: the mean of their positive part, the
// mean of its square, and the share of the triangle on which they are positive.
//
// All results are sums, products and quotients of numbers that are not negative, so each has a relative error below
// 24u, where u = 2^-53.
#pragma once

#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <array>

namespace hausbench::distribution {

using CornerValues = std::array<double, 3>;

// The part of a triangle on which an affine function is positive, cut into at most two triangles.
struct PositivePart {
    struct Triangle {
        double share = 0;             // of the area of the whole triangle
        double first, second, third;  // the values of the function at its corners

        double mean() const { return (first + second + third) / 3; }
        double mean_square() const {
            return (first * first + second * second + third * third + first * second + second * third + third * first) /
                   6;
        }
    };
    std::array<Triangle, 2> triangles;
    int count = 0;

    // Let a <= b <= c be the values. If only c > 0, the zero line cuts off a triangle at that corner, with edges that
    // are c / (c - a) and c / (c - b) times as long. If only a < 0, the zero line cuts the edge from b to a at the
    // fraction s = b / (b - a), and the edge from c to a at t = c / (c - a). Left are a triangle with the values b, c, 0
    // and the share s, and one with the values c, 0, 0 and the share (1 - s) t.
    explicit PositivePart(CornerValues values) {
        std::sort(values.begin(), values.end());
        const auto [a, b, c] =
            WATCHED_ELSE("distribution: the corners of an affine function are not clamped one by one", values,
                         (CornerValues{std::max(values[0], 0.0), std::max(values[1], 0.0), std::max(values[2], 0.0)}));
        if (!(c > 0)) return;
        if (a >= 0) {
            triangles[count++] = {1, a, b, c};
        } else if (b <= 0) {
            triangles[count++] = {c / (c - a) * (c / (c - b)), c, 0, 0};
        } else {
            triangles[count++] = {b / (b - a), b, c, 0};
            triangles[count++] = {-a / (b - a) * (c / (c - a)), c, 0, 0};
        }
    }

    double share() const {
        return sum([](const Triangle& t) { return t.share; });
    }
    double mean() const {
        return sum([](const Triangle& t) { return t.share * t.mean(); });
    }
    double mean_square() const {
        return sum([](const Triangle& t) { return t.share * t.mean_square(); });
    }

private:
    template <class Of> double sum(const Of& of) const {
        double all = 0;
        for (int i = 0; i < count; ++i) all += of(triangles[static_cast<std::size_t>(i)]);
        return all;
    }
};

// Returns the share of a triangle on which an affine function is at most `most`.
inline double share_at_most(const CornerValues& values, double most) {
    const auto [low, high] = std::minmax({values[0], values[1], values[2]});
    if (high <= most) return 1;
    if (low > most) return 0;
    return PositivePart({most - values[0], most - values[1], most - values[2]}).share();
}

// Returns the share of a triangle on which an affine function is greater than `least`.
inline double share_above(const CornerValues& values, double least) {
    const auto [low, high] = std::minmax({values[0], values[1], values[2]});
    if (high <= least) return 0;
    if (low > least) return 1;
    return PositivePart({values[0] - least, values[1] - least, values[2] - least}).share();
}

}  // namespace hausbench::distribution
