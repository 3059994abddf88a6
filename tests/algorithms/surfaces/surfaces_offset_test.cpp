// Algebraic surfaces far from the origin, in boxes only a few doubles wide, and with coefficients whose squares overflow.
#include "algorithms/kernel/polynomial.h"
#include "algorithms/kernel/taylor_model.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "algorithms/surfaces/surface_mesh.h"
#include "algorithms/surfaces/surface_tree.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

AlgebraicSurface surface(const std::string& polynomial, const Vec3& low, const Vec3& high) {
    AlgebraicSurface s{polynomial, Points(2, 3)};
    s.box.row(0) = low;
    s.box.row(1) = high;
    return s;
}

AlgebraicSurface around(const std::string& polynomial, const Vec3& centre) {
    return surface(polynomial, centre - Vec3::Constant(2), centre + Vec3::Constant(2));
}

Result solve(const std::string& solver, const AlgebraicSurface& a, const AlgebraicSurface& b, double tolerance,
             std::uint64_t budget = 20000) {
    const SolverEntry& entry = find_solver(solver);
    Query query;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    query.budget = budget;
    Trace trace;
    return Session(entry, Options(entry.info.name, entry.info.parameters, {}), {a, b}, {}).solve(query, trace);
}

void expect_converged(const AlgebraicSurface& a, const AlgebraicSurface& b, double h, double tolerance) {
    const Result result = solve("surface_enclosure", a, b, tolerance);
    const std::string where = a.polynomial + " to " + b.polynomial;
    EXPECT_LE(result.bounds.lower, h * (1 + 1e-14)) << where;
    EXPECT_GE(result.bounds.upper, h * (1 - 1e-14)) << where;
    EXPECT_EQ(to_string(result.status), "converged") << where << ", gap " << result.bounds.gap() << ", " << result.note;
}

TEST(SurfaceOffset, ASphereFarFromTheOrigin) {
    const AlgebraicSurface here = around("x^2 + y^2 + z^2 - 1", {0, 0, 0}),
                           there = around("(x - 1000000)^2 + y^2 + z^2 - 1", {1e6, 0, 0}),
                           multiplied_out = around("x^2 - 2000000*x + y^2 + z^2 + 999999999999", {1e6, 0, 0}),
                           larger = around("(x - 1000000)^2 + y^2 + z^2 - 9/4", {1e6, 0, 0});
    for (const AlgebraicSurface& far : {there, multiplied_out}) {
        expect_converged(here, far, 1e6, 1e-3);
        expect_converged(far, here, 1e6, 1e-3);
        expect_converged(far, larger, 0.5, 1e-3);
        expect_converged(larger, far, 0.5, 1e-3);
    }
    expect_converged(there, multiplied_out, 0, 1e-3);
}

// Multiplied out, the torus's polynomial has coefficients that no double represents.
TEST(SurfaceOffset, AQuarticFarFromTheOrigin) {
    const std::string x = "(x - 1000003)", y = "(y + 2000005)", z = "(z - 300007)";
    const std::string square = x + "^2 + " + y + "^2 + " + z + "^2";
    const Vec3 centre(1000003, -2000005, 300007);
    const AlgebraicSurface torus = around("(" + square + " + 3/4)^2 - 4*(" + x + "^2 + " + y + "^2)", centre),
                           ball = around(square + " - 1", centre);
    expect_converged(torus, ball, 0.5, 1e-2);
    expect_converged(ball, torus, std::sqrt(2.0) - 0.5, 1e-3);
}

TEST(SurfaceOffset, CoefficientsWhoseSquaresOverflow) {
    const std::string ball = "(x^2 + y^2 + z^2 - 1)", larger = "(x^2 + y^2 + z^2 - 9/4)";
    for (const char* factor : {"1e154*", "1e200*", "1e240*", "1e-160*", "1e-200*", "1e-290*"}) {
        expect_converged(around(factor + ball, {0, 0, 0}), around(factor + larger, {0, 0, 0}), 0.5, 1e-3);
    }
}

