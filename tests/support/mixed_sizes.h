// Numbered scenes whose meshes mix triangles of every size from 1 to the smallest double.
#pragma once

#include "algorithms/scene.h"
#include "tests/support/exact.h"
#include "tests/support/random.h"
#include "tests/support/triangle_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace hausbench::mixed_sizes {

struct Soups {
    std::vector<Triangle> a, b;
};

// Returns a size of about 2^-k, over the whole range of doubles and often so small that squared lengths underflow.
inline double size(Random& random) {
    const Index kind = random.below(8);
    const Index exponent = kind < 2 ? 0 : kind < 4 ? random.below(1075) : kind < 7 ? 480 + random.below(70) : 1074;
    return std::ldexp(random.real(1, 2), -static_cast<int>(exponent));
}

inline Vec3 vector(Random& random, double length) {
    Vec3 v = length * random.vector();
    for (double& x : v)
        if (random.below(5) == 0) x = 0;
    return v;
}

// Returns a position, mostly near the origin in at least one axis, because rounding swallows details smaller than an
// ulp of their position.
inline Vec3 place(Random& random, const std::vector<Triangle>& others) {
    switch (random.below(5)) {
        case 0:
            return vector(random, 1);
        case 1:
            return vector(random, size(random));
        case 2:
            if (!others.empty()) return others[random.bits() % others.size()].b;
            [[fallthrough]];
        default:
            return Vec3::Zero();
    }
}

inline Triangle triangle(Random& random, const std::vector<Triangle>& others) {
    const Vec3 at = place(random, others);
    const double whole = size(random), part = std::ldexp(whole, -static_cast<int>(random.below(60)));
    const Vec3 a = at + vector(random, whole), b = at + vector(random, whole);
    switch (random.below(6)) {
        case 0:
            return {a, b, b};
        case 1:
            return {a, Vec3(a + vector(random, part)), b};
        case 2:
            return {a, b, Vec3(a + random.unit() * (b - a) + vector(random, part))};
        default:
            return {a, b, at + vector(random, whole)};
    }
}

// Makes up to four triangles for each shape.
inline Soups soups(std::uint64_t seed, std::uint64_t number) {
    Random random(seed * 0x100000001 + number);
    for (int i = 0; i < 4; ++i) random.bits();
    Soups made;
    for (auto* soup : {&made.b, &made.a})
        for (Index count = 1 + random.below(4); count > 0; --count)
            soup->push_back(triangle(random, soup == &made.a && random.below(4) == 0 ? made.b : *soup));
    return made;
}

// Bounds on h(A,B)^2. `low` comes from the farthest corner of A. `high` takes, for each triangle of A, the triangle of
// B that is nearest to all its corners: no point is farther than the farthest corner.
struct Bracket {
    exact::Rational low = 0, high = 0;
};

inline Bracket squared_distance(const Soups& scene) {
    Bracket all;
    for (const Triangle& t : scene.a) {
        exact::Rational nearest[3] = {-1, -1, -1}, by_one = -1;
        for (const Triangle& s : scene.b) {
            exact::Rational most = 0;
            int corner = 0;
            for (const Vec3* p : {&t.a, &t.b, &t.c}) {
                const exact::Rational squared = exact::squared_distance_to_triangle(
                    exact::vector(*p), exact::vector(s.a), exact::vector(s.b), exact::vector(s.c));
                exact::Rational& least = nearest[corner++];
                if (least < 0 || squared < least) least = squared;
                most = std::max(most, squared);
            }
            if (by_one < 0 || most < by_one) by_one = most;
        }
        all.low = std::max({all.low, nearest[0], nearest[1], nearest[2]});
        all.high = std::max(all.high, by_one);
    }
    return all;
}

}  // namespace hausbench::mixed_sizes
