// Relations that answers must obey whatever the true distance is, between a scene and the same scene scaled, reordered,
// moved, turned, cut finer or enlarged; and the triangle inequality.
//
// Coordinates must be multiples of 2^-16 below 1, so that sums, midpoints and squares are exact and both sides of a
// relation are about the same numbers.
#pragma once

#include "algorithms/solver.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/truth.h"

#include <fmt/format.h>

#include <functional>
#include <string>
#include <vector>

namespace hausbench::metamorphic {

using Ask = std::function<Bounds(const Scene&, double tolerance, Quantity)>;

// Three shapes, for h(A,B), h(B,C) and h(A,C).
struct Instance {
    std::string name;
    Shape a, b, c;
};

// Tolerances for shapes of extent 1 to 2. The fine one reveals a bound that is off by one rounding; thin triangles make
// it slow, so solvers stop at a budget of `most`.
inline constexpr double coarse = 0x1p-11, fine = 0x1p-36;
inline constexpr std::uint64_t most = 20'000;

class Relation {
public:
    // `tight`: the solver reaches the tolerance. `exact`: it computes the distance of point sets in closed form.
    Relation(const Ask& ask, const Instance& on, double tolerance, bool tight, bool exact)
        : ask_(ask), on_(on), tolerance_(tolerance), tight_(tight), exact_(exact) {}
    virtual ~Relation() = default;
    virtual void check() = 0;

    std::vector<std::string> violations;

protected:
    Bounds h(const Shape& a, const Shape& b, double scale = 1) const {
        return ask_({a, b}, scale * tolerance_, Quantity::directed);
    }
    Bounds symmetric(const Shape& a, const Shape& b) const { return ask_({a, b}, tolerance_, Quantity::symmetric); }

    void expect(bool holds, const Bounds& x, const Bounds& y, const std::string& what) {
        if (!holds)
            violations.push_back(fmt::format("{}, {}: [{:.17g}, {:.17g}] against [{:.17g}, {:.17g}]", on_.name, what,
                                             x.lower, x.upper, y.lower, y.upper));
    }
    // Both intervals hold the same distance, so they overlap. A tight solver also reaches the tolerance in both.
    void expect_same(const Bounds& x, const Bounds& y, const std::string& what) {
        expect(x.lower <= y.upper && y.lower <= x.upper, x, y, what);
        expect(!tight_ || (x.gap() <= tolerance_ && y.gap() <= tolerance_), x, y, what + ", as close as asked");
    }
    void expect_same_bits(const Bounds& x, const Bounds& y, const std::string& what) {
        expect(x.lower == y.lower && x.upper == y.upper, x, y, what);
    }
    bool points() const { return kind_of(on_.a) == ShapeKind::points; }

