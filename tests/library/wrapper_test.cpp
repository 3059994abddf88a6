// hausbench.hpp gives the answers of hausbench.h, releases what it holds, and throws what the library or the caller's function says.
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <hausbench.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace {

using hausbench::Interval, hausbench::Pair, hausbench::Query, hausbench::Rows, hausbench::Shape,
    hausbench::TemporaryFolder;
using Corners = std::vector<std::array<double, 3>>;

// A square of two triangles at z = 0, and a mesh of its corners and a point above its middle.
const Corners square = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}},
              tent = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 1}};
const std::vector<std::array<std::int64_t, 3>> halves = {{0, 1, 2}, {0, 2, 3}},
                                               roof = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};

Pair tent_over_square(const hausbench::Plan& plan = {}) { return {Shape(tent, roof), Shape(square, halves), plan}; }

void expect_contains(const Interval& bounds, double value) {
    EXPECT_LE(bounds.lower, value);
    EXPECT_GE(bounds.upper, value);
    EXPECT_LT(bounds.upper - bounds.lower, 1e-2);
}

hausbench::Error error_of(const auto& body) {
    try {
        body();
    } catch (const hausbench::Error& error) {
        return error;
    }
    ADD_FAILURE() << "throws no hausbench::Error";
    return hausbench::Error(HAUSBENCH_ERROR_INIT);
}

TEST(Wrapper, BoundsDistances) {
    const Pair pair = tent_over_square();
    expect_contains(pair.directed().bounds, 1);
    expect_contains(pair.symmetric().bounds, 1);
    EXPECT_EQ(pair.directed().source_point[2], 1);
    EXPECT_EQ(pair.within(1.1).status, HAUSBENCH_WITHIN);
    EXPECT_EQ(pair.within(0.9).status, HAUSBENCH_ABOVE);
    // The middle of the square is 1/sqrt(2) from the tent.
    const Pair back{Shape(square, halves), Shape(tent, roof)};
    EXPECT_EQ(back.within(0.9).status, HAUSBENCH_WITHIN);
    EXPECT_EQ(back.within_symmetric(0.9).status, HAUSBENCH_ABOVE);
}

TEST(Wrapper, BoundsStatisticsAndFields) {
    const Pair pair = tent_over_square();
    Query query;
    query.tolerance = 1e-3;
    const hausbench::Distribution result = pair.distribution({"mean", "maximum"}, query);
    ASSERT_EQ(result.values.size(), 2);
    expect_contains(result.values[0], 1.0 / 3);
    expect_contains(result.values[1], 1);
    EXPECT_EQ(result.answer.bounds.lower, result.values[0].lower);
    const hausbench::Field field = pair.field();
    ASSERT_EQ(field.values.size(), tent.size());
    ASSERT_EQ(field.nearest.size(), tent.size());
    for (std::size_t i = 0; i < tent.size(); ++i) expect_contains(field.values[i], tent[i][2]);
    EXPECT_GE(field.nearest[4], 0);
}

TEST(Wrapper, TakesRowsOfEveryTypeAndContainer) {
    const std::array<std::array<float, 3>, 3> corners = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5F}}};
    const std::uint32_t indices[] = {2, 0, 1};
    const Shape shape(corners, Rows(indices, 1));
    EXPECT_EQ(shape.vertices(), (Corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}}));
    EXPECT_EQ(shape.faces(), (std::vector<std::array<std::int64_t, 3>>{{2, 0, 1}}));
    const Shape points{std::span(tent).last(2)};
    EXPECT_EQ(points.vertices(), (Corners{{0, 2, 0}, {1, 1, 1}}));
    EXPECT_TRUE(points.faces().empty());
    const hausbench_array column_by_column = {square[0].data(), 4, 24, 8, HAUSBENCH_FLOAT64, 0};
    EXPECT_EQ(Shape(Rows(column_by_column)).vertices(), square);
    static_assert(!std::is_convertible_v<std::vector<double>, Rows>);  // as a list of numbers could be in any order
    static_assert(!std::is_copy_constructible_v<Shape> && std::is_nothrow_move_constructible_v<Shape>);
    static_assert(!std::is_copy_constructible_v<Pair> && std::is_nothrow_move_constructible_v<Pair>);
}

TEST(Wrapper, ErrorsCarryMessageArgumentAndRow) {
    hausbench::Error error = error_of([] { Shape(square, std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 4}}); });
    EXPECT_STREQ(error.what(), "faces: row 1 names vertex 4, but the vertices are numbered from 0 to 3");
    EXPECT_EQ(error.code(), HAUSBENCH_BAD_INPUT);
    EXPECT_EQ(error.argument(), 2);
    EXPECT_EQ(error.row(), 1);
    error = error_of([] { const Shape none{Corners()}; });
    EXPECT_EQ(error.argument(), 1);
    EXPECT_EQ(error.row(), -1);
    error_of([] { Shape::read("none.ply"); });
    hausbench::Plan plan;
    plan.solver = "nobody";
    EXPECT_EQ(error_of([&] { tent_over_square(plan); }).argument(), 3);
    error_of([] { tent_over_square().distribution({"no such statistic"}); });
    Shape shape(square);
    const Shape moved(std::move(shape));
    error_of([&] { shape.description(); });
}

