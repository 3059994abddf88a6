// The functions of CoverWorker that work on single pieces of A. cover() handles several pieces at a time, in single
// precision except for a last test; decide() handles one in double precision and always finishes it.
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/cover/batch.h"
#include "algorithms/meshes/cover/worker.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hausbench {

namespace {

constexpr std::size_t most_work_in_float = 48;  // most steps of cover_shared() for one piece
// Limits on the number of triangles of B used for a batch in single precision and for a piece in double precision. If
// more are near, the batch or the piece is halved. They leave room in NearTriangles (256), because gathering adds up to
// 16 triangles at a time, and double precision adds the triangles nearest to measured points.
constexpr std::size_t most_gathered_roughly = 208, most_gathered = 224;
constexpr int most_halvings = 20;  // after so many, decide() accepts the bound that a piece has

Triangle triangle_of(const CoverInput& scene, Index i) {
    const auto v = scene.a.triangles.row(i);
    return {scene.points.row(v[0]), scene.points.row(v[1]), scene.points.row(v[2])};
}

}  // namespace

// Begins to load the vertices of the triangles from this position in the order on, and the corner numbers of later ones.
// Probably the next clusters have them, and they are scattered in memory.
void CoverWorker::fetch_after(std::size_t begin) {
    constexpr std::size_t ahead = 16;
    const std::size_t count = scene_.order.size();
    for (std::size_t i = begin; i < std::min(begin + ahead, count); ++i) {
        if (i + ahead < count) __builtin_prefetch(scene_.a.triangles.row(scene_.order[i + ahead]).data());
        for (const Index corner : scene_.a.triangles.row(scene_.order[i]))
            __builtin_prefetch(scene_.points.row(corner).data());
    }
}

void CoverWorker::cover(const Cluster& cluster) {
    ++outcome_.counters.bound_tests;
    look_at_clock();
    if (cluster.upper.value <= tau_ || stop_) return settle(cluster);
    fetch_after(cluster.begin + cluster.count);
    pieces_.clear();
    for (std::size_t i = cluster.begin; i < cluster.begin + cluster.count; ++i) {
        const Triangle t = triangle_of(scene_, scene_.order[i]);
        pieces_.push_back({{t.a, t.b, t.c}, scene_.order[i], scene_.order[i], cluster.upper, cluster.landmark});
    }
    for (std::size_t i = 0; i < pieces_.size();) {
        const std::size_t count = std::min(batch_, pieces_.size() - i);
        const auto batch = std::span(pieces_).subspan(i, count);
        i += count;
        gathered_ = 0;
        if (crowded_)
            cover_from_own(batch, cluster.landmark);
        else
            cover(batch, cluster.landmark);
        // Adapt the size of the next batch, because neighbouring triangles of A need about as many triangles of B.
        if (gathered_ > most_gathered_roughly)
            batch_ = std::max(count / 2, std::size_t{1});
        else if (gathered_ < most_gathered_roughly / 3)
            batch_ = std::min(2 * batch_, CoverBatch::most_pieces);
    }
    // The nearest triangles of B were not enough for some pieces. Try these again, one by one, with all triangles of B
    // within tau.
    std::vector<CoverPiece> again;
    again.swap(again_);
    for (const CoverPiece& piece : again) cover(std::span(&piece, 1), piece.landmark);
    count();
}

void CoverWorker::cover(std::span<const CoverPiece> pieces, const Landmark& landmark) {
    if (stop_) {
        for (const CoverPiece& piece : pieces) settle(piece);
        return;
    }
    crowded_ = !cover_together(pieces, landmark, pieces.size() == 1);
    if (!crowded_) return;
    if (pieces.size() == 1) {
        for (CoverPiece& half : halve(pieces[0])) {
            if (is_open(half)) cover(std::span<const CoverPiece>(&half, 1), half.landmark);
        }
        return;
    }
    const std::size_t half = pieces.size() / 2;
    cover_from_own(pieces.first(half), landmark);
    cover_from_own(pieces.subspan(half), landmark);
}

