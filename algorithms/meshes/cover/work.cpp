#include "algorithms/meshes/cover/work.h"

#include "algorithms/kernel/posed_box.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/cover/batch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace hausbench::cover {

namespace {

constexpr std::size_t most_spare_buffers = 4;
constexpr std::size_t most_looked_at = 32;  // triangles tried by from_partner() on either side of the middle of a group

// This thread's pool of returned scratch buffers.
std::vector<std::unique_ptr<Buffers::Covers>>& spare_buffers() {
    thread_local std::vector<std::unique_ptr<Buffers::Covers>> buffers;
    return buffers;
}

constexpr std::size_t most_work_in_float = 48;  // most steps of cover_shared() for one piece
// Limits on the number of triangles of B used for a batch in single precision and for a piece in double precision. If
// more are near, the batch or the piece is halved. They leave room in NearTriangles (256), because gathering adds up to
// 16 triangles at a time, and double precision adds the triangles nearest to measured points.
constexpr std::size_t most_gathered_roughly = 208, most_gathered = 224;
constexpr int most_halvings = 20;  // after so many, decide() accepts the bound that a piece has

Triangle triangle_of(const Input& scene, Index i) {
    const auto v = scene.a.triangles.row(i);
    return {scene.points.row(v[0]), scene.points.row(v[1]), scene.points.row(v[2])};
}

}  // namespace

Buffers::Buffers() {
    auto& spare = spare_buffers();
    if (spare.empty()) {
        covers_ = std::make_unique<Covers>();
        return;
    }
    covers_ = std::move(spare.back());
    spare.pop_back();
    // Resets these members; all others are set before they are read.
    covers_->rough.proof = covers_->exact.proof = nullptr;
    covers_->rough.distances = covers_->rough.tests = covers_->rough.cuts =
        WATCHED_ELSE("cover: counts of an earlier solve in buffers that are used again", 0, 7);
    covers_->exact.distances = covers_->exact.tests = covers_->exact.cuts = 0;
}

Buffers::~Buffers() {
    if (!covers_ || spare_buffers().size() >= most_spare_buffers) return;
    covers_->rough.stack.clear();
    covers_->exact.stack.clear();
    spare_buffers().push_back(std::move(covers_));
}

void Work::begin(const Farthest& farthest, double settled, std::uint64_t budget, bool stopped,
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
    batch_ = Batch::most_pieces;
    crowded_ = false;
    set_tau();
}

Outcome Work::finish() {
    count();
    return std::move(outcome_);
}

