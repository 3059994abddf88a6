// Every certified mesh solver along a motion. At each pose, its intervals of h and H, warm and cold, must overlap with
// all other solvers' intervals and with a run from scratch on moved vertices.
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/quick_options.h"
#include "tests/support/scenes.h"
#include "tests/support/truth.h"

#include <map>
#include <set>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

// Returns a bent sheet with bumps. No two parts are alike, and it is large enough for several levels of groups.
TriangleMesh bent(Index n, double bump, double bend) {
    TriangleMesh mesh = sheet(n, 0, bump);
    mesh.vertices.leftCols(2) /= static_cast<double>(n);
    for (Index v = 0; v < mesh.vertices.rows(); ++v) {
        const double x = mesh.vertices(v, 0) - 0.5, y = mesh.vertices(v, 1) - 0.5;
        mesh.vertices(v, 2) = mesh.vertices(v, 2) / static_cast<double>(n) + bend * x * x - 0.7 * bend * x * y;
    }
    return mesh;
}

struct Place {
    Pose source, target;
};

// Returns poses that bring the shapes from three sizes apart into overlap, while both turn.
std::vector<Place> motion(int steps) {
    std::vector<Place> places;
    for (int i = 0; i < steps; ++i) {
        const double t = 1 - static_cast<double>(i) / (steps - 1), s = 0.4 * t;
        const auto at = [](double z, const Vec3& where) {
            return turned((1 - z * z) / (1 + z * z), 2 * z / (1 + z * z), where);
        };
        places.push_back(
            {at(s, {3 * t, 0.25 * t, -0.5 * t}), i % 3 == 0 ? Pose{} : at(0.1 * t, {-0.25 * t, 0, 0.125})});
    }
    return places;
}

std::vector<SolverEntry> movers() {
    std::vector<SolverEntry> chosen;
    for (const SolverEntry& entry : solvers())
        if (entry.info.source.mesh && entry.info.certified && entry.info.known_wrong.empty() &&
            entry.info.offers(Quantity::directed))
            chosen.push_back(entry);
    return chosen;
}

// The intersection of all intervals found for one pose.
struct Common {
    Bounds bounds;
    std::string who;

    void add(const Bounds& other, const std::string& where) {
        EXPECT_LE(other.lower, other.upper) << where;
        EXPECT_LE(other.lower, bounds.upper) << where << " against " << who;
        EXPECT_GE(other.upper, bounds.lower) << where << " against " << who;
        if (other.lower > bounds.lower) bounds.lower = other.lower, who = where;
        bounds.upper = std::min(bounds.upper, other.upper);
    }
};

Query symmetric_query(const Place& place) {
    Query query;
    query.quantity = Quantity::symmetric;
    query.source_pose = place.source;
    query.target_pose = place.target;
    query.tolerance = {Tolerance::Of::absolute, 1e-4};
    return query;
}

constexpr QuerySet moving{
    .moves = true, .count = 20, .finest_tolerance = 1e-4, .target_moves = true, .symmetric = true};

TEST(MeshMotion, AllIntervalsOverlap) {
    const Scene scene{bent(40, 0.3, 0.8), bent(33, 0.4, 0.75)};
    const std::vector<Place> places = motion(9);
    std::map<std::pair<std::size_t, Quantity>, Common> common;
    std::map<std::string, std::pair<std::uint64_t, std::uint64_t>> queries;  // warm and cold
    const std::vector<SolverEntry> chosen = movers();
    EXPECT_GE(chosen.size(), 7U);
    for (const SolverEntry& entry : chosen) {
        const bool sharp = reaches_the_tolerance(entry.info);
        const Session session(entry, quick_options(entry), scene, moving);
        const std::unique_ptr<State> directed = session.begin(), both = session.begin();
        for (std::size_t i = 0; i < places.size(); ++i) {
            for (const Quantity quantity : {Quantity::directed, Quantity::symmetric}) {
                const std::string where =
                    entry.info.name + ", pose " + std::to_string(i) + ", " + std::string(to_string(quantity));
                Query query;
                query.quantity = quantity;
                query.source_pose = places[i].source;
                query.target_pose = places[i].target;
                query.tolerance = {Tolerance::Of::absolute, 1e-4};
                Trace trace;
                State* state = quantity == Quantity::directed ? directed.get() : both.get();
                const Result cold = session.solve(query, trace), warm = session.solve(query, state, trace);
                for (const auto& [result, how] : {std::pair{&cold, ", cold"}, std::pair{&warm, ", warm"}}) {
                    common[{i, quantity}].add(result->bounds, where + how);
                    check_witness(posed(scene, query.source_pose, query.target_pose), *result, where + how);
                    if (sharp) {
                        EXPECT_EQ(to_string(result->status), "converged") << where << how;
                    }
                }
                queries[entry.info.name].first += warm.counters.closest_point_queries;
                queries[entry.info.name].second += cold.counters.closest_point_queries;
                if (i % 4 != 0) continue;
                const Session still(entry, quick_options(entry), posed(scene, query.source_pose, query.target_pose),
                                    {.symmetric = true});
                query.source_pose = query.target_pose = Pose{};
                common[{i, quantity}].add(still.solve(query, trace).bounds, where + ", from scratch");
            }
        }
    }
    for (const char* name : {"tang", "cover"}) EXPECT_LT(queries[name].first, queries[name].second) << name;
}

