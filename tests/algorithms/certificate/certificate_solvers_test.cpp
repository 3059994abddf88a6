// Every certificate that a solver writes must be accepted, for every scene, pose, quantity and unit. A slow solver
// defined here tests Session's own steps even if no other solver is built.
#include "harness/check/certificate_check.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/registry.h"
#include "algorithms/search/piece_proofs.h"
#include "algorithms/session/session.h"
#include "tests/support/certificates.h"
#include "tests/support/quick_options.h"
#include "tests/support/scenes.h"
#include "tests/support/searches.h"
#include "tests/support/small_scenes.h"
#include "tests/support/tree_meshes.h"

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using namespace certificates;

double diagonal_of_both(const Points& a, const Points& b) {
    Points corners(4, 3);
    corners << a.colwise().minCoeff(), a.colwise().maxCoeff(), b.colwise().minCoeff(), b.colwise().maxCoeff();
    return diagonal(corners);
}

// A solver that takes its bounds from the slow reference and proves them with random cuts.
class Slow final : public Solver {
public:
    void prepare(const Scene& scene, const Prepared&) override { scene_ = &scene; }
    Result solve(const Query& query, State*, Trace&) const override {
        Shape a = scene_->source;
        points_of(a) = posed(points_of(a), query.source_pose);
        const Points &vertices = points_of(a), &target = points_of(scene_->target);
        const double size = std::max(magnitude(vertices), magnitude(target));
        const double extent = diagonal_of_both(vertices, target);
        if (!(size <= largest_safe_coordinate)) return {};
        Result result;
        const Real gap = query.tolerance.value;
        const MeshReference reference(certificates::triangles_of(scene_->target));
        const auto [low, high] = reference.hausdorff(vertices, certificates::triangles_of(a).triangles, gap / 4);
        result.bounds.lower = std::max(0.0, double(low) - 0x1p-50 * size);
        const double tau = double(high + gap / 4);
        result.bounds.upper = tau + 0x1p-50 * size;
        result.status = query.answer(result.bounds.lower, result.bounds.upper).value_or(Status::precision_floor);
        if (!query.wanted.certificate) return result;
        Random random(17);
        if (const auto proof = Writer(a, scene_->target, tau, random).run())
            result.certificates = {written(*proof, result.bounds.upper + 400 * unit_roundoff * extent)};
        return result;
    }

private:
    const Scene* scene_ = nullptr;
};

SolverEntry slow_solver() {
    SolverInfo info;
    info.name = "slow";
    info.source = info.target = {.points = true, .mesh = true};
    info.certified = true;
    info.abilities.insert(Ability::certificates);
    return {info, [](const Options&) -> std::unique_ptr<Solver> { return std::make_unique<Slow>(); }};
}

std::vector<SolverEntry> with_certificates() {
    std::vector<SolverEntry> all = {slow_solver()};
    for (const SolverEntry& entry : solvers()) {
        if (entry.info.can(Ability::certificates)) all.push_back(entry);
    }
    return all;
}

struct Tally {
    int answers = 0, certificates = 0;
    double anew = 0;  // pieces bounded again for the certificate
};

// Checks that each certificate is accepted and proves the upper bound, up to rounding.
void check_all(const Scene& scene, const Query& query, const Result& result, Tally& tally, const std::string& where) {
    const std::size_t directions = query.quantity == Quantity::symmetric ? 2 : 1;
    ASSERT_TRUE(result.certificates.empty() || result.certificates.size() == directions) << where;
    ++tally.answers;
    if (!result.certificates.empty()) ++tally.certificates;
    for (const auto& [name, value] : result.reported) {
        if (name.starts_with(pieces_bounded_anew)) tally.anew += std::get<double>(value);
    }
    for (const Certificate& certificate : result.certificates) {
        const CertificateCheck check =
            check_certificate(scene.source, query.source_pose, scene.target, query.target_pose, certificate);
        EXPECT_TRUE(check.accepted) << where << ": " << check.refusal;
        const double extent = diagonal_of_both(posed(points_of(scene.source), query.source_pose),
                                               posed(points_of(scene.target), query.target_pose));
        EXPECT_LE(certificate.proven, result.bounds.upper + 1e-12 * extent) << where;
        EXPECT_GE(check.found, 0) << where;
    }
}

