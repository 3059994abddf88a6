// The check of result rows on small shapes: what it proves, what it refutes, and how it stops.
#include "harness/check/contradictions.h"
#include "harness/check/verify.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hausbench {
namespace {

// Repeats a triangle: interval arithmetic cannot exclude any of the equally near copies.
TriangleMesh copies_of_a_triangle(int count) {
    TriangleMesh mesh{Points(3, 3), Triangles(count, 3)};
    mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0;
    for (int i = 0; i < count; ++i) mesh.triangles.row(i) << 0, 1, 2;
    return mesh;
}

PointSet point(double x, double y, double z) {
    PointSet set{Points(1, 3)};
    set.points << x, y, z;
    return set;
}

Row answer(double lower, double upper, const Vec3& witness) {
    Row row;
    row.spec.source = "a";
    row.spec.target = "b";
    row.outcome.status = RowStatus::ok;
    row.outcome.solver_status = "converged";
    row.outcome.bounds = {lower, upper};
    row.outcome.witness.source_point = witness;
    row.outcome.witness.source_element = 0;
    return row;
}

class VerifyRows : public testing::Test {
protected:
    const Shape* load(const std::string& name) const { return name == "a" ? &source : &target; }
    void verify(const Stop& stop = {}) {
        verify_rows(
            rows, [this](const std::string& name) { return load(name); }, stop);
    }

