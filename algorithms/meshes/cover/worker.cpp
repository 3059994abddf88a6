#include "algorithms/meshes/cover/worker.h"

#include "algorithms/kernel/posed_box.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/cover/batch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace hausbench {

namespace {

constexpr std::size_t most_spare_rooms = 4;
constexpr std::size_t most_looked_at = 32;  // triangles tried by from_partner() on either side of the middle of a group

// This thread's pool of returned scratch buffers.
std::vector<std::unique_ptr<CoverRoom::Covers>>& spare_rooms() {
    thread_local std::vector<std::unique_ptr<CoverRoom::Covers>> rooms;
    return rooms;
}

}  // namespace

CoverRoom::CoverRoom() {
    auto& spare = spare_rooms();
    if (spare.empty()) {
        covers_ = std::make_unique<Covers>();
        return;
    }
    covers_ = std::move(spare.back());
    spare.pop_back();
    // Resets these members; all others are set before they are read.
    covers_->rough.proof = covers_->exact.proof = nullptr;
    covers_->rough.distances = covers_->rough.tests = covers_->rough.cuts =
        WATCHED_ELSE("cover: counts of an earlier solve in a room that is used again", 0, 7);
    covers_->exact.distances = covers_->exact.tests = covers_->exact.cuts = 0;
}

CoverRoom::~CoverRoom() {
    if (!covers_ || spare_rooms().size() >= most_spare_rooms) return;
    covers_->rough.stack.clear();
    covers_->exact.stack.clear();
    spare_rooms().push_back(std::move(covers_));
}

void CoverWorker::begin(const Farthest& farthest, double settled, std::uint64_t budget, bool stopped,
                        const Deadline& deadline) {
    settled_before_ = settled;
    outcome_.farthest = farthest;
    outcome_.settled = 0;
    outcome_.groups.clear();
    outcome_.undecided.clear();
    outcome_.counters = {};
    budget_ = budget;
    stop_.reset();
    if (stopped) stop_ = Status::stalled;
    deadline_ = &deadline;
    batch_ = CoverBatch::most_pieces;
    crowded_ = false;
    set_tau();
}

CoverOutcome CoverWorker::finish() {
    count();
    return std::move(outcome_);
}

void CoverWorker::set_tau() {
    const double low = std::sqrt(std::max(outcome_.farthest.point.squared, 0.0));
    const Query& query = scene_.query;
    // A query with floor = cutoff only asks whether h(A,B) is above this value. Its answer needs no tolerance, so tau
    // is the floor. That ends once a point is measured that is as far as the cutoff up to rounding: no bound of its
    // piece will be at most the cutoff. A point that is clearly farther may still answer the question, but without a
    // gap above the point, pieces of the same distance would be cut until they are as small as the rounding errors.
    const bool asks = query.floor >= query.cutoff;
    within_floor_ = asks && WATCHED_ELSE("cover: a tie with the cutoff ends the search",
                                         low <= covered_within(query.floor, 0), true);
    const double gap = asks ? scene_.least_gap : std::max(0.9 * query.tolerance.gap(low), scene_.least_gap);
    tau_ = within_floor_ ? query.floor : std::max(low + gap, query.floor);
    // Ends the search once the lower bound is clearly above the cutoff. The status becomes `above_cutoff` at the end,
    // if the certified lower bound is above the cutoff, too; it is slightly smaller, hence the margin.
    if (!stop_ && WATCHED("cover: a distance above the cutoff ends the search",
                          low - 4096 * unit_roundoff * scene_.magnitude > query.cutoff))
        stop_ = Status::stalled;
}

MeasuredPoint CoverWorker::measure(const Vec3& point, Index near, Index source, int level) {
    const ClosestPoint nearest = scene_.target.closest(point, near, outcome_.counters);
    const MeasuredPoint measured{point, nearest.squared_distance, nearest.triangle};
    if (scene_.elements) scene_.elements->offer(measured, source, level);
    if (measured.squared > outcome_.farthest.point.squared) {
        outcome_.farthest = {measured, source, level};
        set_tau();
    }
    if (outcome_.counters.closest_point_queries % 64 == 0) look_at_clock();
    return measured;
}

void CoverWorker::look_at_clock() {
    if (!stop_ && deadline_->passed()) stop_ = Status::time_limit;
}

void CoverWorker::settle(double upper, Index source) {
    outcome_.settled = std::max(outcome_.settled, upper);
    if (scene_.elements) scene_.elements->settle(upper, source);
}

void CoverWorker::settle(const CoverPiece& piece) {
    settle(piece.upper.value, piece.source);
    if (!scene_.proofs) return;
    CertificateTree& tree = scene_.proofs->tree(piece.proof);
    if (piece.upper.vertex >= 0)
        tree.vertex(piece.upper.vertex, piece.upper.near);
    else
        tree.one(piece.upper.near);
}