// Expanding about another origin keeps the surface, so both polynomials must bound the same values.
TEST(SurfaceOffset, ThePolynomialIsTheSameAboutAnotherOrigin) {
    const UpwardRounding upward;
    const char* const texts[] = {"x^3 - 3*x*y + z/7", "(x - 4096)^2*(y + z)^2 - x", "x^5*y^2 - 4*z^5 + 1/3"};
    for (const char* text : texts) {
        const AlgebraicSurface far = surface(text, {4096, -9, 1e5}, {4097, 9, 1e5 + 2});
        const Polynomial about = Polynomial::of(far), plain(text);
        EXPECT_EQ(about.origin(), Vec3(4096.5, 0, 1e5 + 1)) << text;
        FormEvaluator of_about(about);
        for (const Vec3& at : {Vec3(4096.25, 3, 1e5 + 0.5), Vec3(4097, -9, 1e5), Vec3(4096.5, 0.1, 1e5 + 1)}) {
            const std::array<Interval, 3> point{Interval(at[0]), Interval(at[1]), Interval(at[2])};
            const Interval expanded = about.natural(point), original = plain.natural(point);
            EXPECT_TRUE(expanded.inf() <= original.sup() && original.inf() <= expanded.sup()) << text;
            const std::array<TaylorModel, 3> models{TaylorModel::variable(at[0], 0, 0),
                                                    TaylorModel::variable(at[1], 0, 0),
                                                    TaylorModel::variable(at[2], 0, 0)};
            const Interval modelled = ModelPowers(models, about).value(about).range();
            EXPECT_TRUE(modelled.inf() <= expanded.sup() && expanded.inf() <= modelled.sup()) << text;
            const Box around_it{at - Vec3::Constant(0x1p-20), at + Vec3::Constant(0x1p-20)};
            for (const Form form : {Form::natural, Form::centred, Form::affine, Form::modified_affine}) {
                const Interval range = of_about.range(form, around_it);
                EXPECT_TRUE(range.inf() <= expanded.sup() && expanded.inf() <= range.sup()) << text;
                EXPECT_LT(range.sup() - range.inf(), 0x1p-8 * (1 + magnitude(original))) << text;
            }
            Vec3 gradient;
            EXPECT_NEAR(about.value(at, gradient), expanded.inf(), 1e-9 * (1 + magnitude(expanded))) << text;
        }
    }
    EXPECT_EQ(Polynomial::of(surface("x", {-1, 0, 1}, {1, 1, 2})).origin(), Vec3::Zero());  // near the origin
}

// At most 7 doubles lie between the sides of such a box; boxes that cannot be divided must be kept.
TEST(SurfaceOffset, BoxesOfAFewDoubles) {
    const Vec3 low(-1, -1, 1e15), high(1, 1, 1e15 + 1);
    const AlgebraicSurface a = surface("z - 1000000000000000 - 1/2", low, high),
                           b = surface("z - 1000000000000000 - 1/4", low, high),
                           slanted = surface("z - 1000000000000000 - 1/2 - x/4", low, high),
                           top = surface("z - 1000000000000001 - x/1024", low, high);
    struct Pair {
        AlgebraicSurface a, b;
        double h;
    };
    const Pair pairs[] = {{a, b, 0.25}, {b, a, 0.25},          {slanted, a, 0.25},
                          {a, a, 0},    {slanted, slanted, 0}, {top, a, 0.5}};
    for (const auto& [from, to, h] : pairs) {
        for (const char* solver : {"surface_meshes", "surface_enclosure"}) {
            const Result result = solve(solver, from, to, 1e-3, 500);
            const std::string where = std::string(solver) + ": " + from.polynomial + " to " + to.polynomial;
            EXPECT_LE(result.bounds.lower, h) << where;
            EXPECT_GE(result.bounds.upper, h) << where;
            EXPECT_LE(result.bounds.upper, 4) << where;
            if (solver == std::string("surface_enclosure")) {
                EXPECT_EQ(to_string(result.status), "precision_floor") << where << ", " << result.note;
                EXPECT_NE(result.note.find("towards the origin"), std::string::npos) << result.note;
            }
        }
    }
}

TEST(SurfaceOffset, ABoxThatHoldsNoOtherDoubleIsNotDivided) {
    const double next = std::nextafter(1, 2);
    const AlgebraicSurface tiny = surface("x + y + z - 3", {1, 1, 1}, {next, next, next});
    {
        const UpwardRounding upward;
        SurfaceTree tree(tiny);
        ASSERT_EQ(tree.size(), 1u);
        EXPECT_FALSE(tree.may_split(0));
    }
    const Result result = solve("surface_enclosure", tiny, tiny, 1e-30);  // the surface is not taken for empty
    EXPECT_GE(result.bounds.upper, 0);
    EXPECT_NE(result.status, Status::budget);
    EXPECT_NE(result.status, Status::time_limit);
}

// Each child must lie inside its parent and be smaller, and the tree must end.
TEST(SurfaceOffset, EverySplitMakesSmallerBoxes) {
    const UpwardRounding upward;
    SurfaceTree tree(
        surface("x + 3*y + z - 1000000000000000 - 1/2", {0, -0x1p-1074, 1e15}, {0x1p-1073, 0x1p-1073, 1e15 + 1}));
    Counters counters;
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(tree.size()); ++i) {
        ASSERT_LT(tree.size(), 1000u);
        if (!tree.may_split(i)) continue;
        tree.split(i, counters);
        const Box parent = tree[i].box;
        for (std::int32_t c = tree[i].first; c < tree[i].first + tree[i].count; ++c) {
            const Box child = tree[c].box;
            EXPECT_TRUE((child.low.array() >= parent.low.array()).all() &&
                        (child.high.array() <= parent.high.array()).all());
            EXPECT_TRUE((child.low.array() < child.high.array()).all());
            EXPECT_TRUE(child.low != parent.low || child.high != parent.high);
        }
    }
}

}  // namespace
}  // namespace hausbench