    Shape source = point(0.25, 0.25, 2), target = copies_of_a_triangle(100);
    std::vector<Row> rows;
};

TEST_F(VerifyRows, TheDistanceHoldsAndTheNextDoubleDoesNot) {
    const Vec3 p(0.25, 0.25, 2);
    rows = {answer(2, 2, p), answer(std::nextafter(2.0, 3.0), 3, p), answer(1, 1.5, p)};
    verify();
    EXPECT_EQ(rows[0].check.lower, Verdict::holds);
    EXPECT_EQ(rows[0].check.upper, Verdict::holds);
    EXPECT_EQ(rows[1].check.lower, Verdict::unsound);
    EXPECT_EQ(rows[1].outcome.status, RowStatus::unsound);
    EXPECT_NE(rows[1].outcome.reason.find("(2)"), std::string::npos) << rows[1].outcome.reason;
    EXPECT_EQ(rows[2].check.lower, Verdict::holds);
    EXPECT_EQ(rows[2].check.upper, Verdict::unsound);  // below the verified lower bound of the first row
}

// The witness is 2 away from B, so an upper bound below 2 is wrong, even if the lower bound is smaller.
TEST_F(VerifyRows, AWitnessRefutesItsOwnUpperBound) {
    const Vec3 p(0.25, 0.25, 2);
    for (const auto& [lower, upper] : {std::pair(0.0, 1.5), std::pair(-1.0, 0.0), std::pair(1e-3, 1e-3)}) {
        rows = {answer(lower, upper, p)};
        verify();
        EXPECT_EQ(rows[0].check.upper, Verdict::unsound) << upper;
        EXPECT_EQ(rows[0].outcome.status, RowStatus::unsound) << upper;
    }
    rows = {answer(0, 2, p), answer(2, 2, p), answer(0, 1, Vec3::Constant(unknown))};
    verify();
    EXPECT_EQ(rows[0].check.upper, Verdict::holds);
    EXPECT_EQ(rows[1].check.upper, Verdict::holds);
    EXPECT_EQ(rows[2].check.upper, Verdict::unsound);  // refuted by the lower bound of the second row
}

TEST_F(VerifyRows, ReferencesRefuteByWhatIsCheckedAlone) {
    const Vec3 p(0.25, 0.25, 2), nowhere = Vec3::Constant(unknown);
    for (Row* row : {&(rows = {answer(3, 3, nowhere), answer(0, 1, nowhere), answer(1, 2.5, nowhere)}).front(),
                     &rows[1], &rows[2]}) {
        row->spec.source_hash = "a", row->spec.target_hash = "b";
    }
    Row reference = answer(2, 2, p);
    reference.spec.source_hash = "a", reference.spec.target_hash = "b";
    reference.spec.certified = 1;
    reference.is_reference = true;
    std::vector<Row> references = {reference};
    const auto check = [&] { verify_rows(rows, references, [this](const std::string& name) { return load(name); }); };
    check();
    EXPECT_EQ(rows[0].check.lower, Verdict::no_witness);  // above an upper bound that is not proven
    EXPECT_EQ(rows[1].check.upper, Verdict::unsound);     // below a lower bound that its witness proves
    EXPECT_EQ(rows[2].check.upper, Verdict::holds);
    ASSERT_EQ(references.size(), 1U);
    EXPECT_EQ(references[0].check.lower, Verdict::holds);
    for (const Row& row : rows) {
        EXPECT_EQ(row.reference.lower, 2);
        EXPECT_EQ(row.reference.upper, 2);
    }
    references[0].outcome.proven_upper = 2.25;
    rows[0].outcome.status = RowStatus::ok;
    check();
    EXPECT_EQ(rows[0].check.lower, Verdict::unsound);
    EXPECT_EQ(rows[2].check.lower, Verdict::no_witness);
    references[0].outcome.bounds = {5, 5};  // its witness refutes it, so it refutes no row
    rows[2].outcome.status = RowStatus::ok;
    check();
    EXPECT_EQ(references[0].outcome.status, RowStatus::unsound);
    EXPECT_EQ(rows[2].check.upper, Verdict::holds);
    EXPECT_TRUE(std::isnan(rows[2].reference.lower));
}

TEST_F(VerifyRows, StoppedItSaysNothingOfWhatIsLeft) {
    const Vec3 p(0.25, 0.25, 2);
    rows = {answer(3, 3, p), answer(2, 2, p)};
    int spec = 0;
    verify([&] { return ++spec > 50; });
    EXPECT_EQ(spec,
              53);  // 51 calls until it stops in the first row, one for the row's upper bound, one before the next row
    for (const Row& row : rows) {
        EXPECT_EQ(row.check.lower, Verdict::not_checked);
        EXPECT_EQ(row.check.upper, Verdict::not_checked);
        EXPECT_EQ(row.outcome.status, RowStatus::ok);
    }
}

TEST_F(VerifyRows, WhatCannotBeCheckedLosesItsOldVerdict) {
    rows = {answer(99, 100, {0.25, 0.25, 2})};
    rows[0].check = {Verdict::holds, Verdict::holds, ""};
    verify_rows(rows, [](const std::string&) { return nullptr; });
    EXPECT_EQ(rows[0].check.lower, Verdict::not_checked);
    EXPECT_EQ(rows[0].check.upper, Verdict::not_checked);
}

// Earlier rows of a result are checked again only if a new row has the same scene and pose.
TEST_F(VerifyRows, RowsOfAnEarlierRunAreCheckedWhereANewOneIsOfTheSame) {
    const Vec3 p(0.25, 0.25, 2);
    rows = {answer(2, 2, p), answer(1, 1.5, p), answer(99, 100, p), answer(99, 100, p)};
    rows[2].spec.pose.translation = Vec3(7, 0, 0);  // no new row has that pose
    rows[3].spec.pose = rows[2].spec.pose;
    for (std::size_t i = 1; i < rows.size(); ++i) rows[i].check = {Verdict::holds, Verdict::holds, ""};
    rows[3].check.lower = Verdict::unsound;
    rows[3].outcome.status = RowStatus::unsound;
    rows[3].outcome.reason = "found before";
    verify_rows(
        rows, [this](const std::string& name) { return load(name); }, {}, 1);
    EXPECT_EQ(rows[0].check.lower, Verdict::holds);
    EXPECT_EQ(rows[1].check.upper, Verdict::unsound);
    EXPECT_EQ(rows[1].outcome.status, RowStatus::unsound) << "a new lower bound refutes it";
    EXPECT_EQ(rows[2].check.lower, Verdict::holds) << "it was not looked at";
    EXPECT_EQ(rows[2].outcome.status, RowStatus::ok);
    EXPECT_EQ(rows[3].outcome.status, RowStatus::unsound);
    EXPECT_EQ(rows[3].outcome.reason, "found before");
}

TEST_F(VerifyRows, WhatWasCheckedBeforeIsCheckedAgainWhereItMatters) {
    const Check held{Verdict::holds, Verdict::holds, "", Verdict::holds};
    const auto moved = [](double up, const Check& check) {  // a row with wrong bounds at a pose of its own
        Row row = answer(99, 100, {0.25, 0.25, 2 + up});
        row.spec.pose.translation = {0, 0, up};
        row.check = check;
        row.fields = {{"alone", Field::Of::vertices, Field::Meaning::number, {1}}};
        return row;
    };
    rows = {answer(2, 2, {0.25, 0.25, 2}), answer(1, 1.5, {0.25, 0.25, 2}), moved(1, held), moved(2, {})};
    rows[1].check = held;
    verify_rows(
        rows, [this](const std::string& name) { return load(name); }, {}, 1);
    EXPECT_EQ(rows[1].check.upper, Verdict::unsound) << "the first row refutes it";
    EXPECT_EQ(rows[1].check.fields, Verdict::holds);
    EXPECT_EQ(rows[2].check.lower, Verdict::holds) << "as found before";
    EXPECT_EQ(rows[2].check.fields, Verdict::holds);
    EXPECT_EQ(rows[2].outcome.status, RowStatus::ok);
    EXPECT_EQ(rows[3].check.lower, Verdict::unsound) << "an earlier check did not come to it";
    EXPECT_EQ(rows[3].check.fields, Verdict::unsound);
}

TEST_F(VerifyRows, AWitnessIsAsGoodAsItIsNearTheSource) {
    rows = {answer(1.5, 2, {0.25, 0.25, 2.25}), answer(2.0, 2, {0.25, 0.25, 2.25}),
            answer(2.25, 3, {0.25, 0.25, 2.25})};
    for (Row& row : rows) row.outcome.witness.source_element = -1;
    verify();
    EXPECT_EQ(rows[0].check.lower, Verdict::holds);
    EXPECT_EQ(rows[1].check.lower, Verdict::holds);  // 2.25 from the target minus 0.25 from the source, exactly
    EXPECT_EQ(rows[2].check.lower, Verdict::unsound);
}

TEST_F(VerifyRows, AnElementOnEitherSideIsNotPassedOver) {
    for (double z : {2.0, -2.0}) {
        source = point(0.25, 0.25, z);
        const Vec3 p(0.25, 0.25, z);
        rows = {answer(2, 3, p), answer(std::nextafter(2.0, 3.0), 3, p)};
        verify();
        EXPECT_EQ(rows[0].check.lower, Verdict::holds);
        EXPECT_EQ(rows[1].check.lower, Verdict::unsound);
    }
}

// A is a point; B is that point and another one 5 away: h(A,B) = 0, h(B,A) = 5 = H.
class VerifyBothDirections : public testing::Test {
protected:
    VerifyBothDirections() {
        PointSet both{Points(2, 3)};
        both.points << 0, 0, 0, 5, 0, 0;
        b = both;
    }
    const Shape* load(const std::string& name) const { return name == "a" ? &a : &b; }
    void verify() {
        verify_rows(rows, [this](const std::string& name) { return load(name); });
    }
    // Make rows of h(A,B), of h(B,A), and of H with its witness on B.
    static Row from_a(double lower, double upper) { return answer(lower, upper, Vec3::Zero()); }
    static Row from_b(double lower, double upper) {
        Row row = answer(lower, upper, {5, 0, 0});
        std::swap(row.spec.source, row.spec.target);
        row.outcome.witness.source_element = 1;
        return row;
    }
    static Row symmetric(double lower, double upper) {
        Row row = answer(lower, upper, Vec3::Zero());
        row.spec.quantity = Quantity::symmetric;
        row.outcome.witness.target_point = {5, 0, 0};
        row.outcome.witness.target_element = 1;
        row.outcome.witness.direction = Witness::Direction::target_to_source;
        return row;
    }
    Verdict lower(std::size_t i) const { return rows[i].check.lower; }
    Verdict upper(std::size_t i) const { return rows[i].check.upper; }

