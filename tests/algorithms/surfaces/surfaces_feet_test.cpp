// The lemmas behind feet.h and surface_mesh.h, against exact rational arithmetic and known distances.
#include "algorithms/kernel/taylor_model.h"
#include "algorithms/surfaces/enclosure/beside.h"
#include "algorithms/surfaces/enclosure/feet.h"
#include "algorithms/surfaces/enclosure/proven_feet.h"
#include "algorithms/surfaces/surface_mesh.h"
#include "tests/support/random.h"

#include <CGAL/Exact_rational.h>

#include <cmath>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using namespace surface_enclosure;

using Rational = CGAL::Exact_rational;
constexpr int order = TaylorModel::order;

Rational value(const TaylorModel& m, const Rational& u, const Rational& v) {  // value of the polynomial
    Rational sum = 0, of_u[order + 1], of_v[order + 1];
    of_u[0] = of_v[0] = 1;
    for (int i = 1; i <= order; ++i) of_u[i] = of_u[i - 1] * u, of_v[i] = of_v[i - 1] * v;
    for (int d = 0; d <= order; ++d) {
        for (int i = 0; i <= d; ++i)
            sum += Rational(m.c[TaylorModel::start(d) + std::size_t(i)]) * of_u[d - i] * of_v[i];
    }
    return sum;
}

bool within(const Rational& a, const Rational& b, double most) {
    const Rational d = a - b;
    return d <= Rational(most) && -d <= Rational(most);
}

TaylorModel random_model(Random& random, int degree, double size) {
    TaylorModel m;
    for (std::size_t i = 0; i < TaylorModel::start(degree + 1); ++i) m.c[i] = random.real(-size, size);
    return m;
}

constexpr double at[][2] = {{1, 1}, {-1, 1}, {1, -1}, {-1, -1}, {0.5, -0.25}, {0, 1}, {0.75, 0.75}};

TEST(TaylorModel, ProductsEncloseWithTheirErrors) {
    Random random(5);
    // Each of these scales needs its own error term: degrees beyond the order, rounding, underflow.
    for (const auto& [degree, size] : {std::pair{8, 1.0}, {4, 1.0}, {4, 0x1p-530}, {0, 1.0}}) {
        for (int i = 0; i < 50; ++i) {
            const TaylorModel a = random_model(random, degree, size), b = random_model(random, degree, size);
            const UpwardRounding upward;
            TaylorModel c = a * b, d = c;
            d.error = 0;  // the polynomial alone; its sum with a is inexact
            const TaylorModel s = a + d;
            for (const auto& [u, v] : at) {
                const Rational x = value(a, u, v), y = value(b, u, v);
                ASSERT_TRUE(within(x * y, value(c, u, v), c.error)) << degree << " " << size;
                ASSERT_TRUE(within(x + value(d, u, v), value(s, u, v), s.error)) << degree << " " << size;
            }
        }
    }
}

// Each factor stands for any function within its error, and the result's error must cover them all.
TEST(TaylorModel, ErrorsOfFactorsArePassedOn) {
    const auto model = [](double middle, double error) {
        TaylorModel m;
        m.c[0] = middle;
        m.error = error;
        return m;
    };
    for (const auto& [e, f] : {std::pair{0.5, 0.0}, {0.0, 0.5}, {0.5, 0.25}}) {
        for (const auto& [x, y] : {std::pair{3.0, 2.0}, {3.0, 0.0}, {0.0, 2.0}, {0.0, 0.0}}) {
            const UpwardRounding upward;
            const TaylorModel a = model(x, e), b = model(y, f), product = a * b, sum = a + b,
                              scaled = a * Interval(1, 2);
            for (const int s : {-1, 1}) {
                for (const int t : {-1, 1}) {
                    EXPECT_LE(std::abs((x + s * e) * (y + t * f) - product.c[0]), product.error);
                    EXPECT_LE(std::abs((x + s * e) + (y + t * f) - sum.c[0]), sum.error);
                }
                for (const double factor : {1.0, 2.0})
                    EXPECT_LE(std::abs(factor * (x + s * e) - scaled.c[0]), scaled.error);
            }
        }
    }
}

TEST(TaylorModel, ScalingEncloses) {
    Random random(6);
    for (int i = 0; i < 100; ++i) {
        const TaylorModel a = random_model(random, 8, 1);
        const double low = random.real(-1, 1), high = i % 2 ? low : low + 1e-3;
        const UpwardRounding upward;
        const TaylorModel b = a * Interval(low, high);
        for (const auto& [u, v] : at) {
            for (const double factor : {low, high})
                ASSERT_TRUE(within(Rational(factor) * value(a, u, v), value(b, u, v), b.error));
        }
    }
}

