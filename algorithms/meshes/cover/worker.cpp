#include "algorithms/meshes/cover/worker.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/meshes/cover/batch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hausbench {

double CoverPiece::farthest_corner(const Vec3& from) const {
    double squared = 0;
    for (const Vec3& corner : corners) squared = std::max(squared, squared_length(corner - from));
    return std::sqrt(squared);
}

std::size_t CoverPiece::longest_edge() const {
    std::size_t longest = 0;
    double most = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const double squared = squared_length(corners[(k + 1) % 3] - corners[k]);
        if (squared > most) {
            most = squared;
            longest = k;
        }
    }
    return longest;
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
    // "Is h above d?" has floor = cutoff = d, and the tolerance ends nothing.
    const bool asks = query.floor >= query.cutoff;
    tau_ = std::max(asks ? low : low + std::max(0.9 * query.tolerance.gap(low), scene_.least_gap), query.floor);
    // Ends the search once the distance is above the cutoff. The margin exceeds what certifying the witness takes away; if it did not,
    // the status would be `stalled`, since only the certified bound can answer the question.
    if (!stop_ && low - 4096 * unit_roundoff * scene_.magnitude > query.cutoff) stop_ = Status::stalled;
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

// The distance to a triangle is convex.
CoverWorker::CornerBound CoverWorker::by_corners(const CoverPiece& piece, Index near) {
    CornerBound bound;
    for (std::size_t k = 0; k < 3; ++k) {
        const double squared = scene_.target.squared_distance(piece.corners[k], scene_.target.triangle(near));
        if (squared > bound.squared) {
            bound.squared = squared;
            bound.farthest = k;
        }
    }
    outcome_.counters.point_triangle_distances += 3;
    bound.upper = {surface_distance_at_most(bound.squared, scene_.magnitude, piece.level), near, -1};
    return bound;
}

// At the midpoint of its longest edge, which is measured. The halves have the bound of the whole.
std::array<CoverPiece, 2> CoverWorker::halve(const CoverPiece& piece) {
    const std::size_t a = piece.longest_edge(), b = (a + 1) % 3, c = (a + 2) % 3;
    const Vec3 middle = 0.5 * (piece.corners[a] + piece.corners[b]);
    const int level = piece.level + 1;
    ++outcome_.counters.subdivisions;
    if (outcome_.counters.subdivisions >= budget_ && !stop_) stop_ = Status::budget;
    if (scene_.elements) scene_.elements->subdivided(piece.source, level);
    const MeasuredPoint m = measure(middle, piece.landmark.near, piece.source, level);
    std::array<Index, 2> proofs{};
    if (scene_.proofs) proofs = scene_.proofs->halve(piece.proof, CutPoint::along(a, 0.5), CutPoint::corner(c));
    const Landmark landmark{middle, std::sqrt(m.squared), m.triangle, -1};
    const std::array<Vec3, 3> first{middle, piece.corners[b], piece.corners[c]},
        second{piece.corners[c], piece.corners[a], middle};
    return {{{first, piece.source, proofs[0], piece.upper, landmark, level},
             {second, piece.source, proofs[1], piece.upper, landmark, level}}};
}

// Whether the distances of its corners to what is nearest to the midpoint do not settle a half.
bool CoverWorker::is_open(CoverPiece& half) {
    const Index near = half.landmark.near;
    const CornerBound bound = by_corners(half, near);
    half.upper.improve(bound.upper);
    // The corner that seems to be farthest from B may update the lower bound, and tau with it, where the piece is large beside its distance.
    if (half.upper.value > tau_ && !stop_ && bound.squared > tau_ * tau_)
        measure(half.corners[bound.farthest], near, half.source, half.level);
    if (half.upper.value > tau_ && !stop_) return true;
    settle(half);
    return false;
}

// Work of the covers so far, for the counters.
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

// Returns how far from B a cover may show a piece of this level to be, so that its upper bound, once widened, is no more than tau.
//
// Covers are widened as measured distances are (surface_sum_at_most): by 8uM, and by 2uM for each level. They need only what the level stands for. The
// bound of a cover counts all its own roundings, and moving A and B to the place is one of these (meshes/cover/offset_cover.h). The 8uM stay
// because they are below every tolerance that can be met, and without them the last bits of all answers would change.
double CoverWorker::covered_within(int level) const {
    return std::max(tau_ * (1 - 8 * unit_roundoff) - (10 + 2 * level) * unit_roundoff * scene_.magnitude, 0.0);
}

}  // namespace hausbench