    Shape a = point(0, 0, 0), b;
    std::vector<Row> rows;
};

TEST_F(VerifyBothDirections, AWitnessOnBShowsTheSymmetricDistance) {
    rows = {symmetric(5, 5), symmetric(std::nextafter(5.0, 6.0), 6)};
    verify();
    EXPECT_EQ(lower(0), Verdict::holds);
    EXPECT_EQ(upper(0), Verdict::holds);
    EXPECT_EQ(lower(1), Verdict::unsound);
    // The named element of B is 5 away from the witness point, so nothing is proven.
    rows = {symmetric(5, 5)};
    rows[0].outcome.witness.target_element = 0;
    verify();
    EXPECT_EQ(lower(0), Verdict::unsound);
    // A witness on A cannot show H = 5, because h(A,B) = 0.
    rows = {symmetric(5, 5)};
    rows[0].outcome.witness.direction = Witness::Direction::source_to_target;
    verify();
    EXPECT_EQ(lower(0), Verdict::unsound);
    // In a row of h(A,B) the witness must be on A, even if the row says that it is on B.
    rows = {symmetric(5, 5)};
    rows[0].spec.quantity = Quantity::directed;
    verify();
    EXPECT_EQ(lower(0), Verdict::unsound);
}

TEST_F(VerifyBothDirections, TheSymmetricDistanceRefutesNoDirectedOne) {
    rows = {symmetric(5, 5), from_a(0, 0), symmetric(0, 4)};
    verify();
    EXPECT_EQ(lower(0), Verdict::holds);
    EXPECT_EQ(upper(1), Verdict::holds);
    EXPECT_EQ(upper(2), Verdict::unsound);
}

TEST_F(VerifyBothDirections, EachDirectedDistanceRefutesTheSymmetricOneAndNotTheOther) {
    rows = {from_b(5, 5), from_a(0, 0), symmetric(0, 4), from_b(0, 4)};
    verify();
    EXPECT_EQ(lower(0), Verdict::holds);
    EXPECT_EQ(upper(1), Verdict::holds);  // h(B,A) says nothing about h(A,B)
    EXPECT_EQ(upper(2), Verdict::unsound);
    EXPECT_EQ(upper(3), Verdict::unsound);
    // The swapped scene has the same symmetric distance.
    rows = {from_b(5, 5), symmetric(0, 4)};
    std::swap(rows[1].spec.source, rows[1].spec.target);
    verify();
    EXPECT_EQ(upper(1), Verdict::unsound);
    // h(A,B) = 3 also refutes an upper bound of 2 on H.
    a = point(0, 3, 0);
    rows = {answer(3, 3, {0, 3, 0}), symmetric(0, 2)};
    verify();
    EXPECT_EQ(lower(0), Verdict::holds);
    EXPECT_EQ(upper(1), Verdict::unsound);
}

TEST_F(VerifyBothDirections, WithoutAWitnessACertifiedUpperBoundRefutes) {
    const auto bare = [](Row row) {
        row.outcome.witness.source_point = row.outcome.witness.target_point = Vec3::Constant(unknown);
        return row;
    };
    // An upper bound on h(A,B) says nothing about H.
    rows = {from_a(0, 0), bare(symmetric(5, 6))};
    rows[0].spec.certified = 1;
    verify();
    EXPECT_EQ(lower(1), Verdict::no_witness);
    // An upper bound on H also bounds both directed distances.
    rows = {symmetric(5, 5), bare(from_a(6, 7)), bare(from_b(6, 7)), bare(symmetric(6, 7))};
    rows[0].spec.certified = 1;
    verify();
    for (std::size_t i : {1u, 2u, 3u}) EXPECT_EQ(lower(i), Verdict::unsound) << i;
    // A refuted row refutes no other row.
    rows = {symmetric(0, 4), bare(from_b(4.5, 7)), from_b(5, 5)};
    rows[0].spec.certified = 1;
    verify();
    EXPECT_EQ(upper(0), Verdict::unsound);
    EXPECT_EQ(lower(1), Verdict::no_witness);
}

TEST_F(VerifyBothDirections, BothShapesArePosed) {
    // B is raised by 2: h(A,B) = 2, and B's far point is sqrt(29) away from A.
    const auto raised = [](Row row) {
        row.spec.target_pose.translation = Vec3(0, 0, 2);
        return row;
    };
    rows = {raised(from_a(2, 2)), from_a(0, 0), raised(from_a(std::nextafter(2.0, 3.0), 3)),
            raised(symmetric(5.25, 5.5))};
    rows[3].outcome.witness.target_point = {5, 0, 2};
    verify();
    EXPECT_EQ(lower(0), Verdict::holds);
    EXPECT_EQ(upper(0), Verdict::holds);
    EXPECT_EQ(upper(1), Verdict::holds);  // at another pose
    EXPECT_EQ(lower(2), Verdict::unsound);
    EXPECT_EQ(lower(3), Verdict::holds);
    // The swapped scene is the same if its poses are swapped too.
    Row turned = from_b(5.25, 5.5);
    turned.spec.pose.translation = Vec3(0, 0, 2);
    turned.outcome.witness.source_point = {5, 0, 2};
    rows = {turned, raised(symmetric(0, 5)), symmetric(0, 5)};
    verify();
    EXPECT_EQ(lower(0), Verdict::holds);
    EXPECT_EQ(upper(1), Verdict::unsound);
    EXPECT_EQ(upper(2), Verdict::holds);
    // A pose beyond the range of doubles leaves nothing to check.
    rows = {from_a(2, 2)};
    rows[0].spec.target_pose.rotation *= 1e308;
    rows[0].spec.target_pose.translation = Vec3::Constant(1e308);
    verify();
    EXPECT_EQ(lower(0), Verdict::not_checked);
}

TEST_F(VerifyBothDirections, OfSurfacesToo) {
    const auto ball = [](const std::string& squared_radius) {
        AlgebraicSurface surface{"x^2 + y^2 + z^2 - " + squared_radius, Points(2, 3)};
        surface.box.row(0).setConstant(-2);
        surface.box.row(1).setConstant(2);
        return surface;
    };
    a = ball("1"), b = ball("9/4");
    rows = {symmetric(0.4999, 0.6), symmetric(0.51, 0.6), from_b(0.4999, 0.6)};
    for (Row& row : rows) row.outcome.witness.target_point = row.outcome.witness.source_point = {0, 0, 1.5};
    verify();
    EXPECT_EQ(lower(0), Verdict::holds);
    EXPECT_EQ(lower(1), Verdict::unsound);
    EXPECT_EQ(lower(2), Verdict::holds);
}

// Answers of a correct but uncertified solver, which computes h in doubles. It applies poses with its
// own order of operations, so its rounding errors differ from the checker's.
class VerifyUncertified : public testing::Test {
protected:
    struct Scene {
        PointSet source, target;
        Pose source_pose, target_pose;
        double largest;  // largest |coordinate| or partial sum while posing
    };