TEST(TaylorModel, MaximaAreBoundedSharply) {
    Random random(7);
    for (int i = 0; i < 400; ++i) {
        TaylorModel m = random_model(random, i % 2 ? 2 : 8, 1);
        if (i % 3) m.c[3] -= 1, m.c[5] -= 1;
        const UpwardRounding upward;
        const Rational most = Rational(m.at_most());
        const Interval range = m.range();
        for (int j = 0; j < 60; ++j) {
            const double u = random.below(33) / 16.0 - 1, v = random.below(33) / 16.0 - 1;
            const Rational x = value(m, u, v);
            ASSERT_LE(x, most);
            ASSERT_TRUE(Rational(range.inf()) <= x && x <= Rational(range.sup()));
        }
    }
    TaylorModel ridge;  // 5 - (u + 2 v)^2, and a maximum in the middle: 5 + u/2 - u^2 - v^2
    ridge.c[0] = 5, ridge.c[3] = -1, ridge.c[4] = -4, ridge.c[5] = -4;
    TaylorModel top;
    top.c[0] = 5, top.c[1] = 0.5, top.c[3] = top.c[5] = -1;
    const UpwardRounding upward;
    EXPECT_NEAR(ridge.at_most(), 5, 1e-14);
    EXPECT_NEAR(top.at_most(), 5.0625, 1e-14);
    top.error = 0.125;
    EXPECT_GE(top.at_most(), 5.1875);
}

AlgebraicSurface surface(const std::string& polynomial, double size) {
    AlgebraicSurface s{polynomial, Points(2, 3)};
    s.box.row(0).setConstant(-size);
    s.box.row(1).setConstant(size);
    return s;
}

// Returns the bound of along_feet() for the part of `a` in the box around `middle`, whose closest point of `b` is about
// `foot`.
double bound(const AlgebraicSurface& a, const AlgebraicSurface& b, const Vec3& middle, double half, const Vec3& foot) {
    const UpwardRounding upward;
    SurfaceTree source(a), target(b);
    Counters counters;
    SurfaceTree::Node piece;
    piece.box = {middle - Vec3::Constant(half), middle + Vec3::Constant(half)};
    piece.form = source.form(piece.box, counters);
    return along_feet(piece, source, target, middle, foot, 1e300, counters);
}

TEST(AlongFeet, IsSharpWhereTheDistanceIsConstant) {
    const AlgebraicSurface ball = surface("x^2 + y^2 + z^2 - 1", 2), large = surface("x^2 + y^2 + z^2 - 9/4", 2);
    double before = 1;
    for (const double half : {0.2, 0.1, 0.05}) {
        const double most = bound(ball, large, {0, 0, 1}, half, {0, 0, 1.5});
        EXPECT_GE(most, 0.5);
        EXPECT_LT(most - 0.5, before / 100) << half;  // shrinks by 2^9 each time
        before = std::max(most - 0.5, 1e-13);
    }
    const AlgebraicSurface torus = surface("(x^2 + y^2 + z^2 + 3/4)^2 - 4*(x^2 + y^2)", 2),
                           thin = surface("(x^2 + y^2 + z^2 + 15/16)^2 - 4*(x^2 + y^2)", 2);
    const double most = bound(torus, thin, {1.5, 0, 0}, 0.03, {1.25, 0, 0});
    EXPECT_GE(most, 0.25);
    EXPECT_LT(most, 0.25 + 1e-8);
    // The same surface, its polynomial multiplied by 2.
    EXPECT_LT(bound(ball, surface("2*x^2 + 2*y^2 + 2*z^2 - 2", 2), {0, 0, 1}, 0.05, {0, 0, 1}), 1e-9);
}

// A polynomial of degree 8 misses x^9 completely; without its error, the bound would be 8.
TEST(AlongFeet, CountsHowFarAIsFromItsPolynomial) {
    const double most = bound(surface("z - x^9", 20), surface("z - 8", 20), {0, 0, 0}, 1, {0, 0, 8});
    EXPECT_GE(most, 9);
    EXPECT_LT(most, 10);
}

// z^2 = 1 has two sheets. The box is around z = 1, but the start at z = -1 leads to the other sheet, which must be
// rejected.
TEST(AlongFeet, RefusesAnotherSheetOfA) {
    const UpwardRounding upward;
    SurfaceTree source(surface("z^2 - 1", 20)), target(surface("z + 4", 20));
    Counters counters;
    SurfaceTree::Node piece;
    piece.box = {{-0.5, -0.5, 0.4}, {0.5, 0.5, 1.6}};
    piece.form = source.form(piece.box, counters);
    EXPECT_GE(along_feet(piece, source, target, {0, 0, -1}, {0, 0, -4}, 1e300, counters), 5);
}

// The closest point of z = 1 + x / 2 to (-1, y, 0) lies beyond the side x = -1 of B's box, so the distance is 0.5, not
// 0.447.
TEST(AlongFeet, StaysInTheBoxOfB) {
    AlgebraicSurface b = surface("z - 1 - x/2", 2);
    b.box(0, 0) = -1;
    EXPECT_GE(bound(surface("z", 2), b, {-0.95, 0, 0}, 0.05, {-1, 0, 0.5}), 0.5);
    EXPECT_LT(bound(surface("z", 2), b, {0.95, 0, 0}, 0.05, {0.5, 0, 1.25}), 1.4);
}

