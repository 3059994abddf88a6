// Polynomials parsed from text, and every interval form against exact rational arithmetic.
#include "algorithms/error.h"
#include "algorithms/kernel/interval_form.h"
#include "tests/support/random.h"

#include <CGAL/Exact_rational.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using Rational = CGAL::Exact_rational;

AlgebraicSurface surface(const std::string& polynomial, double low, double high) {
    AlgebraicSurface s{polynomial, Points(2, 3)};
    s.box.row(0).setConstant(low);
    s.box.row(1).setConstant(high);
    return s;
}

std::string message(const std::string& text) {
    try {
        Polynomial ignored(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(Polynomial, ReadsWhatItShould) {
    const auto at = [](const std::string& text) { return Polynomial(text).value({0.5, 2, -3}); };
    EXPECT_EQ(at("x^2/4 + y^2/4 - z^2/4"), 0.0625 + 1 - 2.25);
    EXPECT_EQ(at("-x^2"), -0.25);
    EXPECT_EQ(at("-(x - y)*z"), -(0.5 - 2) * -3);
    EXPECT_EQ(at("(x + 1)^2 * y - 1.5e1*z/ 2"), 2.25 * 2 + 22.5);
    EXPECT_EQ(at("x^0 + y^1"), 3);
    EXPECT_EQ(at(" 2 * x\t* y*z"), -6);
    EXPECT_EQ(at("x - 0.5 + .25"), 0.25);
    EXPECT_EQ(Polynomial("x*y^3 + z^2*y").degree(1), 3);
}

TEST(Polynomial, PointsAtTheColumn) {
    const std::vector<std::tuple<std::string, std::string, std::string>> wrong = {
        {"x^2 + 4y", "column 8", "4*x"},      {"x + * y", "column 5", "'*'"},
        {"(x + y", "column 1", "not closed"}, {"x + y)", "column 6", "'('"},
        {"x / y", "column 5", "number"},      {"x / 0", "column 5", "zero"},
        {"x ^ y", "column 5", "an integer"},  {"x ^ 41", "column 5", "40"},
        {"x +", "column 4", "ends"},          {"x $ y", "column 3", "'$'"},
        {"x + 1e", "column 7", "digits"},     {"", "column 1", "ends"},
        {"x + .", "column 5", "digits"},      {"x^30*x^30", "column 10", "above 40"},
        {"x^-1", "column 3", "an integer"}};
    for (const auto& [text, column, word] : wrong) {
        const std::string said = message(text);
        EXPECT_NE(said.find(column), std::string::npos) << text << ": " << said;
        EXPECT_NE(said.find(word), std::string::npos) << text << ": " << said;
    }
    const std::string deep(20000, '('), fits(100, '(');
    EXPECT_NE(message(deep + "x").find("column 101: parentheses are nested more than 100 deep"), std::string::npos);
    EXPECT_EQ(message(fits + "x" + std::string(100, ')')), "");
    EXPECT_EQ(message("((x + 1)*(y + 1)*(z + 1))^40"), "") << "the densest that there is";
    EXPECT_NE(message("(((x + 1)*(y + 1)*(z + 1))^20)^2 - 1")
                  .find("column 33: multiplying it out takes more than 10000000 products"),
              std::string::npos);
    EXPECT_EQ(message("(x) + (y)" +
                      [] {
                          std::string many;
                          for (int i = 0; i < 200; ++i) many += " + (z)";
                          return many;
                      }()),
              "");
    EXPECT_NE(message("3 - 1/2").find("constant"), std::string::npos);
    EXPECT_NE(message("x + 1e308*10").find("double precision"), std::string::npos);
}

TEST(Polynomial, CoefficientsEncloseTheNumbersWritten) {
    for (const auto& [text, p, q] :
         {std::tuple{"x/9", 1, 9}, {"0.1*x", 1, 10}, {"x*2/3/7", 2, 21}, {"x*(1/3)^2", 1, 9}, {"1e-3*x", 1, 1000}}) {
        const Interval c = Polynomial(text).terms()[0].coefficient;
        const Rational exact = Rational(p) / Rational(q);
        EXPECT_TRUE(Rational(c.inf()) <= exact && exact <= Rational(c.sup())) << text;
        EXPECT_LT(c.sup() - c.inf(), 1e-15) << text;
    }
    EXPECT_EQ(Polynomial("x/4").terms()[0].coefficient.inf(), 0.25);
    EXPECT_EQ(Polynomial("x/4").terms()[0].coefficient.sup(), 0.25);
}

TEST(Polynomial, SurfacesThatAreNone) {
    EXPECT_EQ(surface_problem(surface("x", -1, 1)), "");
    EXPECT_NE(surface_problem(surface("x", 1, 1)).find("no volume"), std::string::npos);
    EXPECT_NE(surface_problem(surface("x", 1, -1)).find("no volume"), std::string::npos);
    EXPECT_NE(surface_problem(surface("x", -1, std::numeric_limits<double>::infinity())).find("not finite"),
              std::string::npos);
    EXPECT_NE(surface_problem(surface("x^40", -1e100, 1e100)).find("overflows"), std::string::npos);
    EXPECT_NE(surface_problem(surface("7", -1, 1)).find("constant"), std::string::npos);
}

// A polynomial with integer coefficients, which rational arithmetic evaluates exactly.
struct Sample {
    std::string text;
    std::vector<std::tuple<int, int, int, int>> terms;  // coefficient, powers
};

Sample random_polynomial(Random& random) {
    Sample s;
    const int n = 1 + random.below(6);
    for (int i = 0; i < n; ++i) {
        const int c = random.below(19) - 9, p = random.below(4), q = random.below(4), r = random.below(4);
        s.terms.emplace_back(c, p, q, r);
        s.text += (i ? " + " : "") + std::string("(0 - ") + std::to_string(-c) + ")";
        if (c > 0) s.text = s.text.substr(0, s.text.rfind("(")) + std::to_string(c);
        s.text += "*x^" + std::to_string(p) + "*y^" + std::to_string(q) + "*z^" + std::to_string(r);
    }
    s.text += " + x";
    s.terms.emplace_back(1, 1, 0, 0);
    return s;
}

Rational value(const Sample& s, const Vec3& at) {
    Rational sum = 0;
    for (const auto& [c, p, q, r] : s.terms) {
        Rational summand = c;
        for (int i = 0; i < p; ++i) summand *= Rational(at[0]);
        for (int i = 0; i < q; ++i) summand *= Rational(at[1]);
        for (int i = 0; i < r; ++i) summand *= Rational(at[2]);
        sum += summand;
    }
    return sum;
}

TEST(IntervalForms, EncloseEveryValue) {
    Random random(3);
    for (int i = 0; i < 300; ++i) {
        const Sample s = random_polynomial(random);
        const Polynomial f(s.text);
        Box box;
        box.add(random.vector(2));
        box.add(box.low + random.vector(std::pow(10.0, -random.below(12))).cwiseAbs());
        std::array<Interval, 4> ranges;
        LinearForm linear;
        {
            const UpwardRounding upward;
            FormEvaluator evaluator(f);
            for (std::size_t form = 0; form < 4; ++form) ranges[form] = evaluator.range(static_cast<Form>(form), box);
            linear = evaluator.linear(box);
        }
        for (int corner = 0; corner < 12; ++corner) {
            Vec3 at;
            for (int k = 0; k < 3; ++k)
                at[k] = corner < 8
                            ? (corner >> k & 1 ? box.high : box.low)[k]
                            : std::min(box.high[k], box.low[k] + (box.high[k] - box.low[k]) * random.below(100) / 100);
            const Rational exact = value(s, at);
            for (std::size_t form = 0; form < 4; ++form) {
                EXPECT_TRUE(Rational(ranges[form].inf()) <= exact && exact <= Rational(ranges[form].sup()))
                    << s.text << ", " << form_names[form];
            }
            Rational rest = exact;  // f - slope.u lies in `rest`
            for (int k = 0; k < 3; ++k)
                rest -= Rational(linear.slope[k]) * (Rational(at[k]) - Rational(linear.middle[k])) /
                        Rational(linear.half[k]);
            EXPECT_TRUE(Rational(linear.rest.inf()) <= rest && rest <= Rational(linear.rest.sup())) << s.text;
        }
    }
}

TEST(IntervalForms, TheNewerAreTighterOnSmallBoxes) {
    const Polynomial f("x^4 - 3*x^2*y + y^2*z - x*z");
    Box box;
    box.add({0.7, -0.4, 1.1});
    box.add({0.75, -0.35, 1.15});
    const UpwardRounding upward;
    FormEvaluator evaluator(f);
    double width[4];
    for (std::size_t form = 0; form < 4; ++form) {
        const Interval range = evaluator.range(static_cast<Form>(form), box);
        width[form] = range.sup() - range.inf();
    }
    EXPECT_LT(width[3], width[2] * (1 + 1e-12));  // modified affine against plain affine
    EXPECT_LT(width[2], width[0]);
    EXPECT_LT(width[1], width[0]);
    // Modified affine arithmetic knows that x^2 is not negative; plain affine arithmetic does not.
    FormEvaluator square(Polynomial("x^2"));
    Box around;
    around.add({-1, 0, 0});
    around.add({1, 1, 1});
    EXPECT_EQ(square.range(Form::modified_affine, around).inf(), 0);
    EXPECT_LT(square.range(Form::affine, around).inf(), 0);
}

// 1/3 is not a double, so `rest` must include the rounding of the slope, and here nothing else.
TEST(IntervalForms, CountTheWidthOfTheSlope) {
    const UpwardRounding upward;
    FormEvaluator evaluator{Polynomial("x/3")};
    Box box;
    box.add({-1, -1, -1});
    box.add({1, 1, 1});
    const LinearForm f = evaluator.linear(box);
    const Rational rest = Rational(1) / Rational(3) - Rational(f.slope[0]);  // at u = 1
    EXPECT_NE(rest, Rational(0));
    EXPECT_TRUE(Rational(f.rest.inf()) <= rest && rest <= Rational(f.rest.sup()));
}

// Monomials beyond the sixth degree are bounded term by term. Compares them with exact values at
// corners, where those bounds are attained.
TEST(IntervalForms, HighDegreesAreEnclosed) {
    Random random(12);
    for (int i = 0; i < 200; ++i) {
        Sample s;
        for (int t = 0; t < 3; ++t) {
            const int c = 1 + random.below(9), p = random.below(11), q = random.below(11), r = random.below(11);
            s.terms.emplace_back(t % 2 ? c : -c, p, q, r);
            s.text += (t % 2 ? "+" : "-") + std::to_string(c) + "*x^" + std::to_string(p) + "*y^" + std::to_string(q) +
                      "*z^" + std::to_string(r);
        }
        s.text += "+x";
        s.terms.emplace_back(1, 1, 0, 0);
        const Polynomial f(s.text);
        Box box;
        const Vec3 middle = i % 3 ? random.vector(1) : Vec3::Zero();
        box.low = middle - Vec3::Constant(1 + random.unit()), box.high = middle + Vec3::Constant(1 + random.unit());
        const UpwardRounding upward;
        FormEvaluator evaluator(f);
        const LinearForm linear = evaluator.linear(box);
        for (int corner = 0; corner < 27; ++corner) {
            Rational rest, x[3];
            Vec3 at;
            for (int k = 0, place = corner; k < 3; ++k, place /= 3)
                at[k] = place % 3 == 0 ? box.low[k] : place % 3 == 1 ? box.high[k] : linear.middle[k];
            rest = value(s, at);
            for (int k = 0; k < 3; ++k)
                rest -= Rational(linear.slope[k]) * (Rational(at[k]) - Rational(linear.middle[k])) /
                        Rational(linear.half[k]);
            ASSERT_TRUE(Rational(linear.rest.inf()) <= rest && rest <= Rational(linear.rest.sup())) << s.text;
        }
    }
    // Even powers beyond the sixth are never negative.
    FormEvaluator even{Polynomial("x^10*y^2 + z")};
    Box around;
    around.add({-1, -1, 0});
    around.add({1, 1, 0.5});
    const UpwardRounding upward;
    EXPECT_GE(even.linear(around).rest.inf(), 0.25 - 1e-12);
}

// If terms overflow, the range must become everything, not an interval of NaN, which would contain no value.
TEST(IntervalForms, OverflowSaysNothing) {
    const UpwardRounding upward;
    Box box;
    box.add({-9, -7, -8});
    box.add({7, 9, 8});
    for (const char* text : {"y + 7e300*y^40*z^26", "7e300*x^40*y + z", "1e300*x^6*y^6*z^6 + 1e300*y^2"}) {
        FormEvaluator evaluator{Polynomial(text)};
        for (const Form form : {Form::affine, Form::modified_affine}) {
            const Interval range = evaluator.range(form, box);
            EXPECT_TRUE(range.inf() <= 0 && range.sup() >= 1e300) << text << " by form " << int(form);
        }
        const LinearForm linear = evaluator.linear(box);
        EXPECT_TRUE(linear.slope.allFinite() && std::isinf(linear.rest.sup())) << text;
    }
    box.add({0, 0, 1e8});  // z^39 overflows, z^38 does not, and x*z^39 has coefficients of 0
    box.add({0, 0, -1e8});
    FormEvaluator evaluator{Polynomial("y + x*z^39")};
    const LinearForm linear = evaluator.linear(box);
    EXPECT_TRUE(linear.slope.allFinite() && std::isinf(linear.rest.sup()));
}

// Work must grow with terms and degree. A dense expansion would have (degree + 1)^3 coefficients: 68,921 for degree 40.
TEST(IntervalForms, WorkGrowsWithTermsAndDegree) {
    const auto products = [](const std::string& text) {
        const UpwardRounding upward;
        FormEvaluator evaluator{Polynomial(text)};
        Box box;
        box.add({0.5, 0.5, 0.5});
        box.add({1, 1, 1});
        (void)evaluator.linear(box);
        return evaluator.products();
    };
    for (const int degree : {10, 20, 40}) {
        const std::string d = "^" + std::to_string(degree);
        const std::uint64_t once = products("x" + d + "*y" + d + "*z" + d + " + x");
        EXPECT_GT(once, 0u);
        EXPECT_LE(once, 500u + 60u * std::uint64_t(degree)) << degree;
        EXPECT_LE(products("x" + d + " + y" + d + " + z" + d + " - 1"), 1200u + 60u * std::uint64_t(degree)) << degree;
    }
    EXPECT_LE(products("x^2 + y^2 + z^2 - 1"), 60u);
}

TEST(Interval, RoundingModeIsPutBack) {
    const volatile double tiny = 0x1p-60;
    { const UpwardRounding upward; }
    EXPECT_EQ(1.0 + tiny, 1.0);
}

// Each result contains the exact value and spans at most two neighbouring doubles.
TEST(Interval, OperationsRoundOutwards) {
    Random random(4);
    int inexact = 0;
    for (int i = 0; i < 200; ++i) {
        const double x = random.real(-2, 2), y = random.real(0.1, 2);
        const UpwardRounding upward;
        const Interval a(x), b(y);
        const std::pair<Interval, Rational> cases[] = {{a + b, Rational(x) + Rational(y)},
                                                       {a - b, Rational(x) - Rational(y)},
                                                       {a * b, Rational(x) * Rational(y)},
                                                       {a / b, Rational(x) / Rational(y)}};
        for (const auto& [got, exact] : cases) {
            EXPECT_TRUE(Rational(got.inf()) <= exact && exact <= Rational(got.sup()));
            EXPECT_LE(got.sup(), std::nextafter(got.inf(), std::numeric_limits<double>::infinity()));
            inexact += got.inf() < got.sup();
        }
        const Interval root = CGAL::sqrt(b);
        EXPECT_TRUE(Rational(root.inf()) * Rational(root.inf()) <= Rational(y));
        EXPECT_TRUE(Rational(root.sup()) * Rational(root.sup()) >= Rational(y));
    }
    EXPECT_GT(inexact, 400);
}

}  // namespace
}  // namespace hausbench