    static Points posed_in_another_order(const Points& points, const Pose& pose) {
        Points out = points;
        for (Index i = 0; i < points.rows(); ++i) {
            for (int k = 0; k < 3; ++k) {
                const Vec3 r = pose.rotation.row(k).transpose();
                out(i, k) = r[0] * points(i, 0) + (r[1] * points(i, 1) + (r[2] * points(i, 2) + pose.translation[k]));
            }
        }
        return out;
    }

    static PointSet cloud(Random& random, Index count, const Vec3& at, double size) {
        PointSet set{Points(count, 3)};
        for (Index i = 0; i < count; ++i) set.points.row(i) = (at + random.vector(size)).transpose();
        return set;
    }

    static Row honest_answer(const Scene& s) {
        const Points a = posed_in_another_order(s.source.points, s.source_pose),
                     b = posed_in_another_order(s.target.points, s.target_pose);
        Row row = answer(0, 0, Vec3::Zero());
        double largest = -1;
        for (Index i = 0; i < a.rows(); ++i) {
            double least = std::numeric_limits<double>::infinity();
            for (Index j = 0; j < b.rows(); ++j) least = std::min(least, (a.row(i) - b.row(j)).squaredNorm());
            if (least <= largest) continue;
            largest = least;
            row.outcome.witness.source_point = a.row(i).transpose();
            row.outcome.witness.source_element = i;
        }
        row.outcome.bounds.lower = row.outcome.bounds.upper = std::sqrt(largest);
        row.spec.pose = s.source_pose;
        row.spec.target_pose = s.target_pose;
        row.spec.certified = 0;
        return row;
    }

