// Parts shared by branch-and-bound solvers: the queue of pieces, the cuts of a triangle, the interval, and when a
// search ends.
#include "algorithms/search/bounds.h"
#include "algorithms/search/queue.h"
#include "algorithms/search/subdivision.h"
#include "algorithms/search/target.h"
#include "algorithms/search/warm_start.h"
#include "algorithms/structures/octree.h"
#include "tests/support/exact.h"
#include "tests/support/random.h"

#include <set>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

// --- queue -----------------------------------------------------------------------------------------------------------

struct Numbered {
    double upper;
    int number;
};

TEST(PieceQueue, TakesTheLargestBoundAndUsesPlacesAgain) {
    Random random(1);
    PieceQueue<Numbered> queue;
    std::multiset<std::pair<double, int>> expected;
    std::size_t most = 0;
    EXPECT_EQ(queue.upper(), 0);
    for (int i = 0; i < 4000; ++i) {
        const bool grows = i / 500 % 2 == 0;
        if (expected.empty() || random.real(0, 1) < (grows ? 0.7 : 0.3)) {
            const Numbered piece{random.real(0, 1), i};
            queue.push(piece);
            expected.insert({piece.upper, piece.number});
        } else {
            const auto [upper, number] = *expected.rbegin();
            expected.erase(std::prev(expected.end()));
            EXPECT_EQ(queue.upper(), upper);
            const Numbered piece = queue.pop();
            EXPECT_EQ(piece.upper, upper);
            EXPECT_EQ(piece.number, number) << "another piece lies in its place";
        }
        most = std::max(most, expected.size());
        ASSERT_EQ(queue.size(), expected.size());
        ASSERT_EQ(queue.empty(), expected.empty());
        if (i % 100 != 0) continue;
        std::multiset<std::pair<double, int>> seen;
        queue.for_each([&](const Numbered& piece) { seen.insert({piece.upper, piece.number}); });
        EXPECT_EQ(seen, expected);
    }
    EXPECT_EQ(queue.places(), most);
    EXPECT_GT(most, 100u);
}

// --- cuts of a triangle ----------------------------------------------------------------------------------------------

struct Marked {
    Vec3 point;
    int mark;
};

// Returns twice the signed area in the plane z = 0; exact for coordinates that are small integers.
double area(const Vec3& a, const Vec3& b, const Vec3& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

std::array<Marked, 3> integer_triangle(Random& random) {
    std::array<Marked, 3> corners;
    do {
        for (int k = 0; k < 3; ++k) {
            const auto any = [&] { return 16 * std::floor(random.real(-100, 100)); };
            corners[static_cast<std::size_t>(k)] = {Vec3(any(), any(), 0), k};
        }
    } while (area(corners[0].point, corners[1].point, corners[2].point) <= 0);
    return corners;
}

TEST(Subdivision, ThePiecesCoverTheTriangleAndShareTheNewVertices) {
    Random random(2);
    for (const Split split : {Split::midpoint, Split::longest_edge}) {
        for (int i = 0; i < 300; ++i) {
            const auto corners = integer_triangle(random);
            int measured = 0;
            const auto cut = cut_triangle(corners, split, [&](const Vec3& point, const Marked& near) {
                EXPECT_LT(near.mark, 3);
                EXPECT_LE((point - near.point).norm(), 2000);
                return Marked{point, 3 + measured++};
            });
            const std::size_t pieces = split == Split::midpoint ? 4 : 2;
            ASSERT_EQ(cut.piece_count, pieces);
            ASSERT_EQ(cut.vertex_count, split == Split::midpoint ? 6u : 4u);
            EXPECT_EQ(measured, static_cast<int>(cut.vertex_count) - 3) << "each new vertex is measured once";

            // All pieces have the same area and orientation.
            const double whole = area(corners[0].point, corners[1].point, corners[2].point);
            std::array<int, 6> uses{};
            for (std::size_t p = 0; p < pieces; ++p) {
                const auto piece = cut.corners(p);
                EXPECT_EQ(area(piece[0].point, piece[1].point, piece[2].point) * static_cast<double>(pieces), whole);
                for (const Marked& corner : piece) ++uses[static_cast<std::size_t>(corner.mark)];
            }
            for (std::size_t v = 3; v < cut.vertex_count; ++v)
                EXPECT_EQ(uses[v], split == Split::midpoint ? 3 : 2) << "pieces share the new vertices";

            // Every point of a grid lies in a piece.
            for (int u = 0; u <= 16; ++u) {
                for (int v = 0; u + v <= 16; ++v) {
                    const Vec3 x = (u * corners[0].point + v * corners[1].point + (16 - u - v) * corners[2].point) / 16;
                    bool covered = false;
                    for (std::size_t p = 0; p < pieces; ++p) {
                        const auto piece = cut.corners(p);
                        bool inside = true;
                        for (std::size_t k = 0; k < 3; ++k)
                            inside = inside && area(piece[k].point, piece[(k + 1) % 3].point, x) >= 0;
                        covered = covered || inside;
                    }
                    EXPECT_TRUE(covered) << u << " " << v;
                }
            }
        }
    }
}

double longest_side(const std::array<Marked, 3>& corners) {
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k)
        longest = std::max(longest, (corners[k].point - corners[(k + 1) % 3].point).norm());
    return longest;
}

