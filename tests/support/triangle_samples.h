// Triangles and points of every kind that is hard for a distance kernel.
#pragma once

#include "algorithms/kernel/point_triangle.h"
#include "tests/support/random.h"

#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace hausbench {

struct Sample {
    Triangle triangle;
    Vec3 point;
};

struct Kind {
    std::string name;
    std::function<Sample(Random&)> make;
};

inline double magnitude_of(const Sample& s) {
    double m = 0;
    for (const Vec3& v : {s.triangle.a, s.triangle.b, s.triangle.c, s.point}) m = std::max(m, v.cwiseAbs().maxCoeff());
    return m;
}

inline Vec3 inside(const Triangle& t, Random& random) {
    double s = random.unit(), r = random.unit();
    if (s + r > 1) s = 1 - s, r = 1 - r;
    return t.a + s * (t.b - t.a) + r * (t.c - t.a);
}

inline Triangle any(Random& random) {
    const Vec3 a = random.vector(), b = random.vector(), c = random.vector();
    return {a, b, c};
}

// Returns a triangle whose third vertex is about `height` off the line through the other two, at the fraction `place`
// along it.
inline Triangle thin(Random& random, double height, double place) {
    const Vec3 a = random.vector(), b = random.vector();
    return {a, b, Vec3(a + place * (b - a) + height * random.vector())};
}

inline std::vector<Kind> kinds() {
    std::vector<Kind> all;
    all.push_back({"random", [](Random& r) {
                       const Triangle t = any(r);
                       return Sample{t, r.vector(2)};
                   }});
    all.push_back({"random, point above the inside", [](Random& r) {
                       const Triangle t = any(r);
                       const Vec3 n = (t.b - t.a).cross(t.c - t.a);
                       return Sample{t, Vec3(inside(t, r) + r.real(-1, 1) * n)};
                   }});
    for (const double height : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-12, 1e-14, 1e-16, 1e-30}) {
        all.push_back({fmt::format("needle {}", height), [=](Random& r) {
                           return Sample{thin(r, height, 0), r.vector(2)};
                       }});
        all.push_back({fmt::format("cap {}", height), [=](Random& r) {
                           return Sample{thin(r, height, r.real(0.1, 0.9)), r.vector(2)};
                       }});
        all.push_back({fmt::format("cap {}, point close", height), [=](Random& r) {
                           const Triangle t = thin(r, height, r.real(0.1, 0.9));
                           return Sample{t, Vec3(inside(t, r) + std::pow(10, r.real(-16, 0)) * r.vector())};
                       }});
        all.push_back({fmt::format("needle {}, point close", height), [=](Random& r) {
                           const Triangle t = thin(r, height, r.below(2));
                           return Sample{t, Vec3(inside(t, r) + std::pow(10, r.real(-16, 0)) * r.vector())};
                       }});
        all.push_back({fmt::format("cap {}, point above", height), [=](Random& r) {
                           const Triangle t = thin(r, height, r.unit());
                           const Vec3 n = (t.b - t.a).cross(t.c - t.a).normalized();
                           return Sample{t, Vec3(inside(t, r) + std::pow(10, r.real(-16, 0)) * n)};
                       }});
    }
    all.push_back({"rounded collinear", [](Random& r) {
                       const Triangle t = thin(r, 0, r.real(-1, 2));
                       return Sample{t, r.vector(2)};
                   }});
    all.push_back({"two equal vertices", [](Random& r) {
                       Triangle t = any(r);
                       (r.below(2) ? t.c : t.b) = t.a;
                       return Sample{t, r.vector(2)};
                   }});
    all.push_back({"three equal vertices", [](Random& r) {
                       const Vec3 a = r.vector();
                       return Sample{{a, a, a}, r.vector(2)};
                   }});
    for (const double distance : {1e-6, 1e-9, 1e-12, 1e-15, 0.0}) {
        all.push_back({fmt::format("distance about {}", distance), [=](Random& r) {
                           const Triangle t = any(r);
                           return Sample{t, Vec3(inside(t, r) + distance * r.vector())};
                       }});
        all.push_back({fmt::format("distance about {} from an edge", distance), [=](Random& r) {
                           const Triangle t = any(r);
                           return Sample{t, Vec3(t.a + r.unit() * (t.b - t.a) + distance * r.vector())};
                       }});
        all.push_back({fmt::format("distance about {} from a vertex", distance), [=](Random& r) {
                           const Triangle t = any(r);
                           return Sample{t, Vec3(t.b + distance * r.vector())};
                       }});
    }
    all.push_back({"offset 1e8", [](Random& r) {
                       const Vec3 offset(1e8, -1e8, 1e8);
                       const Triangle t = any(r);
                       return Sample{{t.a + offset, t.b + offset, t.c + offset}, Vec3(r.vector(2) + offset)};
                   }});
    all.push_back({"tiny triangle 1e-80", [](Random& r) {
                       const Triangle t = any(r);
                       return Sample{{1e-80 * t.a, 1e-80 * t.b, 1e-80 * t.c}, r.vector()};
                   }});
    return all;
}

}  // namespace hausbench