    static std::vector<Row> verified(const Scene& s, std::vector<Row> rows) {
        const Shape a = s.source, b = s.target;
        verify_rows(rows, [&](const std::string& name) { return name == "a" ? &a : &b; });
        return rows;
    }

    // Returns the correct answer, the same answer marked certified, and one answer for each bound with
    // an error of a hundred times the slack.
    static std::vector<Row> rows_of(const Scene& s) {
        std::vector<Row> rows(4, honest_answer(s));
        const double error = 100 * 84 * 0x1p-53 * s.largest;
        rows[1].spec.certified = 1;
        rows[2].outcome.bounds.lower += error, rows[2].outcome.bounds.upper += 2 * error;
        rows[3].outcome.bounds.upper -= error;
        rows[3].outcome.bounds.lower = 0;
        return rows;
    }

    // Returns the share of scenes in which the solver's lower bound is too large by rounding.
    static double share_off(const std::vector<Scene>& scenes) {
        int off = 0;
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            const std::vector<Row> rows = verified(scenes[i], rows_of(scenes[i]));
            EXPECT_EQ(rows[0].check.lower, Verdict::holds) << i << ": " << rows[0].check.reason;
            EXPECT_EQ(rows[0].check.upper, Verdict::holds) << i << ": " << rows[0].check.reason;
            off += rows[1].check.lower == Verdict::unsound;
            EXPECT_EQ(rows[2].check.lower, Verdict::unsound) << i;
            EXPECT_NE(rows[2].check.reason.find("ulps); rounding explains"), std::string::npos) << rows[2].check.reason;
            EXPECT_EQ(rows[3].check.upper, Verdict::unsound) << i;
        }
        return double(off) / double(scenes.size());
    }
};