TEST(Wrapper, ReadsFilesWithOptionsAndNotes) {
    const TemporaryFolder folder;
    const std::string file = (folder.path() / "part.off").string();
    std::ofstream(file) << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 2 0\n3 0 1 2\n";
    EXPECT_TRUE(Shape::read(file).notes().empty());
    hausbench::ReadOptions options;
    options.unit = "mm";
    const Shape part = Shape::read(file, options);
    const hausbench::Description description = part.description();
    EXPECT_EQ(description.unit, 0.001);
    EXPECT_EQ(description.faces, 1);
    ASSERT_EQ(part.notes().size(), 1);
    const Shape copy(part.vertices(), part.faces(), description);
    EXPECT_EQ(copy.description().unit, 0.001);
    EXPECT_EQ(copy.description().is_mesh, 1);
}

TEST(Wrapper, PlansNameSolversAndParameters) {
    hausbench::Plan plan;
    EXPECT_EQ(std::ranges::count(hausbench::solvers(), "sampling"), 1);
    plan.solver = "sampling";
    plan.parameters = {"no_such_parameter=1"};
    EXPECT_NE(std::string(error_of([&] { tent_over_square(plan); }).what()).find("no_such_parameter"),
              std::string::npos);
}

TEST(Wrapper, PosesAndChains) {
    const Pair pair = tent_over_square();
    const hausbench::Chain chain = pair.chain();
    Query query;
    query.chain = chain.get();
    for (const double height : {0.0, 0.5, 1.0}) {
        query.source_pose = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, height, 0, 0, 0, 1};
        expect_contains(pair.directed(query).bounds, 1 + height);
    }
    query.target_pose = query.source_pose;
    expect_contains(pair.directed(query).bounds, 1);
}

TEST(Wrapper, CertificatesAreWrittenAndChecked) {
    const TemporaryFolder folder;
    const std::string file = (folder.path() / "proof.json").string();
    const Shape a(tent, roof), b(square, halves);
    expect_contains(Pair(a, b).certify(file).bounds, 1);
    const hausbench::Verdict verdict = hausbench::verify(file, a, b);
    EXPECT_EQ(verdict.accepted, 1) << verdict.text;
    expect_contains(verdict.bounds, 1);
    EXPECT_LE(verdict.proven, verdict.bounds.upper);
    const hausbench::Pose raised = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3, 0, 0, 0, 1};
    EXPECT_EQ(hausbench::verify(file, a, b, raised).accepted, 0);
    EXPECT_EQ(hausbench::verify(file, a, b, {}, raised).accepted, 0);
    Pair(a, b).certify_symmetric(file);
    EXPECT_EQ(hausbench::verify(file, a, b).accepted, 1);
    error_of([&] { hausbench::verify(file, b, a); });
}

// Two wavy sheets, which take a solver some time.
Shape sheet(int n, double shift) {
    Corners corners;
    std::vector<std::array<int, 3>> triangles;
    for (int i = 0; i <= n; ++i) {
        for (int k = 0; k <= n; ++k) corners.push_back({double(i), double(k), std::sin(i + shift) + std::cos(k)});
    }
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            const int at = i * (n + 1) + k;
            triangles.push_back({at, at + 1, at + n + 1});
            triangles.push_back({at + 1, at + n + 2, at + n + 1});
        }
    }
    return {corners, triangles};
}

TEST(Wrapper, FunctionsOfAQuery) {
    const Shape a = sheet(40, 0), b = sheet(37, 0.3);
    hausbench::Plan plan;
    plan.first = HAUSBENCH_NOTHING;
    Query query;
    query.tolerance = 1e-3;
    query.cancel = [] { return true; };
    EXPECT_EQ(Pair(a, b, plan).directed(query).status, HAUSBENCH_CANCELLED);
    query.cancel = []() -> bool { throw std::invalid_argument("enough"); };
    EXPECT_THROW(Pair(a, b, plan).directed(query), std::invalid_argument);
    query.cancel = [] { return false; };
    std::vector<Interval> seen;
    bool stop = false;
    query.progress = [&](const Interval* bounds, std::size_t count) {
        seen.assign(bounds, bounds + count);
        return stop;
    };
    EXPECT_EQ(Pair(a, b).distribution({"mean", "maximum"}, query).answer.status, HAUSBENCH_CONVERGED);
    ASSERT_EQ(seen.size(), 2);
    EXPECT_LE(seen[0].lower, seen[0].upper);
    stop = true;
    EXPECT_EQ(Pair(a, b).distribution({"mean", "maximum"}, query).answer.status, HAUSBENCH_CANCELLED);
}

}  // namespace