// Threads share the state of a warm chain. Answers and counts must be the same as with one thread.
TEST(MeshMotion, ThreadsChangeNothing) {
    const Scene scene{bent(40, 0.3, 0.8), bent(33, 0.4, 0.75)};
    QuerySet threaded = moving;
    threaded.threads = 3;
    int tried = 0;
    for (const SolverEntry& entry : movers()) {
        if (!entry.info.can(Ability::threads) || !entry.info.can(Ability::warm)) continue;
        ++tried;
        const Session session(entry, quick_options(entry), scene, threaded);
        const std::unique_ptr<State> single = session.begin(), three = session.begin();
        for (const Place& place : motion(5)) {
            Query query = symmetric_query(place);
            Trace trace;
            const Result alone = session.solve(query, single.get(), trace);
            query.threads = 3;
            const Result together = session.solve(query, three.get(), trace);
            expect_same_answer(alone, together, entry.info.name);
            EXPECT_EQ(alone.counters, together.counters) << entry.info.name;
        }
    }
    EXPECT_GE(tried, 1);
}

// Moving both shapes alike must not change the distance, up to rounding of their vertices.
TEST(MeshMotion, ARigidMotionOfBothChangesNothing) {
    const Scene scene{bent(40, 0.3, 0.8), bent(33, 0.4, 0.75)};
    for (const SolverEntry& entry : movers()) {
        if (!reaches_the_tolerance(entry.info)) continue;
        const Session session(entry, quick_options(entry), scene, moving);
        Query query;
        query.quantity = Quantity::symmetric;
        query.tolerance = {Tolerance::Of::absolute, 1e-4};
        Trace trace;
        const Bounds rest = session.solve(query, trace).bounds;
        for (const Pose& pose : {turned(0.6, 0.8, {0.5, -0.25, 1}), turned(0.28, -0.96, {10, 20, -5})}) {
            query.source_pose = query.target_pose = pose;
            const Result moved = session.solve(query, trace);
            const double rounding = 32 * unit_roundoff * (3 + pose.translation.cwiseAbs().maxCoeff());
            EXPECT_LE(moved.bounds.lower, rest.upper + rounding) << entry.info.name;
            EXPECT_GE(moved.bounds.upper, rest.lower - rounding) << entry.info.name;
            EXPECT_EQ(to_string(moved.status), "converged") << entry.info.name;
        }
    }
}

// H(A,B) and H(B,A) must agree.
TEST(MeshMotion, TheOrderOfTheShapesDoesNotMatter) {
    const Scene scene{bent(40, 0.3, 0.8), bent(33, 0.4, 0.75)}, turned_round{scene.target, scene.source};
    for (const SolverEntry& entry : movers()) {
        const Session session(entry, quick_options(entry), scene, moving),
            other(entry, quick_options(entry), turned_round, moving);
        for (const Place& place : motion(4)) {
            Query query = symmetric_query(place);
            Trace trace;
            const Bounds a = session.solve(query, trace).bounds;
            std::swap(query.source_pose, query.target_pose);
            const Bounds b = other.solve(query, trace).bounds;
            EXPECT_LE(a.lower, b.upper) << entry.info.name;
            EXPECT_LE(b.lower, a.upper) << entry.info.name;
        }
    }
}

// For H, each direction profits from the other's results, so both together must take less counted work than two
// separate queries.
TEST(MeshMotion, TwoSidesTakeLessThanEachAlone) {
    const Scene scene{bent(40, 0.3, 0.8), bent(33, 0.4, 0.75)}, turned_round{scene.target, scene.source};
    for (const SolverEntry& entry : movers()) {
        if (!reaches_the_tolerance(entry.info)) continue;
        const Session both(entry, quick_options(entry), scene, moving),
            back(entry, quick_options(entry), turned_round, moving);
        std::uint64_t together = 0, apart = 0;
        const auto work = [](const Result& result) {
            const Counters& c = result.counters;
            return c.point_triangle_distances + c.bound_tests + c.node_visits;
        };
        for (const Place& place : motion(6)) {
            Query query;
            query.source_pose = place.source;
            query.tolerance = {Tolerance::Of::absolute, 1e-4};
            Trace trace;
            apart += work(both.solve(query, trace));
            Query other = query;
            std::swap(other.source_pose, other.target_pose);
            apart += work(back.solve(other, trace));
            query.quantity = Quantity::symmetric;
            together += work(both.solve(query, trace));
        }
        EXPECT_LT(together, apart) << entry.info.name;
    }
}