void Work::set_tau() {
    const double low = std::sqrt(std::max(outcome_.farthest.point.squared, 0.0));
    const Query& query = scene_.query;
    // A query with floor = cutoff only asks whether h(A,B) is above this value. Its answer needs no tolerance, so tau
    // is the floor. That ends once a point is measured that is as far as the cutoff up to rounding: no bound of its
    // piece will be at most the cutoff. A point that is clearly farther may still answer the question, but without a
    // gap above the point, pieces of the same distance would be cut until they are as small as the rounding errors.
    const bool asks = query.is_question();
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

MeasuredPoint Work::measure(const Vec3& point, Index near, Index source, int level) {
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

void Work::look_at_clock() {
    if (!stop_ && deadline_->passed()) stop_ = Status::time_limit;
}

void Work::settle(double upper, Index source) {
    outcome_.settled = std::max(outcome_.settled, upper);
    if (scene_.elements) scene_.elements->settle(upper, source);
}

void Work::settle(const Piece& piece) {
    settle(piece.upper.value, piece.source);
    if (!scene_.proofs) return;
    CertificateTree& tree = scene_.proofs->tree(piece.proof);
    if (piece.upper.vertex >= 0)
        tree.vertex(piece.upper.vertex, piece.upper.near);
    else
        tree.one(piece.upper.near);
}

void Work::settle(const Cluster& cluster) {
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
Work::CornerBound Work::by_corners(const Piece& piece, Index near) {
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
std::array<Piece, 2> Work::halve(const Piece& piece) {
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
bool Work::is_open(Piece& half) {
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
void Work::count() {
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
double Work::covered_within(double tau, int level) const {
    return std::max(tau * (1 - 8 * unit_roundoff) - (WATCHED("cover: the widening in what a cover may show", 10) +
                                                     WATCHED("cover: halvings in what a cover may show", 2 * level)) *
                                                        unit_roundoff * scene_.magnitude,
                    0.0);
}

// Returns an upper bound on the distance to B of any point of the box: the distance of the point `at` to B, plus the
// distance from `at` to the farthest corner of the box.
double Work::around(const Vec3& at, double distance, const Box& box) const {
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
bool Work::from_partner(const Cluster& group, const Box& box, Landmark& landmark) {
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
Landmark Work::central_corner(Index source, const Box& box) const {
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

void Work::narrow(const Cluster& group, const Box& box) {
    Cluster part = group;
    bool has_landmark = group.landmark.near >= 0, seeded = false;
    const auto upper = [&] {
        return KnownUpper{around(part.landmark.at, part.landmark.distance, box), part.landmark.near,
                          part.landmark.vertex};
    };
    if (has_landmark) part.upper.improve(upper());
    if (Landmark other; part.upper.value > tau_ && from_partner(part, box, other)) {
        const double value = around(other.at, other.distance, box);
        seeded = scene_.partner[middle_of(part)] >= 0;
        if (value < part.upper.value && (seeded || value <= tau_)) {
            part.landmark = other;
            part.upper = {value, other.near, other.vertex};
            has_landmark = true;
        }
    }
    ++outcome_.counters.bound_tests;
    // The bound includes the distance from the landmark to the farthest corner of the box. So if tau is much smaller
    // than the box, measuring another landmark cannot help.
    const double size = std::sqrt(squared_length(box.high - box.low));
    if (!has_landmark || (!seeded && part.upper.value > tau_ && tau_ >= 0.25 * size && !stop_)) {
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

// --- single pieces of A: cover() handles several pieces at a time, in single precision except for a last test; decide()
// handles one in double precision and always finishes it

// Begins to load the vertices of the triangles from this position in the order on, and the corner numbers of later ones.
// Probably the next clusters have them, and they are scattered in memory.
void Work::fetch_after(std::size_t begin) {
    constexpr std::size_t ahead = 16;
    const std::size_t count = scene_.order.size();
    for (std::size_t i = begin; i < std::min(begin + ahead, count); ++i) {
        if (i + ahead < count) __builtin_prefetch(scene_.a.triangles.row(scene_.order[i + ahead]).data());
        for (const Index corner : scene_.a.triangles.row(scene_.order[i]))
            __builtin_prefetch(scene_.points.row(corner).data());
    }
}

void Work::cover(const Cluster& cluster) {
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
            batch_ = std::min(2 * batch_, Batch::most_pieces);
    }
    // The nearest triangles of B were not enough for some pieces. Try these again, one by one, with all triangles of B
    // within tau.
    std::vector<Piece> again;
    again.swap(again_);
    for (const Piece& piece : again) cover(std::span(&piece, 1), piece.landmark);
    count();
}

void Work::cover(std::span<const Piece> pieces, const Landmark& landmark) {
    if (stop_) {
        for (const Piece& piece : pieces) settle(piece);
        return;
    }
    crowded_ = !cover_together(pieces, landmark, pieces.size() == 1);
    if (!crowded_) return;
    if (pieces.size() == 1) {
        for (Piece& half : halve(pieces[0])) {
            if (is_open(half)) cover(std::span<const Piece>(&half, 1), half.landmark);
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
void Work::cover_from_own(std::span<const Piece> pieces, const Landmark& landmark) {
    const Piece& middle = pieces[pieces.size() / 2];
    const MeasuredPoint m = measure(middle.corners[0], landmark.near, middle.source, 0);
    const Landmark corner{m.point, std::sqrt(m.squared), m.triangle, scene_.a.triangles(middle.source, 0)};
    double radius = 0;
    for (const Piece& piece : pieces)
        radius = std::max(radius, WATCHED_ELSE("cover: pieces that reach farther than the middle one", piece, middle)
                                      .farthest_corner(m.point));
    const KnownUpper upper{
        WATCHED_ELSE("cover: the rounding of a distance that neighbours share",
                     surface_sum_at_most(corner.distance + radius, scene_.magnitude, 0), corner.distance + radius),
        corner.near, corner.vertex};
    std::vector<Piece> open;
    for (Piece piece : pieces) {
        piece.upper.improve(upper);
        if (piece.upper.value > tau_ && !stop_)
            piece.upper.improve(WATCHED_ELSE(
                "cover: the triangle nearest to a corner bounds all corners", by_corners(piece, corner.near).upper,
                (KnownUpper{by_corners(piece, corner.near).upper.value * (1 - 0x1p-40), corner.near, -1})));
        if (piece.upper.value > tau_ && !stop_)
            open.push_back(piece);
        else
            settle(piece);
    }
    if (!open.empty()) cover(open, corner);
}

// Gathers the triangles of B near the pieces, and tries to show with them that each piece is within tau of B. Returns
// false, without trying, if there are too many. A piece for which this fails goes to `again_` if a larger radius may
// help, and otherwise to Outcome::undecided. `all_near`: use the largest useful radius at once.
bool Work::cover_together(std::span<const Piece> pieces, const Landmark& landmark, bool all_near) {
    const Batch batch(pieces, scene_.magnitude);
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
        const Piece& piece = pieces[i];
        const std::array<std::size_t, 3>& points = batch.of_piece[i];
        CoverResult result;
        if (any) {
            cover_.proof = scene_.proofs ? &scene_.proofs->tree(piece.proof) : nullptr;
            if (WATCHED("cover: a piece that is a triangle of B", all_on_b && is_of_b(piece, points))) continue;
            Polygon<float> polygon;
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
bool Work::is_of_b(const Piece& piece, const std::array<std::size_t, 3>& points) {
    const NearSet &p = cover_.within[points[0]], &q = cover_.within[points[1]], &r = cover_.within[points[2]];
    return is_one_of(piece, p & q & r) ||
           WATCHED("cover: a triangle of B that single precision finds at one corner only",
                   is_one_of(piece, p | q | r));
}

bool Work::is_one_of(const Piece& piece, const NearSet& triangles) {
    Index equal = -1;
    triangles.for_each([&](std::size_t k) {
        const Triangle t = scene_.target.triangle(cover_.near.triangle[k]);
        const auto is_corner = [&](const Vec3& corner) { return corner == t.a || corner == t.b || corner == t.c; };
        if (equal < 0 && std::all_of(piece.corners.begin(), piece.corners.end(), is_corner))
            equal = cover_.near.triangle[k];
    });
    if (equal < 0) return false;
    Piece settled = piece;
    settled.upper.improve({surface_distance_at_most(0, scene_.magnitude, piece.level), equal, -1});
    settle(settled);
    return true;
}

// Tries one triangle of B in double precision, the one that seems nearest to the piece. Settles the piece if it is within tau
// of this triangle; otherwise returns false. If the threshold is below the errors of single precision, and A nearly equal
// to B, this settles most pieces. `points`: as in cover_shared().
bool Work::covered_in_double(const Piece& piece, const std::array<std::size_t, 3>& points) {
    const std::size_t k = may_cover(cover_, points);
    if (k == no_triangle) return false;
    Piece covered = piece;
    covered.upper.improve(by_corners(piece, cover_.near.triangle[k]).upper);
    if (WATCHED("cover: a piece that one triangle covers in double precision is within tau",
                covered.upper.value > tau_))
        return false;
    settle(covered);
    return true;
}

Index Work::measure(const double (&point)[3], double slack, Index near) {
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
    const int point_level = WATCHED("cover: halvings of the piece that a point is inside of", level_) + 1 +
                            WATCHED("cover: the slack of a point inside a piece",
                                    static_cast<int>(std::ceil((slack + 2) * place.unit / (2 * scene_.magnitude))));
    return measure(global, near, source_, WATCHED("cover: the level of a point inside a piece", point_level)).triangle;
}

// Returns covered_within() in local units, or more if this is too close to the lower bound. The distance of a measured
// point to its nearest triangle must be within the threshold even with rounding errors added. Otherwise the polygon
// there would have to be accepted with a bound above the threshold.
double Work::threshold() const {
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

bool Work::promising(double distance) const {
    const double low = std::sqrt(std::max(outcome_.farthest.point.squared, 0.0)) * exact_.near.units.inverse;
    return distance > low + 0.2 * std::max(exact_.threshold - low, 0.0);
}

bool Work::go_on() {
    if (stop_) return false;
    count();
    if (outcome_.counters.subdivisions >= budget_) stop_ = Status::budget;
    if (outcome_.counters.subdivisions % 64 == 0) look_at_clock();
    return !stop_;
}

void Work::decide(const Piece& piece) {
    ++outcome_.counters.bound_tests;
    if (piece.upper.value <= tau_ || stop_) return settle(piece);
    // Start with a corner: measuring it may raise the lower bound and tau, and the triangle of B nearest to it may be
    // near the whole piece.
    Piece measured = piece;
    const MeasuredPoint m = measure(piece.corners[0], piece.landmark.near, piece.source,
                                    WATCHED("cover: halvings of a piece whose corner is measured", piece.level));
    measured.landmark = {m.point, std::sqrt(m.squared), m.triangle, -1};
    measured.upper.improve(by_corners(piece, m.triangle).upper);
    if (measured.upper.value <= tau_ || stop_) return settle(measured);
    if (decide_whole(measured)) return;
    // Too many triangles of B are near, so halve the piece.
    if (piece.level >= most_halvings) return settle(measured);
    for (Piece& half : halve(measured)) {
        if (is_open(half)) decide(half);
    }
}

// Computes an upper bound on the distance of a piece to B and finishes the piece. Returns false, without finishing it,
// if so many triangles of B are near that the piece should be halved.
bool Work::decide_whole(const Piece& piece) {
    Box box;
    for (const Vec3& corner : piece.corners) box.add(corner);
    LocalUnits place;
    place.set(box, scene_.magnitude * least_place);
    const Vec3 centre(place.origin[0], place.origin[1], place.origin[2]);
    const double radius = piece.farthest_corner(centre);
    const double far = piece.landmark.distance + std::sqrt(squared_length(centre - piece.landmark.at));
    source_ = piece.source;
    level_ = piece.level;
    Polygon<double> polygon;
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

}  // namespace hausbench::cover