class Certificates : public ::testing::TestWithParam<std::size_t> {
protected:
    const SolverEntry entry = with_certificates()[GetParam()];
    const bool slow = entry.info.name == "slow";

    // sacht and kang may have to bound a piece again for its certificate; other solvers never do.
    void expect_own_steps(const Tally& tally) const {
        if (entry.info.name != "sacht" && entry.info.name != "kang") {
            EXPECT_EQ(tally.anew, 0) << entry.info.name;
        }
    }

    void ask(const TestScene& test, const Query& at_rest, Tally& tally, const std::string& what) const {
        if (!refusal(entry.info, kind_of(test.scene.source), kind_of(test.scene.target)).empty()) return;
        QuerySet queries;
        queries.moves = queries.target_moves = test.poses.size() > 1;
        queries.symmetric = at_rest.quantity == Quantity::symmetric;
        const Session session(entry, quick_options(entry), test.scene, queries);
        for (std::size_t pose = 0; pose < test.poses.size(); ++pose) {
            Query query = at_rest;
            query.wanted.certificate = true;
            (pose % 2 ? query.target_pose : query.source_pose) = test.poses[pose];
            const double extent = diagonal_of_both(posed(points_of(test.scene.source), query.source_pose),
                                                   posed(points_of(test.scene.target), query.target_pose));
            query.tolerance.value *= std::clamp(extent, 5e-300, 1e300);
            Trace untraced;
            const Result result = session.solve(query, untraced);
            const std::string where =
                entry.info.name + ", " + test.name + ", pose " + std::to_string(pose) + ", " + what;
            check_all(test.scene, query, result, tally, where);
            if (!slow && result.status == Status::converged) {
                EXPECT_FALSE(result.certificates.empty()) << where;
            }
        }
    }
};

std::vector<TestScene> all_scenes() {
    std::vector<TestScene> all = mesh_scenes();
    for (TestScene& scene : point_scenes()) all.push_back(std::move(scene));
    const std::size_t mixed = all.size();
    Random random(5);
    all.push_back(test_scene("points to a mesh", PointSet{cloud(random, 6)}, soup(cloud(random, 9))));
    add_variants(all, mixed);
    all.push_back(test_scene("a mesh to points", soup(cloud(random, 6)), PointSet{cloud(random, 20)}));
    return all;
}

TEST_P(Certificates, OfEverySceneAreAccepted) {
    Tally tally;
    for (const TestScene& scene : all_scenes()) {
        Query query;
        query.tolerance.value = slow ? 0.02 : 1e-3;
        ask(scene, query, tally, "h");
        query.quantity = Quantity::symmetric;
        ask(scene, query, tally, "H");
        if (slow) continue;
        query.tolerance.value = 1e-9;
        ask(scene, query, tally, "H to 1e-9");
    }
    // Not all of them: the slow solver gives up if a proof takes too many cuts.
    EXPECT_GT(tally.certificates, tally.answers * 9 / 10);
    expect_own_steps(tally);
}

TEST_P(Certificates, WhateverTheStatus) {
    Tally tally;
    for (const TestScene& scene : mesh_scenes()) {
        Query query;
        query.tolerance.value = slow ? 0.02 : 1e-6;
        Query low = query, high = query, few = query, none = query;
        low.floor = low.cutoff = 0.05;
        high.floor = 1e9;
        few.budget = 2;
        none.time_limit = 0;
        for (const auto& [what, variant] :
             {std::pair("cutoff", low), std::pair("floor", high), std::pair("budget", few), std::pair("no time", none)})
            ask(scene, variant, tally, what);
    }
    EXPECT_GT(tally.certificates, 0);
    expect_own_steps(tally);
}