TEST(Subdivision, TheLongestEdgeIsHalved) {
    Random random(3);
    for (int i = 0; i < 300; ++i) {
        const auto corners = integer_triangle(random);
        const auto cut = cut_triangle(corners, Split::longest_edge, [](const Vec3& point, const Marked&) {
            return Marked{point, 3};
        });
        bool matches = false;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 &p = corners[k].point, &q = corners[(k + 1) % 3].point;
            matches = matches || (cut.vertices[3].point == 0.5 * (p + q) && (p - q).norm() == longest_side(corners));
        }
        EXPECT_TRUE(matches) << i;
    }
}

// After most_levels splits, pieces must be as small as rounding, even of thin triangles. Follows the pieces at the
// origin, where midpoints are exact.
TEST(Subdivision, ThePieceIsSmallerThanRoundingAtTheLastLevel) {
    Random random(4);
    for (const Split split : {Split::midpoint, Split::longest_edge}) {
        for (int i = 0; i < 100; ++i) {
            std::array<Marked, 3> piece{Marked{Vec3::Zero(), 0}, Marked{random.vector(), 1},
                                        Marked{random.vector(), 2}};
            if (i % 2 == 1) piece[2].point = piece[1].point + random.vector(1e-9);
            const double whole = longest_side(piece);
            for (int level = 0; level < most_levels(split); ++level) {
                const auto cut = cut_triangle(piece, split, [](const Vec3& point, const Marked&) {
                    return Marked{point, 3};
                });
                for (std::size_t p = 0; p < cut.piece_count; ++p) {
                    const auto corners = cut.corners(p);
                    if (std::any_of(corners.begin(), corners.end(), [](const Marked& m) { return m.point.isZero(0); }))
                        piece = corners;
                }
            }
            EXPECT_LE(longest_side(piece), 4 * unit_roundoff * whole * 4) << i;
        }
    }
}

// --- the interval and its end ----------------------------------------------------------------------------------------

constexpr int last_level = 50;

// A search whose B is one point, the origin, so that a point's distance is its length. M, the largest coordinate, is 1.
struct Search {
    explicit Search(const Query& given = {}, bool certify = true, Trace::Mode mode = Trace::Mode::off)
        : query(given), trace(mode), bounds(query, target, {1, certify}, counters, trace) {
        b.vertices = Points::Zero(3, 3);
        b.triangles = Triangles(1, 3);
        b.triangles << 0, 1, 2;
    }

    void offer(const Vec3& point, int level = 0) { bounds.offer({point, squared_length(point), 0}, 7, level); }
    Bounds interval(double queued) { return bounds.result(Status::stalled, queued).bounds; }

    Query query;
    TriangleMesh b;
    Target target{b, nullptr};
    Counters counters;
    Trace trace;
    SearchBounds bounds;
};

Query query_of(double tolerance) {
    Query query;
    query.tolerance = {Tolerance::Of::absolute, tolerance};
    return query;
}

