// Numbered pairs of one triangle A and one triangle B, of every kind that rounding makes hard.
//
// The distance to a single triangle is convex, so h(A,B) is the largest distance of A's three
// corners. Its square is exact in rationals.
#pragma once

#include "algorithms/scene.h"
#include "tests/support/exact.h"
#include "tests/support/random.h"
#include "tests/support/triangle_samples.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace hausbench::degenerate {

struct Pair {
    Triangle a, b;
    std::string kind;  // such as "needle, touching, 1e8 away"
};

inline const std::vector<std::string>& forms() {
    static const std::vector<std::string> all = {"ordinary", "needle",        "cap",    "collinear",
                                                 "segment",  "equal corners", "a point"};
    return all;
}
inline const std::vector<std::string>& relations() {
    static const std::vector<std::string> all = {"apart", "one ulp", "touching", "coplanar", "on a grid"};
    return all;
}
inline const std::vector<std::string>& places() {
    static const std::vector<std::string> all = {"at home",      "1e8 away", "1e12 away", "scaled by 2^k",
                                                 "A 1e12 : 1 B", "1 : 1e12", "denormal"};
    return all;
}

inline std::array<Vec3*, 3> corners(Triangle& t) { return {&t.a, &t.b, &t.c}; }

inline Triangle of_form(std::size_t form, Random& random) {
    const double height = std::pow(10.0, random.real(-17, -1));
    switch (form) {
        case 0:
            return any(random);
        case 1:
            return thin(random, height, random.below(2));
        case 2:
            return thin(random, height, random.real(0.1, 0.9));
        case 3:
            return thin(random, 0, random.real(-1, 2));
        case 4: {  // exactly straight: multiples of 2^-20
            const Vec3 start = (random.vector() * 0x1p20).array().round() * 0x1p-20;
            const Vec3 step = (random.vector() * 0x1p18).array().round() * 0x1p-20;
            return {start, start + step, start + (random.below(2) ? 2.0 : 0.5) * step};
        }
        case 5: {
            Triangle t = any(random);
            (random.below(2) ? t.c : t.b) = t.a;
            return t;
        }
        default: {
            const Vec3 point = random.vector();
            return {point, point, point};
        }
    }
}

inline double one_ulp_away(double x, Random& random) {
    const Index way = random.below(3);
    return way == 0 ? x : std::nextafter(x, way == 1 ? -2e300 : 2e300);
}

inline Vec3 combined(const Triangle& t, double r, double s) { return t.a + r * (t.b - t.a) + s * (t.c - t.a); }

// Changes B, and in some relations A, to bring them into the given relation.
inline void relate(std::size_t relation, Triangle& a, Triangle& b, Random& random) {
    switch (relation) {
        case 1:
            b = a;
            for (Vec3* corner : corners(b))
                for (double& x : *corner) x = one_ulp_away(x, random);
            return;
        case 2:
            b.a = random.below(2) ? a.b : combined(a, random.unit(), 0);
            if (random.below(2)) b.b = a.c;
            if (random.below(4) == 0) b.c = combined(a, 0.25, 0.5);
            return;
        case 3: {
            const Index axis = random.below(4);
            for (Vec3* corner : corners(b))
                if (axis == 3) *corner = combined(a, random.real(-1, 2), random.real(-1, 2));
            if (axis < 3)
                for (Triangle* t : {&a, &b})
                    for (Vec3* corner : corners(*t)) (*corner)[axis] = 0.375;
            return;
        }
        case 4: {
            const double cells = std::ldexp(1.0, 1 + static_cast<int>(random.below(4)));
            for (Triangle* t : {&a, &b})
                for (Vec3* corner : corners(*t)) *corner = (*corner * cells).array().round() / cells;
            return;
        }
        default:
            return;
    }
}

inline void transform(Triangle& t, double factor, const Vec3& offset) {
    for (Vec3* corner : corners(t)) *corner = *corner * factor + offset;
}

inline void put(std::size_t place, Triangle& a, Triangle& b, Random& random) {
    if (place == 0) return;
    if (place == 1 || place == 2) {
        const double far = place == 1 ? 1e8 : 1e12;
        const Vec3 offset(random.below(2) ? far : 0, random.below(2) ? -far : far, far);
        for (Triangle* t : {&a, &b}) transform(*t, 1, offset);
    }
    if (place == 3) {
        const double factor = std::ldexp(1.0, static_cast<int>(random.below(1801)) - 900);
        for (Triangle* t : {&a, &b}) transform(*t, factor, Vec3::Zero());
    }
    if (place == 4) transform(a, 1e12, Vec3::Zero());
    if (place == 5) transform(a, 1e-12, Vec3::Zero());
    if (place == 6) {  // integer multiples of the smallest double
        const double units = std::ldexp(1.0, static_cast<int>(random.below(30)));
        for (Triangle* t : {&a, &b})
            for (Vec3* corner : corners(*t)) *corner = (*corner * units).array().round() * 0x1p-1074;
    }
}

// Returns a numbered pair. Consecutive numbers cycle through all forms, relations and places.
inline Pair pair(std::uint64_t seed, std::uint64_t number) {
    Random random(seed * 0x100000001 + number);
    for (int i = 0; i < 4; ++i) random.bits();
    std::uint64_t rest = number;
    const auto next = [&](std::size_t count) {
        const std::size_t digit = rest % count;
        rest /= count;
        return digit;
    };
    const std::size_t relation = next(relations().size()), form = next(forms().size()), place = next(places().size()),
                      other = next(forms().size());
    Pair made{of_form(form, random), of_form(other, random),
              forms()[form] + " to " + forms()[other] + ", " + relations()[relation] + ", " + places()[place]};
    relate(relation, made.a, made.b, random);
    put(place, made.a, made.b, random);
    return made;
}

inline exact::Rational squared_distance(const Pair& pair) {
    const exact::RVec3 d = exact::vector(pair.b.a), e = exact::vector(pair.b.b), f = exact::vector(pair.b.c);
    exact::Rational most = 0;
    for (const Vec3& corner : {pair.a.a, pair.a.b, pair.a.c})
        most = std::max(most, exact::squared_distance_to_triangle(exact::vector(corner), d, e, f));
    return most;
}

// Returns whether lower <= h <= upper is possible for an h with least <= h^2 <= most.
inline bool contains(double lower, double upper, const exact::Rational& least, const exact::Rational& most) {
    if (!(lower >= 0 && std::isfinite(lower) && upper >= lower)) return false;
    const exact::Rational low = lower;
    if (low * low > most) return false;
    if (std::isinf(upper)) return true;
    const exact::Rational high = upper;
    return high * high >= least;
}

}  // namespace hausbench::degenerate