TEST_P(Certificates, OfFiveThousandSoupsAreAccepted) {
    Tally tally;
    Random random(91);
    for (int i = 0; i < tries(slow ? 200 : 5000); ++i) {
        Query query;
        query.tolerance.value = slow ? 0.01 : i % 2 ? 1e-3 : 1e-8;
        ask({"soup " + std::to_string(i), small_scene(random, i), {Pose{}}}, query, tally, "h");
        if (HasFailure()) return;
    }
    EXPECT_GT(tally.certificates, tally.answers * 9 / 10);
    expect_own_steps(tally);
}

// Here the tolerance is below the errors of single precision, so `cover` settles pieces in other ways.
TEST_P(Certificates, OfNearlyEqualMeshesAreAccepted) {
    if (slow) return;
    Tally tally;
    Random random(93);
    const TriangleMesh mesh = triangle_grid(random, 8, 0.2);
    TriangleMesh moved = mesh;
    for (Eigen::Index i = 0; i < moved.vertices.rows(); ++i) moved.vertices.row(i) += 1e-8 * random.vector();
    Query query;
    query.tolerance.value = 1e-10;
    query.budget = 3000;  // some solvers would need very many subdivisions
    ask({"equal", {mesh, mesh}, {Pose{}}}, query, tally, "h");
    ask({"nearly equal", {mesh, moved}, {Pose{}}}, query, tally, "h");
    TriangleMesh thin = mesh;  // of needles, which `cover` finds in B only after it has covered them by others
    thin.vertices.col(1) *= 1e-6;
    query.tolerance.value = 1e-6;
    ask({"equal and thin", {thin, thin}, {Pose{}}}, query, tally, "h");
    EXPECT_EQ(tally.certificates, 3);
    expect_own_steps(tally);
}

// Tries sacht's four bounds in every order, and the other solvers with and without regions. Asking for a certificate
// must not change the bounds.
TEST(CertificatesOfCascades, EveryOrderAndSplit) {
    Random random(92);
    std::string digits;
    const auto check_order = [&](const std::string& name, ParameterMap given) {
        const SolverEntry& entry = find_solver(name);
        for (const char* split : {"midpoint", "longest_edge"}) {
            given.insert_or_assign("split", std::string(split));
            for (int i = 0; i < 20; ++i) {
                const Scene scene = small_scene(random, int(random.below(1000)));
                Query query;
                query.tolerance.value = i % 2 ? 1e-2 : 1e-6;
                query.budget = 3000;  // u1 and u2 alone converge slowly
                const Session session(entry, Options(name, entry.info.parameters, given), scene, {});
                Trace untraced;
                const Result plain = session.solve(query, untraced);
                query.wanted.certificate = true;
                const Result result = session.solve(query, untraced);
                const std::string where = name + " " + digits + " " + split + " " + std::to_string(i);
                EXPECT_EQ(result.bounds.lower, plain.bounds.lower) << where;
                EXPECT_EQ(result.bounds.upper, plain.bounds.upper) << where;
                EXPECT_EQ(result.counters.point_triangle_distances, plain.counters.point_triangle_distances) << where;
                ASSERT_EQ(result.certificates.size(), 1u) << where << ": " << result.why_no_certificate;
                Tally tally;
                check_all(scene, query, result, tally, where);
            }
        }
    };
    for (int order = 1; order < 625; ++order) {  // numbers to base 5, with each digit at most once
        digits.clear();
        for (int rest = order; rest > 0; rest /= 5) digits += char('0' + rest % 5);
        std::string sorted = digits;
        std::sort(sorted.begin(), sorted.end());
        if (sorted[0] == '0' || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) continue;
        check_order("sacht", {{"order", digits}});
        if (HasFailure()) return;
    }
    digits.clear();
    for (const char* name : {"guthe", "kang", "zheng"}) {
        check_order(name, {{"regions", true}});
        check_order(name, {{"regions", false}});
    }
}

INSTANTIATE_TEST_SUITE_P(EachSolver, Certificates, ::testing::Range<std::size_t>(0, with_certificates().size()),
                         [](const auto& test) { return with_certificates()[test.param].info.name; });

}  // namespace
}  // namespace hausbench