TEST(SearchBounds, UpperIsTheLargestOfWhatIsSettledAndQueued) {
    Search search;
    search.offer({0.5, 0, 0});
    EXPECT_FALSE(search.bounds.settle(0.9, 7, last_level - 1, last_level));
    EXPECT_EQ(search.interval(0.75).upper, 0.75) << "what is not settled is the caller's";
    EXPECT_TRUE(search.bounds.settle(0.9, 7, last_level, last_level)) << "small as rounding";
    EXPECT_TRUE(search.bounds.settle(0.25, 7, 0, last_level)) << "cannot attain the maximum";
    EXPECT_EQ(search.interval(0.75).upper, 0.9);
    EXPECT_EQ(search.interval(0.95).upper, 0.95);
    EXPECT_LE(search.interval(0).lower, 0.5);
    EXPECT_GT(search.interval(0).lower, 0.5 - 1e-15);
}

TEST(SearchBounds, UpperIsNeverBelowLower) {
    Search search;
    search.offer({0.5, 0, 0});
    const Bounds interval = search.interval(0);
    EXPECT_GT(interval.lower, 0.4);
    EXPECT_GE(interval.upper, interval.lower);
}

// A piece is settled (done) if its bound is at most the farthest point's bound at the same level, to the last bit.
TEST(SearchBounds, PiecesAreSettledByWhatIsKnownAtTheirLevel) {
    Search search;
    EXPECT_FALSE(search.bounds.settle(1e-3, 7, 0, last_level)) << "nothing was measured";
    search.offer({0.5, 0, 0});
    for (const int level : {0, 1, 20}) {
        const double bound = search.bounds.at_most(0.25, level);
        EXPECT_EQ(bound - search.bounds.at_most(0.25, 0), 2 * level * unit_roundoff);
        EXPECT_TRUE(search.bounds.settle(bound, 7, level, last_level)) << level;
        EXPECT_FALSE(search.bounds.settle(next_up(bound), 7, level, last_level)) << level;
    }
}

TEST(SearchBounds, WhatIsBelowTheFloorIsSettled) {
    Query query = query_of(1e-3);
    query.floor = 0.625;
    Search search(query);
    search.offer({0.5, 0, 0});
    EXPECT_FALSE(search.bounds.settle(0.6875, 7, 3, last_level));
    EXPECT_TRUE(search.bounds.settle(0.5625, 7, 3, last_level));
    EXPECT_EQ(search.bounds.end(0, 0), Status::below_floor);
    EXPECT_EQ(search.interval(0).upper, 0.5625) << "its bound is kept";
}

// The search uses the computed distance of the farthest point; the result must use a proven one. Computed lengths are
// rounded up as often as down, and midpoints of level k are off by 2 * k * u.
TEST(SearchBounds, LowerIsCertifiedAndWidenedByTheLevel) {
    Random random(5);
    int rounded_up = 0;
    for (int i = 0; i < 200; ++i) {
        const Vec3 point = 0.5 * random.vector();
        const exact::Rational squared = exact::squared_distance(exact::vector(point), exact::vector(Vec3::Zero()));
        const auto above = [&](double x) { return exact::Rational(x) * exact::Rational(x) > squared; };
        Search plain({}, false);
        plain.offer(point);
        rounded_up += above(plain.interval(0).lower) ? 1 : 0;
        double before = 0;
        for (const int level : {0, 10, 20}) {
            Search search;
            search.offer(point, level);
            const double lower = search.interval(0).lower;
            EXPECT_FALSE(above(lower + 2 * level * unit_roundoff)) << i;
            EXPECT_FALSE(above(lower)) << i;
            EXPECT_TRUE(level == 0 || lower < before - 19 * unit_roundoff) << i;
            before = lower;
        }
    }
    EXPECT_GT(rounded_up, 20) << "certification has nothing to do";
}