// Pairs of near triangles found in the first direction must save work in the second, for solvers that share them.
TEST(MeshMotion, TheSecondDirectionLearnsOfTheFirst) {
    const Scene scene{bent(40, 0.3, 0.8), bent(40, 0.31, 0.8)};  // near to each other everywhere
    int tried = 0;
    for (SolverEntry entry : movers()) {
        if (!entry.info.can(Ability::shared_pairs)) continue;
        ++tried;
        std::uint64_t spent[2] = {0, 0};
        for (const bool shares : {true, false}) {
            if (!shares) entry.info.abilities.erase(Ability::shared_pairs);
            const Session session(entry, quick_options(entry), scene, moving);
            for (int i = 0; i < 10; ++i) {
                Query query;
                query.quantity = Quantity::symmetric;
                query.source_pose.translation = {0.001 * i, 0, 0};
                query.tolerance = {Tolerance::Of::absolute, 1e-5};
                Trace trace;
                const Counters counters = session.solve(query, trace).counters;
                spent[shares ? 1 : 0] += counters.point_triangle_distances + counters.node_visits;
            }
        }
        EXPECT_LT(spent[1], spent[0]) << entry.info.name;
    }
    EXPECT_GE(tried, 2);
}

// A pose need not be rigid: structures built over A before the pose must be stretched with it.
TEST(MeshMotion, APoseThatStretches) {
    const Scene scene{bent(40, 0.3, 0.8), bent(33, 0.4, 0.75)};
    for (const Vec3& factors : {Vec3(4, 4, 4), Vec3(3, 0.5, -2), Vec3(0.25, 6, 1)}) {
        Query query;
        query.source_pose.rotation = factors.asDiagonal();
        query.tolerance = {Tolerance::Of::absolute, 1e-4};
        for (const SolverEntry& entry : movers()) {
            const Session session(entry, quick_options(entry), scene, moving),
                still(entry, quick_options(entry), posed(scene, query.source_pose), {.symmetric = true});
            for (const Quantity quantity : {Quantity::directed, Quantity::symmetric}) {
                query.quantity = quantity;
                Query at_rest = query;
                at_rest.source_pose = Pose{};
                Trace trace;
                const Bounds moved = session.solve(query, trace).bounds, rested = still.solve(at_rest, trace).bounds;
                EXPECT_LE(moved.lower, rested.upper) << entry.info.name;
                EXPECT_GE(moved.upper, rested.lower) << entry.info.name;
            }
        }
    }
}

TriangleMesh both_of(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh mesh;
    mesh.vertices.resize(a.vertices.rows() + b.vertices.rows(), 3);
    mesh.vertices << a.vertices, b.vertices;
    mesh.triangles.resize(a.triangles.rows() + b.triangles.rows(), 3);
    mesh.triangles << a.triangles, (b.triangles.array() + static_cast<Index>(a.vertices.rows())).matrix();
    return mesh;
}

// The pose stretches a strip of A to four times its length, so its size at rest is no longer valid. The rest of A is
// half as far from B and must not hide the strip.
TEST(MeshMotion, APartThatGrowsWhereItIs) {
    TriangleMesh strip;
    strip.vertices.resize(66, 3);
    strip.triangles.resize(64, 3);
    for (Index i = 0; i < 33; ++i) {
        const double y = 0.25 * (i - 16) / 16;
        strip.vertices.row(2 * i) << 0, y, 0;
        strip.vertices.row(2 * i + 1) << 0.001, y, 0;
    }
    for (Index i = 0; i < 64; ++i) strip.triangles.row(i) << i, i + 1, i + 2;
    TriangleMesh rest = bent(40, 0.1, 0);
    rest.vertices.rowwise() += Eigen::RowVector3d(4, 0, 0);
    Query query;
    query.source_pose.rotation = Vec3(1, 4, 1).asDiagonal();
    query.tolerance = {Tolerance::Of::absolute, 1e-4};
    TriangleMesh above = rest;
    above.vertices = posed(rest.vertices, query.source_pose);
    above.vertices.col(2).array() += 0.5;
    const TriangleMesh middle = soup(rows({{0, 0, 0}, {0.001, 0, 0}, {0, 0.001, 0}}));
    for (const SolverEntry& entry : movers()) {
        const Session session(entry, quick_options(entry), {both_of(strip, rest), both_of(middle, above)},
                              {.moves = true});
        Trace trace;
        const Bounds bounds = session.solve(query, trace).bounds;
        EXPECT_GE(bounds.upper, 0.999) << entry.info.name;
        EXPECT_LE(bounds.lower, 1.001) << entry.info.name;
    }
}

}  // namespace
}  // namespace hausbench