// Like cover() above, but for pieces with too many triangles of B near them: measures a corner of one of the pieces
// first, as a new landmark. Far from B this finishes most pieces, because the triangle of B nearest to the landmark is
// then hardly farther from a piece than the rest of B.
void CoverWorker::cover_from_own(std::span<const CoverPiece> pieces, const Landmark& landmark) {
    const CoverPiece& middle = pieces[pieces.size() / 2];
    const MeasuredPoint m = measure(middle.corners[0], landmark.near, middle.source, 0);
    const Landmark own{m.point, std::sqrt(m.squared), m.triangle, scene_.a.triangles(middle.source, 0)};
    double radius = 0;
    for (const CoverPiece& piece : pieces)
        radius = std::max(radius, WATCHED_ELSE("cover: pieces that reach farther than the middle one", piece, middle)
                                      .farthest_corner(m.point));
    const KnownUpper upper{
        WATCHED_ELSE("cover: the rounding of a distance that neighbours share",
                     surface_sum_at_most(own.distance + radius, scene_.magnitude, 0), own.distance + radius),
        own.near, own.vertex};
    std::vector<CoverPiece> open;
    for (CoverPiece piece : pieces) {
        piece.upper.improve(upper);
        if (piece.upper.value > tau_ && !stop_)
            piece.upper.improve(WATCHED_ELSE(
                "cover: the triangle nearest to a corner bounds all corners", by_corners(piece, own.near).upper,
                (KnownUpper{by_corners(piece, own.near).upper.value * (1 - 0x1p-40), own.near, -1})));
        if (piece.upper.value > tau_ && !stop_)
            open.push_back(piece);
        else
            settle(piece);
    }
    if (!open.empty()) cover(open, own);
}

// Gathers the triangles of B near the pieces, and tries to show with them that each piece is within tau of B. Returns
// false, without trying, if there are too many. A piece for which this fails goes to `again_` if a larger radius may
// help, and otherwise to CoverOutcome::undecided. `all_near`: use the largest useful radius at once.
bool CoverWorker::cover_together(std::span<const CoverPiece> pieces, const Landmark& landmark, bool all_near) {
    const CoverBatch batch(pieces, scene_.magnitude);
    // A triangle of B farther than `all` from the batch is not needed: it is farther than tau, or every point of the
    // batch has a nearer triangle. But if tau is large, most of B may be within `all`. So the first try uses only
    // triangles that are not much farther from the batch than B is from the landmark.
    const double all =
        std::min(tau_, landmark.distance + std::sqrt(squared_length(batch.centre - landmark.at)) + batch.radius);
    const double radius = all_near ? all : std::min(all, 1.5 * landmark.distance + 0.15 * batch.radius);
    cover_.near.clear(batch.place);
    cover_.near.most = most_gathered_roughly;
    scene_.blocks.gather(batch.centre, radius + batch.radius, cover_.near, outcome_.counters);
    gathered_ = std::max(gathered_, cover_.near.count());
    const bool by_some = pieces.size() == 1 && pieces[0].level >= halvings_for_all_near;
    if (cover_.near.count() > most_gathered_roughly && !by_some) return false;
    const bool any = cover_.near.count() > 0;
    if (any) {
        cover_.make_rows(most_shared_points + most_polygon_corners + 4);
        cover_.extent = batch.extent();
        cover_.set_threshold(covered_within(tau_, pieces[0].level) * batch.place.inverse);
        cover_.early_out = scene_.elements ? 0 : std::max(settled_before_, outcome_.settled) * batch.place.inverse;
        measure_shared(cover_, batch.points);
    }
    // While all points of A measured so far are on B, up to rounding, A may be a part of B. Then bounds of single precision
    // would be nothing but its errors, so a triangle of B that equals the piece is looked for.
    const bool all_on_b = outcome_.farthest.point.squared <= scene_.least_gap * scene_.least_gap;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const CoverPiece& piece = pieces[i];
        const std::array<std::size_t, 3>& points = batch.of_piece[i];
        CoverResult result;
        if (any) {
            cover_.proof = scene_.proofs ? &scene_.proofs->tree(piece.proof) : nullptr;
            if (WATCHED("cover: a piece that is a triangle of B", all_on_b && is_of_b(piece, points))) continue;
            CoverPolygon<float> polygon;
            for (const std::size_t k : points) polygon.add(batch.points.x[k], batch.points.y[k], batch.points.z[k], 0);
            result = cover_shared(cover_, polygon, points, most_work_in_float);
            if (WATCHED("cover: pieces that single precision cannot tell are tried with one triangle",
                        !result.covered && covered_in_double(piece, points)))
                continue;
        }
        if (result.covered)
            settle(surface_sum_at_most(
                       result.upper * batch.place.unit, scene_.magnitude,
                       WATCHED("cover: halvings of a piece that is covered in single precision", piece.level)),
                   piece.source);
        else
            (radius < all ? again_ : outcome_.undecided).push_back(piece);
    }
    return true;
}

// Settles the piece if a triangle of B has its corners, so that its distance is 0; otherwise returns false. Looks among the
// triangles within the threshold of all corners first, then of any corner, because the errors of single precision may be nearly
// as large as the threshold. `points`: as in cover_shared().
bool CoverWorker::is_of_b(const CoverPiece& piece, const std::array<std::size_t, 3>& points) {
    const NearSet &p = cover_.within[points[0]], &q = cover_.within[points[1]], &r = cover_.within[points[2]];
    return is_one_of(piece, p & q & r) ||
           WATCHED("cover: a triangle of B that single precision finds at one corner only",
                   is_one_of(piece, p | q | r));
}