    const Ask& ask_;
    const Instance& on_;
    double tolerance_;
    bool tight_, exact_;
};

template <class F> Shape moved(const Shape& shape, F&& f) {
    Shape copy = shape;
    Points& points = points_of(copy);
    for (Index i = 0; i < points.rows(); ++i) points.row(i) = Vec3(f(Vec3(points.row(i)))).transpose();
    return copy;
}

inline std::vector<Index> shuffled(Index count, Random& random) {
    std::vector<Index> order(static_cast<std::size_t>(count));
    for (Index i = 0; i < count; ++i) order[std::size_t(i)] = i;
    for (Index i = count - 1; i > 0; --i) std::swap(order[std::size_t(i)], order[std::size_t(random.below(i + 1))]);
    return order;
}

// Reorders vertices, faces and the corners of each face, and flips about half of the faces.
inline Shape reordered(const Shape& shape, std::uint64_t seed) {
    Random random(seed);
    Shape copy = shape;
    const Points& old = points_of(shape);
    const std::vector<Index> place = shuffled(old.rows(), random);
    for (Index i = 0; i < old.rows(); ++i) points_of(copy).row(place[std::size_t(i)]) = old.row(i);
    if (kind_of(shape) == ShapeKind::points) return copy;
    const Triangles& faces = mesh_of(shape).triangles;
    const std::vector<Index> order = shuffled(faces.rows(), random);
    for (Index i = 0; i < faces.rows(); ++i) {
        const Index first = random.below(3), step = 1 + random.below(2);
        for (Index k = 0; k < 3; ++k)
            std::get<TriangleMesh>(copy).triangles(order[std::size_t(i)], k) =
                Triangles::Scalar(place[std::size_t(faces(i, (first + step * k) % 3))]);
    }
    return copy;
}

// Splits each triangle into four at the midpoints of its sides.
inline Shape subdivided(const Shape& shape) {
    const TriangleMesh& mesh = mesh_of(shape);
    Points corners(12 * mesh.triangles.rows(), 3);
    Index row = 0;
    for (Index i = 0; i < mesh.triangles.rows(); ++i) {
        const auto corner = [&](int k) { return Vec3(mesh.vertices.row(mesh.triangles(i, k))); };
        const Vec3 a = corner(0), b = corner(1), c = corner(2), ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
        for (const Vec3& p : {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca}) corners.row(row++) = p.transpose();
    }
    return soup(corners);
}

inline Shape joined(const Shape& first, const Shape& second) {
    Shape all = first;
    const Points &x = points_of(first), &y = points_of(second);
    points_of(all).conservativeResize(x.rows() + y.rows(), 3);
    points_of(all).bottomRows(y.rows()) = y;
    if (kind_of(first) == ShapeKind::points) return all;
    const Triangles &s = mesh_of(first).triangles, &t = mesh_of(second).triangles;
    Triangles& faces = std::get<TriangleMesh>(all).triangles;
    faces.conservativeResize(s.rows() + t.rows(), 3);
    faces.bottomRows(t.rows()) = (t.array() + Triangles::Scalar(x.rows())).matrix();
    return all;
}

// Gives each triangle its own corners.
inline Shape unshared(const Shape& shape) {
    const TriangleMesh& mesh = mesh_of(shape);
    Points corners(3 * mesh.triangles.rows(), 3);
    for (Index i = 0; i < corners.rows(); ++i) corners.row(i) = mesh.vertices.row(mesh.triangles(i / 3, i % 3));
    return soup(corners);
}

// Adds vertices that no face uses: one far away, one in the middle.
inline Shape with_lone_vertices(const Shape& shape) {
    TriangleMesh mesh = mesh_of(shape);
    mesh.vertices.conservativeResize(mesh.vertices.rows() + 2, 3);
    mesh.vertices.bottomRows(2) << 32, -32, 16, 0, 0, 0;
    return mesh;
}

struct ScalesWithPowersOfTwo : Relation {
    using Relation::Relation;
    void check() override {
        const Bounds original = h(on_.a, on_.b);
        for (const int k : {-300, -3, 1, 40, 300}) {
            const double by = std::ldexp(1.0, k);
            const auto scale = [&](const Vec3& p) { return Vec3(by * p); };
            const Bounds many = h(moved(on_.a, scale), moved(on_.b, scale), by);
            expect_same_bits({by * original.lower, by * original.upper}, many, fmt::format("scaled by 2^{}", k));
        }
    }
};

struct ForgetsTheOrder : Relation {
    using Relation::Relation;
    void check() override {
        const Bounds original = h(on_.a, on_.b);
        for (const std::uint64_t seed : {1, 2}) {
            const Bounds other = h(reordered(on_.a, seed), reordered(on_.b, seed + 10));
            expect_same(original, other, "in another order");
            if (exact_) expect_same_bits(original, other, "in another order, bit for bit");
        }
    }
};

struct MovesAlong : Relation {
    using Relation::Relation;
    void check() override {
        const Bounds original = h(on_.a, on_.b);
        for (const Vec3& by : {Vec3(0.25, -0.5, 1), Vec3(-4096, 1 + 0x1p-16, 65536)}) {
            const auto move = [&](const Vec3& p) { return Vec3(p + by); };
            expect_same(original, h(moved(on_.a, move), moved(on_.b, move)), fmt::format("moved by {} in z", by[2]));
        }
    }
};

struct TurnsAlong : Relation {
    using Relation::Relation;
    void check() override {
        const Bounds original = h(on_.a, on_.b);
        const auto expect_turned = [&](const char* axis, auto&& turn) {
            expect_same(original, h(moved(on_.a, turn), moved(on_.b, turn)),
                        std::string("a quarter turn about ") + axis);
        };
        expect_turned("x", [](const Vec3& p) { return Vec3(p[0], -p[2], p[1]); });
        expect_turned("y", [](const Vec3& p) { return Vec3(p[2], p[1], -p[0]); });
        expect_turned("z", [](const Vec3& p) { return Vec3(-p[1], p[0], p[2]); });
    }
};

struct GrowsWithA : Relation {
    using Relation::Relation;
    void check() override {
        const Bounds part = h(on_.a, on_.b), whole = h(joined(on_.a, on_.c), on_.b),
                     nearer = h(on_.a, joined(on_.b, on_.c));
        expect(whole.upper >= part.lower, whole, part, "more of A");
        expect(nearer.lower <= part.upper, nearer, part, "more of B");
        const Bounds rest = h(on_.c, on_.b);  // h of a union is the larger of the two
        expect_same(whole, {std::max(part.lower, rest.lower), std::max(part.upper, rest.upper)}, "A in two parts");
    }
};

struct ForgetsTheCuts : Relation {
    using Relation::Relation;
    void check() override {
        if (points()) return;
        const Bounds original = h(on_.a, on_.b), of_a = h(subdivided(on_.a), on_.b), of_b = h(on_.a, subdivided(on_.b));
        expect_same(original, of_a, "A cut finer");
        expect_same(original, of_b, "B cut finer");
        const Truth truth = truth_of({on_.a, on_.b}, 1e-5L);
        for (const Bounds& bounds : {original, of_a, of_b})
            expect(encloses(bounds, truth, 0), bounds, {double(truth.low), double(truth.high)}, "the truth");
    }
};

struct ObeysTheTriangleInequality : Relation {
    using Relation::Relation;
    void check() override {
        const auto inequality = [&](const Shape& a, const Shape& b, const Shape& c, const std::string& what) {
            const Bounds ac = h(a, c), ab = h(a, b), bc = h(b, c);
            const double detour = std::nextafter(ab.upper + bc.upper, std::numeric_limits<double>::infinity());
            expect(ac.lower <= detour, ac, {0, detour}, what);
        };
        inequality(on_.a, on_.b, on_.c, "A to C by B");
        inequality(on_.a, on_.c, on_.b, "A to B by C");
        // A is moved twice in the same direction, which makes the inequality nearly an equality.
        const auto once = moved(on_.a, [](const Vec3& p) { return Vec3(p + Vec3(4, 0, 0)); });
        const auto twice = moved(on_.a, [](const Vec3& p) { return Vec3(p + Vec3(8, 0, 0)); });
        inequality(on_.a, once, twice, "along a line");
    }
};

struct IsSymmetric : Relation {
    using Relation::Relation;
    void check() override {
        const Bounds forth = symmetric(on_.a, on_.b), back = symmetric(on_.b, on_.a);
        expect_same(forth, back, "H of A and B, and of B and A");
        const Bounds one = h(on_.a, on_.b), other = h(on_.b, on_.a);
        expect_same(forth, {std::max(one.lower, other.lower), std::max(one.upper, other.upper)}, "H and both h");
    }
};

struct IsZeroOfItself : Relation {
    using Relation::Relation;
    void check() override {
        const Bounds itself = h(on_.a, on_.a), again = h(on_.b, reordered(on_.b, 7));
        expect(itself.lower == 0, itself, {0, 0}, "A and itself");
        expect(again.lower == 0, again, {0, 0}, "B and itself in another order");
        expect_same(itself, {0, 0}, "A and itself");
    }
};

struct ForgetsCopies : Relation {
    using Relation::Relation;
    void check() override {
        const Bounds original = h(on_.a, on_.b);
        const Bounds twice = h(joined(on_.a, on_.a), on_.b), onto = h(on_.a, joined(on_.b, on_.b));
        expect_same(original, twice, "all of A twice");
        expect_same(original, onto, "all of B twice");
        if (exact_) expect_same_bits(original, twice, "all of A twice, bit for bit");
        if (points()) return;
        expect_same(original, h(with_lone_vertices(on_.a), with_lone_vertices(on_.b)), "vertices of no face");
        expect_same(original, h(unshared(on_.a), unshared(on_.b)), "each triangle with corners of its own");
    }
};

}  // namespace hausbench::metamorphic