// A lower bound below the slack counts as 0 and needs no witness. So it does no harm that rounding
// puts this witness slightly off A and B.
TEST_F(VerifyUncertified, ABoundThatItsSlackTakesToZeroHolds) {
    const TriangleMesh mesh{(Points(3, 3) << 0.1, 0.2, 0.3, 0.7, 0.4, 0.1, 0.2, 0.9, 0.6).finished(),
                            (Triangles(1, 3) << 0, 1, 2).finished()};
    Row row;
    row.spec.source = "a", row.spec.target = "b";
    row.spec.certified = 0;
    row.outcome.bounds = {1e-16, 1e-16};
    row.outcome.witness.source_point = row.outcome.witness.target_point =
        Vec3(0.1, 0.2, 0.3) + Vec3(1e-16, -1e-16, 1e-16);
    row.outcome.witness.source_element = row.outcome.witness.target_element = 0;
    std::vector<Row> rows{row};
    const Shape a = mesh, b = mesh;
    verify_rows(rows, [&](const std::string& name) { return name == "a" ? &a : &b; });
    EXPECT_EQ(rows[0].check.lower, Verdict::holds) << rows[0].check.reason;
}

// One shape is small and at the origin; coordinates or pose make the other one far away or large.
// The slack must follow the larger coordinates.
TEST_F(VerifyUncertified, HonestBoundsHoldWhicheverShapeIsLarge) {
    for (int kind = 0; kind < 6; ++kind) {
        Random random(std::uint64_t(kind) + 1);
        std::vector<Scene> scenes;
        for (int i = 0; i < 60; ++i) {
            const double far = std::exp2(random.real(10, 12));
            const Vec3 away = far * random.vector();
            Scene s{cloud(random, 3, Vec3::Zero(), 1), cloud(random, 4, Vec3::Zero(), 1), {}, {}, 0};
            PointSet& moved = kind % 2 ? s.source : s.target;
            Pose& pose = kind % 2 ? s.source_pose : s.target_pose;
            if (kind < 2) moved = cloud(random, 3, away, 1);
            if (kind == 2 || kind == 3) pose.translation = away;
            if (kind >= 4) pose.rotation *= far;
            s.largest = far;
            scenes.push_back(std::move(s));
        }
        EXPECT_GT(share_off(scenes), 0.1) << kind;
    }
}