// A is the plane z = 0, and B is the same plane up to x = 0.5 (then y = 0.25), where it ends before the tested piece of
// A.
TEST(AlongFeet, KnowsWhereBEndsBesideThePiece) {
    AlgebraicSurface b = surface("z", 2);
    b.box(0, 0) = -0.5, b.box(1, 0) = 0.5;
    EXPECT_GE(bound(surface("z", 2), b, {0.9, 0, 0}, 0.05, {0.5, 0, 0}), 0.45);
    b = surface("z", 2);
    b.box(1, 1) = 0.25;
    EXPECT_GE(bound(surface("z", 2), b, {0, 0.5, 0}, 0.05, {0, 0.25, 0}), 0.3);
    EXPECT_LT(bound(surface("z", 2), b, {0, 0.1, 0}, 0.05, {0, 0.1, 0}), 1e-9);
}

// Returns the bound of beside() for the part of `a` in a box, with the move from p to `foot`.
double bound_beside(const AlgebraicSurface& a, const AlgebraicSurface& b, const Box& box, const Vec3& p,
                    const Vec3& foot) {
    const UpwardRounding upward;
    SurfaceTree source(a), target(b);
    Counters counters;
    SurfaceTree::Node piece;
    piece.box = box;
    piece.form = source.form(box, counters);
    return beside(piece, target, p, foot, 1e300, counters);
}

// B is the plane z = x. Moved up by 0.15, the whole piece is above B, and yet (-1, 0, 0) is 0.7 from B.
TEST(Beside, WantsOneSignOnThePiece) {
    const Box box{{-1, -0.1, -0.1}, {0.1, 0.1, 0.1}};
    EXPECT_GE(bound_beside(surface("z", 2), surface("z - x", 2), box, {0, 0, 0}, {0, 0, 0.15}), 0.7);
}

// The distance to B, z = 1 + x^2 + y^2, is 1 from the middle of the piece and more from its corners.
TEST(Beside, GoesFartherThanTheFoot) {
    const Box box{{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}};
    const double most = bound_beside(surface("z", 2), surface("x^2 + y^2 + 1 - z", 2), box, {0, 0, 0}, {0, 0, 1});
    EXPECT_GE(most, 1.019);
    EXPECT_LT(most, 1.05);
}

// Let p = a + s (b - a) + t (c - a) + h n, with n normal to the triangle and s, t inside. The exact squared distance is
// |h n|^2.
TEST(TriangleDistance, IsNoLessThanTheExactOne) {
    Random random(8);
    int sharp = 0;
    for (int i = 0; i < 2000; ++i) {
        const double scale = i % 2 ? 1e8 : 1;
        const Vec3 offset(scale, -scale, scale);
        const Vec3 a = offset + random.vector(), b = offset + random.vector(), c = offset + random.vector();
        const Vec3 p = (a + random.unit() * 0.5 * (b - a)) + random.unit() * 0.5 * (c - a);
        Rational n[3], ab[3], ac[3], height = 0, length = 0;
        for (int k = 0; k < 3; ++k) ab[k] = Rational(b[k]) - Rational(a[k]), ac[k] = Rational(c[k]) - Rational(a[k]);
        for (int k = 0; k < 3; ++k) {
            n[k] = ab[(k + 1) % 3] * ac[(k + 2) % 3] - ab[(k + 2) % 3] * ac[(k + 1) % 3];
            height += n[k] * (Rational(p[k]) - Rational(a[k]));
            length += n[k] * n[k];
        }
        const double magnitude = std::max(
            {a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff(), p.cwiseAbs().maxCoeff()});
        const UpwardRounding upward;
        const double most = triangle_distance_at_most(p, a, b, c, magnitude);
        ASSERT_GE(Rational(most) * Rational(most) * length, height * height) << i;  // the plane is at least as near
        sharp += most < 1e-14 * magnitude;
    }
    EXPECT_GT(sharp, 1900);
}

// A closest point with error 0.25 may stand for a point of B 0.25 farther away, which the bound must include.
TEST(ProvenFeet, AFootIsAsFarAsItsErrorAllows) {
    AlgebraicSurface a{"z", Points(2, 3)}, b{"z - 5/4", Points(2, 3)};
    a.box << -1, -1, -1, 1, 1, 1;
    b.box << -1, -1, 0, 1, 1, 2;
    const UpwardRounding upward;
    const Deadline never(std::numeric_limits<double>::infinity());
    Counters counters;
    ProvenFeet feet(SurfaceTree(b), never, counters);
    const std::int32_t foot = feet.add({Vec3(0, 0, 1), 0.25});
    SurfaceTree tree(a);
    EXPECT_GE(feet.at_most(tree[0], foot), Vec3(1, 1, 1.25).norm() - 0.01);  // a corner of A
    // A small piece around the origin, which is 5/4 away from B.
    AlgebraicSurface patch = a;
    patch.box *= 0x1p-20;
    EXPECT_GE(feet.at_most(SurfaceTree(patch)[0], foot), 1.25);
    EXPECT_LE(feet.at_most(SurfaceTree(patch)[0], foot), 1.25 + 1e-5);
}

}  // namespace
}  // namespace hausbench