// The lower bound of each triangle must be proven like the witness's, from the triangle's farthest point.
TEST(SearchBounds, FieldsAreCertifiedAndWidenedByTheLevel) {
    Random random(10);
    TriangleMesh b{Points::Zero(3, 3), Triangles(1, 3)};
    b.triangles << 0, 1, 2;
    const Target target(b, nullptr);
    const Query query;
    for (int i = 0; i < 200; ++i) {
        ElementBounds elements(4);
        Counters counters;
        Trace trace;
        SearchBounds bounds(query, target, {1, true}, counters, trace, &elements);
        bounds.offer({Vec3(1, 1, 1), 3, 0}, 3, 0);  // farther than all others
        const Vec3 point = 0.5 * random.vector();
        const int levels[] = {0, 10, 20};
        for (int k = 0; k < 3; ++k) {
            bounds.offer({point, squared_length(point), 0}, k, levels[k]);
            bounds.offer({0.5 * point, 0.25 * squared_length(point), 0}, k, 0);
        }
        const Fields fields = bounds.fields();
        ASSERT_EQ(fields.at(0).name, "lower");
        const exact::Rational squared = exact::squared_distance(exact::vector(point), exact::vector(Vec3::Zero()));
        for (std::size_t k = 0; k < 3; ++k) {
            const exact::Rational lower = fields[0].values[k] + exact::Rational(2 * levels[k] * unit_roundoff);
            EXPECT_TRUE(lower * lower <= squared) << i << ", level " << levels[k];
            EXPECT_GT(fields[0].values[k], std::sqrt(squared_length(point)) - 1e-14);
        }
        EXPECT_EQ(counters, Counters{}) << "what the fields cost is not the search's";
    }
}

TEST(SearchBounds, TheFieldsOfATriangleAreThoseOfItsOwnPieces) {
    TriangleMesh b{Points::Zero(3, 3), Triangles(1, 3)};
    b.triangles << 0, 1, 2;
    const Target target(b, nullptr);
    const Query query;
    ElementBounds elements(3);
    Counters counters;
    Trace trace;
    SearchBounds bounds(query, target, {1, true}, counters, trace, &elements);
    bounds.offer({Vec3(0.5, 0, 0), 0.25, 0}, 1, 0);
    EXPECT_TRUE(bounds.settle(0.375, 1, 3, last_level));
    EXPECT_TRUE(bounds.settle(0.25, 1, 2, last_level)) << "smaller: the larger one counts";
    EXPECT_FALSE(bounds.settle(0.75, 1, 4, last_level)) << "not settled";
    elements.subdivided(1, 4);
    elements.subdivided(1, 3);
    EXPECT_TRUE(bounds.settle(0.125, 2, 0, last_level));
    const Fields fields = bounds.fields();
    ASSERT_EQ(fields.size(), 3u);
    EXPECT_EQ(fields[1].values, (std::vector<double>{0, 0.375, 0.125}));
    EXPECT_EQ(fields[2].values, (std::vector<double>{0, 4, 0}));
    EXPECT_EQ(fields[0].values[0], 0) << "nothing was measured";
    EXPECT_EQ(fields[0].values[2], 0);
    EXPECT_NEAR(fields[0].values[1], 0.5, 1e-15);
}

TEST(SearchBounds, TheFarthestPointIsTheWitness) {
    Search search;
    search.offer({0.25, 0, 0});
    search.offer({0, 0.5, 0}, 2);
    search.offer({0, 0, 0.5});  // equally far: the first point counts
    const Result result = search.bounds.result(Status::budget, 0.75);
    EXPECT_EQ(result.witness.source_point, Vec3(0, 0.5, 0));
    EXPECT_EQ(result.witness.target_point, Vec3(0, 0, 0));
    EXPECT_EQ(result.witness.source_element, 7);
    EXPECT_EQ(result.witness.target_element, 0);
    EXPECT_EQ(result.status, Status::budget);
    EXPECT_EQ(result.counters, search.counters);
    search.offer({0.75, 0, 0});
    EXPECT_GT(search.interval(0.75).lower, 0.7) << "a farther point is certified anew";
}

TEST(SearchBounds, TheSearchGoesOnUntilItIsAnswered) {
    Search search(query_of(0.125));
    search.offer({0.5, 0, 0});
    EXPECT_EQ(search.bounds.end(0.75, 0), std::nullopt);
    EXPECT_EQ(search.counters, Counters{}) << "certifying comes last";
    EXPECT_EQ(search.bounds.end(0.6, 1), Status::converged);

    Query cut = query_of(1e-3);
    cut.cutoff = 0.25;
    Search above(cut);
    above.offer({0.125, 0, 0});
    EXPECT_EQ(above.bounds.end(0.75, 0), std::nullopt);
    above.offer({0.5, 0, 0});
    EXPECT_EQ(above.bounds.end(0.75, 1), Status::above_cutoff);

    Query few = query_of(1e-3);
    few.budget = 10;
    Search poor(few);
    poor.offer({0.5, 0, 0});
    EXPECT_EQ(poor.bounds.end(0.75, 9), std::nullopt);
    EXPECT_EQ(poor.bounds.end(0.75, 10), Status::budget);
    EXPECT_EQ(poor.bounds.end(0.5, 10), Status::converged) << "an answer comes before the budget";

    Query brief = query_of(1e-3);
    brief.time_limit = 1e-12;
    Search late(brief);
    late.offer({0.5, 0, 0});
    EXPECT_EQ(late.bounds.end(0.75, 64), Status::time_limit);
}