void CoverWorker::settle(const Cluster& cluster) {
    outcome_.settled = std::max(outcome_.settled, cluster.upper.value);
    if (!scene_.elements && !scene_.proofs) return;
    for (std::size_t i = cluster.begin; i < cluster.begin + cluster.count; ++i) {
        const Index source = scene_.order[i];
        settle(cluster.upper.value, source);
        if (scene_.proofs) scene_.proofs->tree(source).vertex(cluster.upper.vertex, cluster.upper.near);
    }
}

// Computes an upper bound on the distance of a piece to B: the largest distance from a corner to triangle `near` of B.
// The distance to a triangle is convex, so its largest value over the piece is at a corner.
CoverWorker::CornerBound CoverWorker::by_corners(const CoverPiece& piece, Index near) {
    CornerBound bound;
    for (std::size_t k = 0; k < WATCHED_ELSE("cover: every corner of a piece that one triangle settles", 3U, 1U); ++k) {
        const double squared = scene_.target.squared_distance(piece.corners[k], scene_.target.triangle(near));
        if (squared > bound.squared) {
            bound.squared = squared;
            bound.farthest = k;
        }
    }
    outcome_.counters.point_triangle_distances += 3;
    bound.upper = {
        surface_distance_at_most(bound.squared, scene_.magnitude,
                                 WATCHED("cover: halvings in a bound by the corners of a piece", piece.level)),
        near, -1};
    return bound;
}

// Halves a piece at the midpoint of its longest edge, and measures the distance from the midpoint to B. The midpoint
// becomes the landmark of both halves, which keep the upper bound of the piece.
std::array<CoverPiece, 2> CoverWorker::halve(const CoverPiece& piece) {
    const std::size_t a = piece.longest_edge(), b = (a + 1) % 3, c = (a + 2) % 3;
    const Vec3 middle = 0.5 * (piece.corners[a] + piece.corners[b]);
    const int level = piece.level + WATCHED("cover: a half is one level deeper", 1);
    ++outcome_.counters.subdivisions;
    if (outcome_.counters.subdivisions >= budget_ && !stop_) stop_ = Status::budget;
    if (scene_.elements) scene_.elements->subdivided(piece.source, level);
    const MeasuredPoint m =
        measure(middle, piece.landmark.near, piece.source, WATCHED("cover: the level of a midpoint", level));
    std::array<Index, 2> proofs{};
    if (scene_.proofs) proofs = scene_.proofs->halve(piece.proof, CutPoint::along(a, 0.5), CutPoint::corner(c));
    const Landmark landmark{middle, std::sqrt(m.squared), m.triangle, -1};
    const std::array<Vec3, 3> first{middle, piece.corners[b], piece.corners[c]},
        second{piece.corners[c], piece.corners[a], middle};
    return {{{first, piece.source, proofs[0], piece.upper, landmark, level},
             {second, piece.source, proofs[1], piece.upper, landmark, level}}};
}

// Tries to finish one half of a piece with the upper bound from a single triangle of B, the one nearest to its
// landmark. Returns true if the half needs more work.
bool CoverWorker::is_open(CoverPiece& half) {
    const Index near = half.landmark.near;
    const CornerBound bound = by_corners(half, near);
    half.upper.improve(bound.upper);
    // Measures the corner farthest from triangle `near`. Unless another triangle of B is much nearer to this corner,
    // this raises the lower bound and tau.
    if (half.upper.value > tau_ && !stop_ && bound.squared > tau_ * tau_)
        measure(half.corners[bound.farthest], near, half.source,
                WATCHED("cover: the level of a half's corner", half.level));
    if (half.upper.value > tau_ && !stop_) return true;
    settle(half);
    return false;
}

// Adds the work counts of cover_ and exact_ to the counters of the outcome, and resets them.
void CoverWorker::count() {
    const auto add = [&](auto& cover) {
        outcome_.counters.point_triangle_distances += cover.distances;
        outcome_.counters.bound_tests += cover.tests;
        outcome_.counters.subdivisions += cover.cuts;
        cover.distances = cover.tests = cover.cuts = 0;
    };
    add(cover_);
    add(exact_);
}