// Posing cancels large numbers and so loses digits: vertices lie a thousand away, and the pose brings them back.
TEST_F(VerifyUncertified, HonestBoundsHoldWherePosesCancel) {
    Random random(7);
    std::vector<Scene> scenes;
    for (int i = 0; i < 60; ++i) {
        const Vec3 away = 1000 * random.vector();
        const double angle = random.real(0, 6);
        Scene s{cloud(random, 5, away, 1), cloud(random, 5, Vec3::Zero(), 1), {}, {}, 3000};
        s.source_pose.rotation << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
        s.source_pose.translation = -(s.source_pose.rotation * away);
        scenes.push_back(std::move(s));
    }
    EXPECT_GT(share_off(scenes), 0.5);
}

// A bound that holds only within the slack does not refute another row.
TEST_F(VerifyUncertified, WhatRoundingExplainsRefutesNobody) {
    const Scene s{point(0.25, 0.25, 2), point(0.25, 0.25, 0), {}, {}, 2};
    Row off = honest_answer(s), proven = off;
    off.outcome.bounds.lower = off.outcome.bounds.upper = std::nextafter(2.0, 3.0);
    proven.spec.certified = 1;
    const std::vector<Row> rows = verified(s, {off, proven});
    EXPECT_EQ(rows[0].check.lower, Verdict::holds);
    EXPECT_EQ(rows[1].check.upper, Verdict::holds) << rows[1].check.reason;
    // A bound that holds exactly refutes another one that is off by one ulp.
    off.outcome.bounds.lower = 2;
    proven.outcome.bounds = {0, std::nextafter(2.0, 1.0)};
    EXPECT_EQ(verified(s, {off, proven})[1].check.upper, Verdict::unsound);
}

TEST_F(VerifyUncertified, AnUpperBoundMayBeRoundedDown) {
    const Scene s{point(0.25, 0.25, 2), point(0.25, 0.25, 0), {}, {}, 2};
    Row off = honest_answer(s), proven = off;
    proven.spec.certified = 1;
    off.outcome.bounds.upper = std::nextafter(2.0, 1.0);  // even below its own lower bound
    EXPECT_EQ(verified(s, {off, proven})[0].check.upper, Verdict::holds);
    off.spec.certified = 1;
    EXPECT_EQ(verified(s, {off, proven})[0].check.upper, Verdict::unsound);
}

TEST_F(VerifyUncertified, AnExcessIsSaidInUlps) {
    const Scene s{point(0.25, 0.25, 2), point(0.25, 0.25, 0), {}, {}, 2};
    Row row = honest_answer(s);
    row.spec.certified = 1;
    row.outcome.bounds = {std::nextafter(2.0, 3.0), 3};
    EXPECT_NE(verified(s, {row})[0].check.reason.find("(1 ulp)"), std::string::npos);
    row.outcome.bounds.lower = 2.5;
    EXPECT_NE(verified(s, {row})[0].check.reason.find("by 0.5 (1.1e+15 ulps)"), std::string::npos);
}

TEST_F(VerifyUncertified, WithoutAWitnessToo) {
    const Scene s{point(0.25, 0.25, 2), point(0.25, 0.25, 0), {}, {}, 2};
    Row proven = honest_answer(s), without = proven;
    proven.spec.certified = 1;
    without.outcome.witness.source_point.setConstant(std::numeric_limits<double>::quiet_NaN());
    without.outcome.bounds.lower = without.outcome.bounds.upper = std::nextafter(2.0, 3.0);
    EXPECT_EQ(verified(s, {proven, without})[1].check.lower, Verdict::no_witness);
    without.outcome.bounds.lower += 1e-12;
    EXPECT_EQ(verified(s, {proven, without})[1].check.lower, Verdict::unsound);
}

// Returns a row that does not contradict itself.
Row honest() {
    Row row = answer(1, 1.5, Vec3(0, 0, 0));
    row.spec.source_hash = "aa", row.spec.target_hash = "bb";
    row.spec.tolerance_of = "absolute";
    row.spec.tolerance = 0.5;
    row.spec.identity = identify(row.spec);
    row.outcome.witness.target_element = 99;
    return row;
}

