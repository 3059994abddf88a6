// Exact rational geometry for tests, written independently of the code under test.
#pragma once

#include "algorithms/scene.h"

#include <CGAL/Exact_rational.h>

#include <array>
#include <cmath>

namespace hausbench::exact {

using Rational = CGAL::Exact_rational;
using RVec3 = std::array<Rational, 3>;

inline RVec3 vector(const Vec3& v) { return {Rational(v[0]), Rational(v[1]), Rational(v[2])}; }
inline RVec3 operator-(const RVec3& a, const RVec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Rational dot(const RVec3& a, const RVec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline RVec3 along(const RVec3& a, const Rational& t, const RVec3& d) {
    return {a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2]};
}

inline Rational squared_distance(const RVec3& a, const RVec3& b) { return dot(a - b, a - b); }

inline Rational squared_distance_to_segment(const RVec3& p, const RVec3& a, const RVec3& b) {
    const RVec3 d = b - a;
    const Rational length = dot(d, d);
    if (length == 0) return squared_distance(p, a);
    Rational t = dot(p - a, d) / length;
    if (t < 0) t = 0;
    if (t > 1) t = 1;
    return squared_distance(p, along(a, t, d));
}

inline Rational squared_distance_to_triangle(const RVec3& p, const RVec3& a, const RVec3& b, const RVec3& c) {
    const RVec3 e = b - a, f = c - a, r = p - a;
    const Rational ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), re = dot(r, e), rf = dot(r, f);
    const Rational det = ee * ff - ef * ef;
    if (det != 0) {
        const Rational s = (re * ff - rf * ef) / det, t = (rf * ee - re * ef) / det;
        if (s >= 0 && t >= 0 && s + t <= 1) return squared_distance(p, along(along(a, s, e), t, f));
    }
    return std::min({squared_distance_to_segment(p, a, b), squared_distance_to_segment(p, b, c),
                     squared_distance_to_segment(p, c, a)});
}

// Returns the square root, accurate to about 60 bits if `squared` is in the range of normal doubles.
inline long double root(const Rational& squared) {
    const double high = CGAL::to_double(squared);
    if (std::isinf(high)) return high;
    const double low = CGAL::to_double(Rational(squared - Rational(high)));
    return std::sqrt(static_cast<long double>(high) + static_cast<long double>(low));
}

}  // namespace hausbench::exact