bool CoverWorker::is_one_of(const CoverPiece& piece, const NearSet& triangles) {
    Index equal = -1;
    triangles.for_each([&](std::size_t k) {
        const Triangle t = scene_.target.triangle(cover_.near.triangle[k]);
        const auto is_corner = [&](const Vec3& corner) { return corner == t.a || corner == t.b || corner == t.c; };
        if (equal < 0 && std::all_of(piece.corners.begin(), piece.corners.end(), is_corner))
            equal = cover_.near.triangle[k];
    });
    if (equal < 0) return false;
    CoverPiece settled = piece;
    settled.upper.improve({surface_distance_at_most(0, scene_.magnitude, piece.level), equal, -1});
    settle(settled);
    return true;
}

// Tries one triangle of B in double precision, the one that seems nearest to the piece. Settles the piece if it is within tau
// of this triangle; otherwise returns false. If the threshold is below the errors of single precision, and A nearly equal
// to B, this settles most pieces. `points`: as in cover_shared().
bool CoverWorker::covered_in_double(const CoverPiece& piece, const std::array<std::size_t, 3>& points) {
    const std::size_t k = may_cover(cover_, points);
    if (k == no_triangle) return false;
    CoverPiece covered = piece;
    covered.upper.improve(by_corners(piece, cover_.near.triangle[k]).upper);
    if (WATCHED("cover: a piece that one triangle covers in double precision is within tau",
                covered.upper.value > tau_))
        return false;
    settle(covered);
    return true;
}

Index CoverWorker::measure(const double (&point)[3], double slack, Index near) {
    const LocalUnits& place = exact_.near.units;
    Vec3 global;
    for (int k = 0; k < 3; ++k) global[k] = place.origin[k] + place.unit * point[k];
    // The level of the point (kernel/rounding.h): it is within 2uM * level of A, where u = 2^-53 and M is the
    // magnitude.
    // - The corners of the piece have level_.
    // - Local errors: the point is within u * slack of the piece with its corners in local coordinates, and rounding
    //   those corners cost less than 2u. Together this is u * (slack + 2) local units, or
    //   (slack + 2) * place.unit / (2M) levels, rounded up.
    // - The sum above rounds by at most sqrt(3) * uM < 2uM: one level. No test can show that this level is needed,
    //   because on every known input it fits into the rounding up of the local errors. But the proof needs it.
    const int own = WATCHED("cover: halvings of the piece that a point is inside of", level_) + 1 +
                    WATCHED("cover: the slack of a point inside a piece",
                            static_cast<int>(std::ceil((slack + 2) * place.unit / (2 * scene_.magnitude))));
    return measure(global, near, source_, WATCHED("cover: the level of a point inside a piece", own)).triangle;
}

// Returns covered_within() in local units, or more if this is too close to the lower bound. The distance of a measured
// point to its nearest triangle must be within the threshold even with rounding errors added. Otherwise the polygon
// there would have to be accepted with a bound above the threshold.
double CoverWorker::threshold() const {
    const double covered = covered_within(tau_, level_) * exact_.near.units.inverse;
    if (within_floor_) return covered;
    double error = 0;
    for (std::size_t k = 0; k < exact_.near.count(); ++k) error = std::max(error, exact_.error(exact_.near, k));
    const double low =
        std::sqrt(std::max(outcome_.farthest.point.squared, 0.0)) +
        WATCHED("cover: the rounding of the lower bound in the threshold", 32 * unit_roundoff * scene_.magnitude);
    return std::max(
        covered, low * exact_.near.units.inverse + WATCHED("cover: the errors of frames in the threshold", 4 * error));
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
    // Start with a corner: measuring it may raise the lower bound and tau, and the triangle of B nearest to it may be
    // near the whole piece.
    CoverPiece measured = piece;
    const MeasuredPoint m = measure(piece.corners[0], piece.landmark.near, piece.source,
                                    WATCHED("cover: halvings of a piece whose corner is measured", piece.level));
    measured.landmark = {m.point, std::sqrt(m.squared), m.triangle, -1};
    measured.upper.improve(by_corners(piece, m.triangle).upper);
    if (measured.upper.value <= tau_ || stop_) return settle(measured);
    if (decide_whole(measured)) return;
    // Too many triangles of B are near, so halve the piece.
    if (piece.level >= most_halvings) return settle(measured);
    for (CoverPiece& half : halve(measured)) {
        if (is_open(half)) decide(half);
    }
}

// Computes an upper bound on the distance of a piece to B and finishes the piece. Returns false, without finishing it,
// if so many triangles of B are near that the piece should be halved.
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
    // Each round uses the triangles of B within the current tau. If it fails, there was no room for another triangle;
    // the next round can only differ if tau has risen.
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
    settle(surface_sum_at_most(result.upper * place.unit, scene_.magnitude,
                               WATCHED("cover: halvings of a piece that is covered in double precision", piece.level)),
           piece.source);
    return true;
}

}  // namespace hausbench