TEST_F(VerifyRows, ARowThatContradictsItselfIsNoticed) {
    const auto says = [](auto change) {
        Row row = honest();
        change(row);
        return contradiction_in(row);
    };
    const auto expects = [&](auto change, const std::string& words) {
        EXPECT_NE(says(change).find(words), std::string::npos) << words << ": " << says(change);
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(says([](Row&) {}), "");
    expects([](Row& r) { r.outcome.bounds.upper = std::nextafter(1.5, 2.0); }, "not within the tolerance");
    expects([](Row& r) { r.outcome.bounds.lower = 0; }, "not within the tolerance");
    expects([&](Row& r) { r.outcome.bounds.lower = nan; }, "not a number");
    expects([&](Row& r) { r.outcome.bounds.upper = nan, r.outcome.solver_status = ""; }, "not a number");
    expects([](Row& r) { r.spec.source_hash = ""; }, "does not list its model 'a'");
    expects([](Row& r) { r.spec.target_hash = ""; }, "does not list its model 'b'");
    for (const auto change :
         {+[](Row& r) { r.spec.tolerance = 0.6; }, +[](Row& r) { r.spec.pose.translation.x() = 1; },
          +[](Row& r) { r.spec.target_hash = "cc"; }, +[](Row& r) { r.spec.limits.case_seconds = 1; },
          +[](Row& r) {
              r.spec.options = {{"seed", std::int64_t(1)}};
          }})
        expects(change, "its identity");
    // A gap above the tolerance is allowed if the bounds decide the floor or the cutoff, or if the status is not `ok`.
    EXPECT_EQ(says([](Row& r) { r.outcome.status = RowStatus::timeout, r.outcome.bounds.upper = 7; }), "");
    EXPECT_EQ(says([&](Row& r) { r.outcome.status = RowStatus::timeout, r.outcome.bounds.upper = nan; }), "");
    const auto spec = [](Row& r, double floor, double cutoff) {
        r.spec.floor = floor, r.spec.cutoff = cutoff;
        r.spec.identity = identify(r.spec);
        r.outcome.bounds = {1, 3};
    };
    EXPECT_EQ(says([&](Row& r) { spec(r, 3, 9); }), "");
    EXPECT_EQ(says([&](Row& r) { spec(r, 0, 0.5); }), "");
    EXPECT_EQ(says([&](Row& r) {
                  r.spec.chain = "the target before it in a search";
                  spec(r, 0, 9), r.outcome.cutoff_used = 0.5;
              }),
              "");
    expects([&](Row& r) { spec(r, 0, 9), r.outcome.cutoff_used = 0.5; }, "in no search");
    expects([&](Row& r) { r.outcome.status = RowStatus::budget; }, "its solver ended with converged");
    expects([&](Row& r) { spec(r, 2, 2); }, "not within");
}

TEST_F(VerifyRows, AWitnessNamesAnElementThatThereIs) {
    const auto says = [&](Index of_source, Index of_target) {
        Row row = honest();
        row.outcome.witness.source_element = of_source, row.outcome.witness.target_element = of_target;
        return wrong_witness(row.outcome.witness, element_count(source), element_count(target));
    };
    EXPECT_EQ(says(0, 99), "");
    EXPECT_EQ(says(-1, -1), "");
    EXPECT_NE(says(1, 0).find("element 1 of the source, which has 1"), std::string::npos);
    EXPECT_NE(says(-2, 0).find("source"), std::string::npos);
    EXPECT_NE(says(0, 100).find("element 100 of the target, which has 100"), std::string::npos);
}

TEST_F(VerifyRows, ManyContradictionsAreCounted) {
    Row wrong = honest();
    wrong.outcome.bounds.upper = 9;
    rows.assign(50, wrong);
    rows.push_back(honest());
    const auto lines = contradictions(rows, [this](const std::string& name) { return load(name); });
    ASSERT_EQ(lines.size(), 21u);
    EXPECT_EQ(lines.back(), "30 more rows contradict themselves");
}

}  // namespace
}  // namespace hausbench