// The computed gap is within the tolerance, but the certified gap is not.
TEST(SearchBounds, AnAnswerRestsOnTheCertifiedLowerBound) {
    const Vec3 point(0.5, 0, 0);
    Search probe;
    probe.offer(point, 30);
    const double certified = probe.interval(0).lower;
    ASSERT_LT(certified, 0.5);
    const double tolerance = 0.5 * (0.5 - certified);
    for (const double upper : {0.5, 0.5 + 0.9 * tolerance}) {
        Search search(query_of(tolerance));
        search.offer(point, 30);
        EXPECT_EQ(search.bounds.end(upper, 0), Status::precision_floor);
    }
    Query cut = query_of(tolerance);
    cut.cutoff = 0.5 * (0.5 + certified);
    Search search(cut);
    search.offer(point, 30);
    EXPECT_EQ(search.bounds.end(0.75, 0), std::nullopt) << "it only seems to be above the cutoff";

    // At a larger tolerance, the search continues until the certified gap fits, and converges.
    Search tight(query_of(1.5 * (0.5 - certified)));
    tight.offer(point, 30);
    EXPECT_EQ(tight.bounds.end(certified + 2 * (0.5 - certified), 0), std::nullopt);
    EXPECT_EQ(tight.bounds.end(certified + 1.4 * (0.5 - certified), 0), Status::converged);
}

TEST(SearchBounds, NothingLeftIsThePrecisionFloor) {
    Search search(query_of(1e-3));
    search.offer({0.5, 0, 0});
    EXPECT_TRUE(search.bounds.settle(0.625, 7, last_level, last_level));
    EXPECT_EQ(search.bounds.end(0, 0), Status::precision_floor);
    EXPECT_EQ(search.bounds.end(0.5625, 0), Status::precision_floor) << "what is queued cannot change the interval";
    EXPECT_EQ(search.interval(0.5625).upper, 0.625);
}

TEST(SearchBounds, WithoutBoundsOfTrianglesThatOfTheVerticesHolds) {
    Random random(6);
    for (int i = 0; i < 200; ++i) {
        Search search;
        Points vertices(3, 3);
        exact::Rational most = 0;
        for (Index v = 0; v < 3; ++v) {
            vertices.row(v) = 0.5 * random.vector().transpose();
            const Vec3 point = vertices.row(v);
            most = std::max(most, exact::squared_distance(exact::vector(point), exact::vector(Vec3::Zero())));
        }
        if (i % 2 == 1) search.offer(vertices.row(0));
        const Result result = search.bounds.result_without_bounds(search.b.triangles, vertices);
        EXPECT_EQ(result.status, Status::time_limit);
        const exact::Rational upper = result.bounds.upper, lower = result.bounds.lower;
        EXPECT_TRUE(upper * upper >= most) << i;
        EXPECT_TRUE(lower * lower <= most) << i;
        EXPECT_EQ(lower > 0, i % 2 == 1);
        EXPECT_EQ(result.witness.source_element, i % 2 == 1 ? 7 : -1);
        EXPECT_LT(upper * upper, most + exact::Rational(1e-13));
    }
}

// --- warm starts -----------------------------------------------------------------------------------------------------