// Returns the largest bound that a piece of this level may get from a cover: widened for rounding, it is still at most
// `tau`.
//
// u is the unit roundoff 2^-53, and M is the magnitude. The bound x of a cover is widened like a measured distance, by
// surface_sum_at_most(): to x * (1 + 5u) + (8 + 2 * level) * uM. Only the 2uM for each level are needed, because x
// already includes all roundings of the cover, even the conversion of A and B to local coordinates
// (meshes/cover/offset_cover.h). The 8uM stay because they are below every tolerance that can be met, and without them
// the last bits of all answers would change. Below, 8u and 10uM take the place of 5u and 8uM; the difference covers the
// rounding of both formulas.
double CoverWorker::covered_within(double tau, int level) const {
    return std::max(tau * (1 - 8 * unit_roundoff) - (WATCHED("cover: the widening in what a cover may show", 10) +
                                                     WATCHED("cover: halvings in what a cover may show", 2 * level)) *
                                                        unit_roundoff * scene_.magnitude,
                    0.0);
}

// Returns an upper bound on the distance to B of any point of the box: the distance of the point `at` to B, plus the
// distance from `at` to the farthest corner of the box.
double CoverWorker::around(const Vec3& at, double distance, const Box& box) const {
    return WATCHED_ELSE(
        "cover: the rounding of the distance around a measured point",
        surface_sum_at_most(distance + WATCHED("cover: the way from the landmark to the farthest point of a group",
                                               std::sqrt(squared_distance_at_most(at, box))),
                            scene_.magnitude, 0),
        distance + std::sqrt(squared_distance_at_most(at, box)));
}

// Looks for a landmark that needs no query: a corner of a triangle of A with a *partner*, a triangle of B that was near
// it at an earlier pose or in the other direction of H. The distance from the corner to the partner is an upper bound
// on the distance from the corner to B. Starts at the middle of the group, because narrow() sets the partner of the
// middle triangle. Returns false if it finds no partner.
bool CoverWorker::from_partner(const Cluster& group, const Box& box, Landmark& landmark) {
    if (!scene_.partner) return false;
    const std::size_t middle = group.begin + group.count / 2, end = group.begin + group.count;
    for (std::size_t away = 0; away < most_looked_at; ++away) {
        for (const std::size_t i : {middle + away, middle - away}) {
            if (i < group.begin || i >= end || (away == 0 && i != middle)) continue;
            const Index source = scene_.order[i], near = scene_.partner[source];
            if (near < 0) continue;
            ++outcome_.counters.point_triangle_distances;
            landmark = central_corner(source, box);
            landmark.near = near;
            landmark.distance =
                WATCHED("cover: how far a partner is",
                        std::sqrt(scene_.target.squared_distance(landmark.at, scene_.target.triangle(near))));
            return true;
        }
    }
    return false;
}

// Returns a corner of a triangle as a landmark that is not measured yet. Chooses the corner for which the farthest
// point of the box is nearest, because around() adds this distance to the bound.
Landmark CoverWorker::central_corner(Index source, const Box& box) const {
    Landmark landmark;
    double least = std::numeric_limits<double>::infinity();
    for (const Index v : scene_.a.triangles.row(source)) {
        const Vec3 corner = scene_.points.row(v);
        const double far = squared_distance_at_most(corner, box);
        if (far < least) {
            least = far;
            landmark.at = corner;
            landmark.vertex = v;
        }
    }
    return landmark;
}

void CoverWorker::narrow(const Cluster& group, const Box& box) {
    Cluster part = group;
    bool known = group.landmark.near >= 0, seeded = false;
    const auto upper = [&] {
        return KnownUpper{around(part.landmark.at, part.landmark.distance, box), part.landmark.near,
                          part.landmark.vertex};
    };
    if (known) part.upper.improve(upper());
    if (Landmark other; part.upper.value > tau_ && from_partner(part, box, other)) {
        const double value = around(other.at, other.distance, box);
        seeded = scene_.partner[middle_of(part)] >= 0;
        if (value < part.upper.value && (seeded || value <= tau_)) {
            part.landmark = other;
            part.upper = {value, other.near, other.vertex};
            known = true;
        }
    }
    ++outcome_.counters.bound_tests;
    // The bound includes the distance from the landmark to the farthest corner of the box. So if tau is much smaller
    // than the box, measuring another landmark cannot help.
    const double size = std::sqrt(squared_length(box.high - box.low));
    if (!known || (!seeded && part.upper.value > tau_ && tau_ >= 0.25 * size && !stop_)) {
        const Index source = middle_of(part);
        const Index near = part.landmark.near;
        part.landmark = central_corner(source, box);
        const MeasuredPoint m = measure(part.landmark.at, near, source, 0);
        part.landmark.near = m.triangle;
        part.landmark.distance = std::sqrt(m.squared);
        part.upper.improve(upper());
        if (scene_.partner) scene_.partner[source] = m.triangle;
    }
    if (part.upper.value > tau_)
        outcome_.groups.push_back(part);
    else
        settle(part);
}

}  // namespace hausbench
