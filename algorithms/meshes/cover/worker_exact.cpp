// Covers in double precision, which always end.
#include "algorithms/kernel/rounding.h"
#include "algorithms/meshes/cover/worker.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hausbench {
namespace {

constexpr std::size_t most_gathered = 224;  // triangles of B, less than fit
constexpr int most_halvings = 20;           // of a triangle

}  // namespace

Index CoverWorker::measure(const double (&point)[3], double slack, Index near) {
    const LocalUnits& place = exact_.near.units;
    Vec3 global;
    for (int k = 0; k < 3; ++k) global[k] = place.origin[k] + place.unit * point[k];
    // Within u slack of the piece's corners as moved to the place, which took 2u, in units of the place; rounding the sum takes less than
    // 2uM. A level stands for 2uM. No input is known that needs the level of the sum: its rounding is at most sqrt(3) uM, and the slack is
    // rounded up to whole levels. So no test can need it, but the proof does.
    const int own = level_ + 1 + static_cast<int>(std::ceil((slack + 2) * place.unit / (2 * scene_.magnitude)));
    return measure(global, near, source_, own).triangle;
}

// At least so far above the lower bound that what is nearest to a point that was measured is near enough, as computed: else a cover would not
// end. The error grows with the triangles that are near, not with the meshes, so what is far away spoils nothing here.
double CoverWorker::threshold() const {
    const double covered = covered_within(level_) * exact_.near.units.inverse;
    if (scene_.query.floor >= scene_.query.cutoff) return covered;
    double error = 0;
    for (std::size_t k = 0; k < exact_.near.count(); ++k) error = std::max(error, exact_.error(exact_.near, k));
    const double low =
        std::sqrt(std::max(outcome_.farthest.point.squared, 0.0)) + 32 * unit_roundoff * scene_.magnitude;
    return std::max(covered, low * exact_.near.units.inverse + 4 * error);
}

bool CoverWorker::promising(double distance) const {
    const double low = std::sqrt(std::max(outcome_.farthest.point.squared, 0.0)) * exact_.near.units.inverse;
    return distance > low + 0.2 * std::max(exact_.threshold - low, 0.0);
}

bool CoverWorker::go_on() {
    if (stop_) return false;
    count();
    if (outcome_.counters.subdivisions >= budget_) stop_ = Status::budget;
    if (outcome_.counters.subdivisions % 64 == 0) look_at_clock();
    return !stop_;
}

void CoverWorker::decide(const CoverPiece& piece) {
    ++outcome_.counters.bound_tests;
    if (piece.upper.value <= tau_ || stop_) return settle(piece);
    // A corner first: it may update the lower bound, and tau with it, and what is nearest to it may be near all of the piece.
    CoverPiece measured = piece;
    const MeasuredPoint m = measure(piece.corners[0], piece.landmark.near, piece.source, piece.level);
    measured.landmark = {m.point, std::sqrt(m.squared), m.triangle, -1};
    measured.upper.improve(by_corners(piece, m.triangle).upper);
    if (measured.upper.value <= tau_ || stop_) return settle(measured);
    if (decide_whole(measured)) return;
    // Too many triangles of B are near.
    if (piece.level >= most_halvings) return settle(measured);
    for (CoverPiece& half : halve(measured)) {
        if (is_open(half)) decide(half);
    }
}

// False: so many triangles of B are near that the piece had better be halved.
bool CoverWorker::decide_whole(const CoverPiece& piece) {
    Box box;
    for (const Vec3& corner : piece.corners) box.add(corner);
    LocalUnits place;
    place.set(box, scene_.magnitude * least_place);
    const Vec3 centre(place.origin[0], place.origin[1], place.origin[2]);
    const double radius = piece.farthest_corner(centre);
    const double far = piece.landmark.distance + std::sqrt(squared_length(centre - piece.landmark.at));
    source_ = piece.source;
    level_ = piece.level;
    CoverPolygon<double> polygon;
    for (const Vec3& corner : piece.corners) {
        const Vec3 local = (corner - centre) * place.inverse;
        polygon.add(local[0], local[1], local[2], 0);
    }
    CoverResult result;
    for (double before = -1; !result.covered;) {
        if (tau_ == before) return false;
        before = tau_;
        cover_.near.clear(place);
        cover_.near.most = most_gathered;
        scene_.blocks.gather(centre, std::min(tau_, far + radius) + radius, cover_.near, outcome_.counters);
        std::vector<Index> triangles = cover_.near.triangle;
        if (triangles.size() > most_gathered) {
            if (piece.level < halvings_for_all_near) return false;
            triangles.resize(most_gathered);
        }
        if (triangles.empty()) triangles.push_back(piece.landmark.near);
        exact_.near.clear(place);
        set_frames(scene_.target.mesh(), triangles, exact_.near);
        exact_.set_threshold(threshold());
        exact_.proof = scene_.proofs ? &scene_.proofs->tree(piece.proof) : nullptr;
        result = cover_surely(exact_, polygon, *this, scene_.target.mesh());
    }
    count();
    settle(surface_sum_at_most(result.upper * place.unit, scene_.magnitude, piece.level), piece.source);
    return true;
}

}  // namespace hausbench