TEST(WarmStart, TheFarthestPointMovesAlong) {
    Random random(8);
    for (int i = 0; i < 300; ++i) {
        const Triangle before{random.vector(), random.vector(), random.vector()};
        const double u = random.real(0, 0.5), v = random.real(0, 0.5);
        const Vec3 move = random.vector();
        const auto inside = [&](const Triangle& t) { return Vec3(t.a + u * (t.b - t.a) + v * (t.c - t.a)); };
        const Triangle after{before.a + move, before.c + move, before.b + move};  // turned over
        WarmStart warm;
        warm.remember({{inside(before), 1, 3}, 5, 2}, before);
        EXPECT_EQ(warm.source, 5);
        EXPECT_EQ(warm.target, 3);
        EXPECT_EQ(warm.corner, -1);
        EXPECT_LE((warm.point_in(after) - inside(after)).norm(), 1e-6) << i;
        EXPECT_LE((warm.point_in(before) - inside(before)).norm(), 1e-6) << i;
        warm.remember({{before.b, 1, 3}, 5, 0}, before);
        EXPECT_EQ(warm.corner, 1);
    }
}

// Even if the old triangle was degenerate, the remembered point must lie on the new one.
TEST(WarmStart, ThePointIsInTheTriangleWhateverWasBefore) {
    Random random(9);
    for (const double size : {0.0, 1e-200, 1e-12, 1.0, 0x1p399}) {
        for (int i = 0; i < 100; ++i) {
            const Vec3 a = size * random.vector(), e = size * random.vector(),
                       f = i % 2 == 0 ? e : size * random.vector();
            WarmStart warm;
            warm.remember({{a + size * random.vector(), 1, 0}, 0, 1}, {a, a + e, a + f});
            for (const double weight : {warm.second, warm.third})
                EXPECT_TRUE(weight >= 0 && weight <= 1)
                    << size << " " << i;  // not NaN, for which closest_point promises nothing
            const Triangle now{random.vector(), random.vector(), random.vector()};
            const Vec3 point = warm.point_in(now);
            EXPECT_EQ(squared_distance_to_box(point, box_of(now)), 0) << size << " " << i;
            EXPECT_LE(closest_point(point, now).squared_distance, 1e-28) << size << " " << i;
        }
    }
}

// --- distances to B --------------------------------------------------------------------------------------------------

TEST(Target, TheTreeAndTheScanAgree) {
    Random random(7);
    TriangleMesh mesh;
    mesh.vertices = Points(60, 3);
    mesh.triangles = Triangles(20, 3);
    for (Index v = 0; v < 60; ++v) {
        mesh.vertices.row(v) = random.vector().transpose();
        mesh.triangles(v / 3, v % 3) = v;
    }
    const TriangleOctree octree(mesh);
    for (const bool textbook : {false, true}) {
        const Target scan(mesh, nullptr, textbook), tree(mesh, &octree, textbook);
        PointBlock block;
        Points points(block_width, 3);
        for (int i = 0; i < 50; ++i) {
            Counters scan_work, tree_work;
            const Vec3 point = random.vector();
            const ClosestPoint by_scan = scan.closest(point, -1, scan_work),
                               by_tree = tree.closest(point, i % 20, tree_work);
            // Textbook distances depend on which corner comes first, and a tree rotates the corners of its triangles.
            EXPECT_NEAR(by_scan.squared_distance, by_tree.squared_distance, textbook ? 1e-12 : 0);
            EXPECT_EQ(scan_work.closest_point_queries, 1u);
            EXPECT_EQ(tree_work.closest_point_queries, 1u);
            EXPECT_EQ(scan.squared_distance(point, scan.triangle(by_scan.triangle)), by_scan.squared_distance);
            EXPECT_EQ(scan.certified_distance(point, scan_work), tree.certified_distance(point, tree_work));
            EXPECT_LE(scan.certified_distance(point, scan_work), std::sqrt(by_scan.squared_distance) * (1 + 1e-14));

            for (Index lane = 0; lane < block_width; ++lane) {
                const Vec3 other = random.vector();
                for (int k = 0; k < 3; ++k) block.coordinate[k][lane] = other[k];
                points.row(lane) = other.transpose();
            }
            BlockFeet feet;
            scan.squared_distances(block, 6, scan.triangle(i % 20), feet);
            for (Index lane = 0; lane < 6; ++lane)
                EXPECT_EQ(feet.squared_distance[lane],
                          scan.squared_distance(Vec3(points.row(lane)), scan.triangle(i % 20)));
        }
    }
}

}  // namespace
}  // namespace hausbench
