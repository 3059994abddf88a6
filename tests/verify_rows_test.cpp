// The off-clock check on small shapes: what it proves, what it refutes, and that it can be stopped.
#include "verify.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hausbench {
namespace {

// Many triangles that are all equally far away: interval arithmetic settles none of them.
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
    row.asked.source = "a";
    row.asked.target = "b";
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
    EXPECT_EQ(rows[2].check.upper, Verdict::unsound);  // below the verified lower bound of the first
}

TEST_F(VerifyRows, StoppedItSaysNothingOfWhatIsLeft) {
    const Vec3 p(0.25, 0.25, 2);
    rows = {answer(3, 3, p), answer(2, 2, p)};
    int asked = 0;
    verify([&] { return ++asked > 50; });
    EXPECT_EQ(asked, 52);  // it stops within the first row, and asks once more before the second
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

TEST_F(VerifyRows, AWitnessIsAsGoodAsItIsNearTheSource) {
    rows = {answer(1.5, 2, {0.25, 0.25, 2.25}), answer(2.0, 2, {0.25, 0.25, 2.25}),
            answer(2.25, 3, {0.25, 0.25, 2.25})};
    for (Row& row : rows) row.outcome.witness.source_element = -1;
    verify();
    EXPECT_EQ(rows[0].check.lower, Verdict::holds);
    EXPECT_EQ(rows[1].check.lower, Verdict::holds);  // 2.25 from the target less 0.25 from the source, and exact
    EXPECT_EQ(rows[2].check.lower, Verdict::unsound);
}

}  // namespace
}  // namespace hausbench
