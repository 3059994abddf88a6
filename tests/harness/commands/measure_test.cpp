// The answers of `measure`: both directions, H from them, and a cutoff.
#include "algorithms/registry.h"
#include "algorithms/solver.h"
#include "harness/commands/measurement_solve.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <thread>

namespace hausbench {
namespace {

// h(first, second) = 3 and h(second, first) = 5.
Points first() {
    Points p(2, 3);
    p << 0, 0, 0, 0, 3, 0;
    return p;
}
Points second() {
    Points p(2, 3);
    p << 0, 0, 0, 5, 0, 0;
    return p;
}

Measured symmetric(bool turned, const Tolerance& tolerance, std::optional<double> cutoff = {}) {
    MeasureRequest request;
    request.symmetric = true;
    request.cutoff = cutoff;
    Measured measured;
    measured.cutoff = cutoff;
    Shape a = PointSet{first()}, b = PointSet{second()};
    if (turned) std::swap(a, b);
    request.in_process = true;
    solve(request, find_solver("scan"), tolerance, a, b, measured);
    return measured;
}

void expect_in(const Result& result, double distance, const char* what) {
    EXPECT_EQ(to_string(result.status), to_string(Status::converged)) << what;
    EXPECT_LE(result.bounds.lower, distance) << what;
    EXPECT_GE(result.bounds.lower, distance - 1e-6) << what;
    EXPECT_GE(result.bounds.upper, distance) << what;
    EXPECT_LE(result.bounds.upper, distance + 1e-6) << what;
}

TEST(Measure, HIsTheLargerOfTheTwo) {
    for (const bool turned : {false, true}) {
        for (const Tolerance tolerance :
             {Tolerance{Tolerance::Of::absolute, 1e-6}, Tolerance{Tolerance::Of::lower, 1e-7}}) {
            const Measured m = symmetric(turned, tolerance);
            ASSERT_TRUE(m.answer.forward && m.answer.backward);
            expect_in(*m.answer.forward, turned ? 5 : 3, "h(A,B)");
            expect_in(*m.answer.backward, turned ? 3 : 5, "h(B,A)");
            expect_in(m.answer.result, 5, "H(A,B)");
            // The source point is on A, whichever direction attains H.
            const Vec3 far(5, 0, 0), origin(0, 0, 0);
            EXPECT_EQ(m.answer.result.witness.source_point, turned ? far : origin);
            EXPECT_EQ(m.answer.result.witness.target_point, turned ? origin : far);
            EXPECT_EQ(m.answer.result.witness.direction,
                      turned ? Witness::Direction::source_to_target : Witness::Direction::target_to_source);
            EXPECT_EQ(m.answer.backward->witness.direction, Witness::Direction::target_to_source);
        }
    }
}

// A solver that answers [2, 4] if A has two points, otherwise [3, 3.5].
class Wide final : public Solver {
public:
    explicit Wide(const Options&) {}
    void prepare(const Scene& scene, const Prepared&) override { two_ = element_count(scene.source) == 2; }
    Result solve(const Query&, State*, Trace&) const override {
        Result result;
        result.status = Status::budget;
        result.bounds = two_ ? Bounds{2, 4} : Bounds{3, 3.5};
        result.witness.source_point = Vec3::Constant(two_ ? 2 : 3);
        result.note = two_ ? "of two points" : "of three points";
        return result;
    }

private:
    bool two_ = false;
};

TEST(Measure, EachBoundOfHIsTheLargerOne) {
    SolverEntry entry;
    entry.info.name = "wide";
    entry.info.source.points = entry.info.target.points = entry.info.original_coordinates = true;
    entry.make = [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<Wide>(options); };
    for (const bool turned : {false, true}) {
        MeasureRequest request;
        request.symmetric = request.in_process = true;
        Shape two = PointSet{first()}, three = PointSet{Points::Random(3, 3)};
        if (turned) std::swap(two, three);
        for (const double tolerance : {1.5, 0.5}) {
            Measured m;
            solve(request, entry, {Tolerance::Of::absolute, tolerance}, two, three, m);
            EXPECT_EQ(m.answer.result.bounds.lower, 3);
            EXPECT_EQ(m.answer.result.bounds.upper, 4);
            EXPECT_EQ(turned ? m.answer.result.witness.source_point : m.answer.result.witness.target_point,
                      Vec3(3, 3, 3));
            const bool close = tolerance > 1;
            EXPECT_EQ(to_string(m.answer.result.status), close ? "converged" : "budget");
            EXPECT_EQ(m.answer.result.note, close ? "" : "of two points");  // the direction with the larger gap
        }
    }
}

TEST(Measure, AQuestionEndsWithTheFirstDirectionThatAnswersIt) {
    const Tolerance tolerance{Tolerance::Of::absolute, 1e-6};
    const Measured soon = symmetric(true, tolerance, 4);  // h(A,B) = 5
    EXPECT_EQ(to_string(soon.answer.result.status), to_string(Status::above_cutoff));
    EXPECT_FALSE(soon.answer.backward);
    EXPECT_TRUE(std::isinf(soon.answer.result.bounds.upper));  // h(B,A) was not measured
    const Measured late = symmetric(false, tolerance, 4);      // only h(B,A) is 5
    EXPECT_EQ(to_string(late.answer.result.status), to_string(Status::above_cutoff));
    EXPECT_GT(late.answer.result.bounds.lower, 4);
    EXPECT_EQ(to_string(symmetric(false, tolerance, 5.5).answer.result.status), to_string(Status::below_floor));
}

// Answers [0, 1] at once. Asked for a certificate, it hangs or, with a time limit above 1 s, exits the process.
class NoProof final : public Solver {
public:
    explicit NoProof(const Options&) {}
    void prepare(const Scene&, const Prepared&) override {}
    Result solve(const Query& query, State*, Trace&) const override {
        if (query.wanted.certificate && query.time_limit > 1) ::_exit(7);
        while (query.wanted.certificate) std::this_thread::sleep_for(std::chrono::seconds(1));
        Result result;
        result.status = Status::converged;
        result.bounds = {0, 1};
        return result;
    }
};

TEST(Measure, AnAnswerOutlivesItsProof) {
    for (const bool hangs : {false, true}) {
        SolverEntry entry;
        entry.info.name = "no proof";
        entry.info.source.points = entry.info.target.points = true;
        entry.info.abilities = {Ability::certificates};
        entry.info.original_coordinates = true;
        entry.make = [](const Options& options) -> std::unique_ptr<Solver> {
            return std::make_unique<NoProof>(options);
        };
        MeasureRequest request;
        request.time_limit = hangs ? 0.1 : 10;
        request.certificate = "never written";
        Measured m;
        m.tolerance_of = request.of;
        solve(request, entry, {Tolerance::Of::absolute, 2}, PointSet{first()}, PointSet{second()}, m);
        ASSERT_FALSE(m.failed) << m.failed->reason;
        EXPECT_EQ(m.answer.result.bounds.upper, 1);
        EXPECT_FALSE(m.proven);
        EXPECT_NE(m.why_not_proven.find(hangs ? "its certificate was not written within" : "exit code 7"),
                  std::string::npos)
            << m.why_not_proven;
        EXPECT_EQ(exit_code(m, request), 1);
        EXPECT_NE(describe(m, request).find("h(A,B) in [0, 1]"), std::string::npos);
        EXPECT_TRUE(to_json(m, request).at("proven").is_null());
    }
}

TEST(Measure, AProofOfALargerBoundIsSaid) {
    MeasureRequest request;
    request.certificate = "a proof";
    Measured m;
    m.tolerance_of = request.of;
    m.answer.result.bounds = {0, 1};
    m.extent = 100;
    for (const auto& [proven, larger] : {std::pair{1 + 0.9e-10, false}, std::pair{1 + 1.1e-10, true}}) {
        m.proven = proven;
        EXPECT_EQ(describe(m, request).find("larger than the upper bound above") != std::string::npos, larger);
        EXPECT_EQ(to_json(m, request).at("proves_less"), larger);
    }
    m.proven.reset();
    EXPECT_TRUE(to_json(m, request).at("proves_less").is_null());
}

}  // namespace
}  // namespace hausbench
