#include "cover_worker.h"

#include "kernel/posed_box.h"
#include "kernel/rounding.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

namespace hausbench {

namespace {

constexpr std::size_t batch_triangles =
    8;  // covered together: their corners and the triangles of B near them are shared
constexpr std::size_t most_work_in_float = 48;  // cuts of one triangle
constexpr std::size_t most_gathered = 208;      // triangles of B, less than fit; with more, what is covered is halved
constexpr std::size_t most_gathered_exact = 224;
constexpr int most_halvings = 20;  // of a triangle
constexpr int enough_halvings =
    8;  // from so many on, a piece is covered by some of the triangles near it, if there are too many
constexpr std::size_t most_looked_at = 32;  // on either side of the middle of a group, for a partner
constexpr std::size_t most_spare_rooms = 4;
constexpr double least_unit = 0x1p-100;  // of a place, as a part of the magnitude

// Of this thread, given back and not in use.
std::vector<std::unique_ptr<CoverRoom::Covers>>& spare_rooms() {
    thread_local std::vector<std::unique_ptr<CoverRoom::Covers>> rooms;
    return rooms;
}

Triangle triangle_of(const CoverScene& scene, Index i) {
    const auto v = scene.a.triangles.row(i);
    return {scene.points.row(v[0]), scene.points.row(v[1]), scene.points.row(v[2])};
}

double farthest_corner(const CoverPiece& piece, const Vec3& from) {
    double squared = 0;
    for (const Vec3& corner : piece.corners) squared = std::max(squared, squared_length(corner - from));
    return std::sqrt(squared);
}

// The edge from this corner to the next one is the longest.
std::size_t longest_edge(const CoverPiece& piece) {
    std::size_t longest = 0;
    double most = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const double squared = squared_length(piece.corners[(k + 1) % 3] - piece.corners[k]);
        if (squared > most) most = squared, longest = k;
    }
    return longest;
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
    // All else is set before it is read.
    covers_->rough.proof = covers_->exact.proof = nullptr;
    covers_->rough.distances = covers_->rough.tests = covers_->rough.cuts = 0;
    covers_->exact.distances = covers_->exact.tests = covers_->exact.cuts = 0;
}

CoverRoom::~CoverRoom() {
    if (!covers_ || spare_rooms().size() >= most_spare_rooms) return;
    covers_->rough.stack.clear();
    covers_->exact.stack.clear();
    spare_rooms().push_back(std::move(covers_));
}

// --- bookkeeping ------------------------------------------------------------------------------------------------------

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
    batch_ = batch_triangles;
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
        if (squared > bound.squared) bound.squared = squared, bound.farthest = k;
    }
    outcome_.counters.point_triangle_distances += 3;
    bound.upper = {surface_distance_at_most(bound.squared, scene_.magnitude, piece.level), near, -1};
    return bound;
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

// What a cover may show of a piece of this level for its upper bound, once widened, to be no more than tau.
double CoverWorker::covered_within(int level) const {
    return std::max(tau_ * (1 - 8 * unit_roundoff) - (10 + 2 * level) * unit_roundoff * scene_.magnitude, 0.0);
}

// --- groups -----------------------------------------------------------------------------------------------------------

// No point of the box is farther from B than `at` is, and the way there.
double CoverWorker::around(const Vec3& at, double distance, const Box& box) const {
    return surface_sum_at_most(distance + std::sqrt(squared_distance_at_most(at, box)), scene_.magnitude, 0);
}

// A corner of one of a group's triangles that has a partner, and its distance to that: to B it is no larger. Those in the middle are
// looked at first: their corners are measured where nothing is known.
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
            landmark.distance = std::sqrt(scene_.target.squared_distance(landmark.at, scene_.target.triangle(near)));
            return true;
        }
    }
    return false;
}

// The corner of a triangle that the box is least around.
Landmark CoverWorker::central_corner(Index source, const Box& box) const {
    Landmark landmark;
    double least = std::numeric_limits<double>::infinity();
    for (const Index v : scene_.a.triangles.row(source)) {
        const Vec3 corner = scene_.points.row(v);
        const double far = squared_distance_at_most(corner, box);
        if (far < least) least = far, landmark.at = corner, landmark.vertex = v;
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
    // A query is worth its cost only where tau is not far below the size of the group.
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

// --- covers in single precision ---------------------------------------------------------------------------------------

void CoverWorker::cover(const Cluster& cluster) {
    ++outcome_.counters.bound_tests;
    look_at_clock();
    if (cluster.upper.value <= tau_ || stop_) return settle(cluster);
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
        // Neighbours need about as many triangles of B.
        if (gathered_ > most_gathered)
            batch_ = std::max(count / 2, std::size_t{1});
        else if (gathered_ < most_gathered / 3)
            batch_ = std::min(2 * batch_, batch_triangles);
    }
    // Each alone, and everything near it.
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
    if (pieces.size() == 1) return halve_piece(pieces[0]);
    const std::size_t half = pieces.size() / 2;
    cover_from_own(pieces.first(half), landmark);
    cover_from_own(pieces.subspan(half), landmark);
}

// Where too many triangles of B are near, the pieces get a landmark of their own. Far from B it settles most: what is nearest to one of
// them is near all.
void CoverWorker::cover_from_own(std::span<const CoverPiece> pieces, const Landmark& landmark) {
    const CoverPiece& middle = pieces[pieces.size() / 2];
    const MeasuredPoint m = measure(middle.corners[0], landmark.near, middle.source, 0);
    const Landmark own{m.point, std::sqrt(m.squared), m.triangle, scene_.a.triangles(middle.source, 0)};
    double radius = 0;
    for (const CoverPiece& piece : pieces) radius = std::max(radius, farthest_corner(piece, m.point));
    const KnownUpper upper{surface_sum_at_most(own.distance + radius, scene_.magnitude, 0), own.near, own.vertex};
    std::vector<CoverPiece> rest;
    for (CoverPiece piece : pieces) {
        piece.upper.improve(upper);
        if (piece.upper.value > tau_ && !stop_) piece.upper.improve(by_corners(piece, own.near).upper);
        if (piece.upper.value > tau_ && !stop_)
            rest.push_back(piece);
        else
            settle(piece);
    }
    if (!rest.empty()) cover(rest, own);
}

void CoverWorker::halve_piece(const CoverPiece& piece) {
    halve(piece, [&](const CoverPiece& part) { cover(std::span(&part, 1), part.landmark); });
}

// At the midpoint of its longest edge, which is measured. Calls part(half) for what this does not settle.
template <class Part> void CoverWorker::halve(const CoverPiece& piece, const Part& part) {
    const std::size_t a = longest_edge(piece), b = (a + 1) % 3, c = (a + 2) % 3;
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
    for (std::size_t i = 0; i < 2; ++i) {
        CoverPiece half{i == 0 ? first : second, piece.source, proofs[i], piece.upper, landmark, level};
        const CornerBound bound = by_corners(half, m.triangle);
        half.upper.improve(bound.upper);
        // The corner that seems to be farthest from B may raise tau, where the piece is large beside its distance.
        if (half.upper.value > tau_ && !stop_ && bound.squared > tau_ * tau_)
            measure(half.corners[bound.farthest], m.triangle, half.source, half.level);
        if (half.upper.value <= tau_ || stop_)
            settle(half);
        else
            part(half);
    }
}

namespace {

// The corners of some pieces, each once, in coordinates of a place around them.
struct Batch {
    std::array<Vec3, 3 * batch_triangles> corner;
    std::array<std::array<std::size_t, 3>, batch_triangles> of_piece;
    CoverPoints<float> points;
    LocalUnits place;
    Vec3 centre;
    double radius = 0;  // around it

    Batch(std::span<const CoverPiece> pieces, double magnitude) {
        Box box;
        std::array<std::uint8_t, slots> number{};  // of the corner that is in a slot, and one more; 0 for none
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3& at = pieces[i].corners[k];
                std::size_t slot = slot_of(at);
                while (number[slot] != 0 && corner[number[slot] - 1U] != at) slot = (slot + 1) % slots;
                if (number[slot] == 0) {
                    corner[points.count++] = at;
                    number[slot] = static_cast<std::uint8_t>(points.count);
                    box.add(at);
                }
                of_piece[i][k] = number[slot] - 1U;
            }
        }
        place.set(box, magnitude * least_unit);
        centre = Vec3(place.origin[0], place.origin[1], place.origin[2]);
        for (std::size_t i = 0; i < points.count; ++i) {
            const Vec3 local = corner[i] - centre;
            radius = std::max(radius, squared_length(local));
            points.x[i] = static_cast<float>(local[0] * place.inverse);
            points.y[i] = static_cast<float>(local[1] * place.inverse);
            points.z[i] = static_cast<float>(local[2] * place.inverse);
        }
        radius = std::sqrt(radius);
    }

private:
    static constexpr std::size_t slots = 64;  // more than twice as many as there are corners

    // The same for the same bits.
    static std::size_t slot_of(const Vec3& at) {
        std::uint64_t mixed = 0;
        for (const double x : at) mixed = (mixed ^ std::bit_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15;
        return mixed >> 58;
    }
};

}  // namespace

// False: too many triangles of B are near. What cannot be covered by those nearest is kept to be covered again, or is undecided.
bool CoverWorker::cover_together(std::span<const CoverPiece> pieces, const Landmark& landmark, bool all_near) {
    const Batch batch(pieces, scene_.magnitude);
    // All triangles that may cover a part, unless tau is so large that it would be most of B: then those near the surface.
    const double all =
        std::min(tau_, landmark.distance + std::sqrt(squared_length(batch.centre - landmark.at)) + batch.radius);
    const double radius = all_near ? all : std::min(all, 1.5 * landmark.distance + 0.15 * batch.radius);
    cover_.near.clear(batch.place);
    cover_.near.most = most_gathered;
    scene_.blocks.gather(batch.centre, radius + batch.radius, cover_.near, outcome_.counters);
    gathered_ = std::max(gathered_, cover_.near.count());
    const bool whatever = pieces.size() == 1 && pieces[0].level >= enough_halvings;
    if (cover_.near.count() > most_gathered && !whatever) return false;
    const bool any = cover_.near.count() > 0;
    if (any) {
        cover_.make_rows(most_shared_points + most_polygon_corners + 4);
        cover_.reach = batch.radius * batch.place.inverse * (1 + 0x1p-10);
        cover_.set_threshold(covered_within(pieces[0].level) * batch.place.inverse);
        cover_.enough = scene_.elements ? 0 : std::max(settled_before_, outcome_.settled) * batch.place.inverse;
        measure_shared(cover_, batch.points);
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const CoverPiece& piece = pieces[i];
        CoverResult result;
        if (any) {
            CoverPolygon<float> polygon;
            for (const std::size_t k : batch.of_piece[i])
                polygon.add(batch.points.x[k], batch.points.y[k], batch.points.z[k], 0);
            cover_.proof = scene_.proofs ? &scene_.proofs->tree(piece.proof) : nullptr;
            result = cover_shared(cover_, polygon, batch.of_piece[i], most_work_in_float);
        }
        if (result.covered)
            settle(surface_sum_at_most(result.upper * batch.place.unit, scene_.magnitude, piece.level), piece.source);
        else if (radius < all)
            again_.push_back(piece);
        else
            outcome_.undecided.push_back(piece);
    }
    return true;
}

// --- what is left -----------------------------------------------------------------------------------------------------

Index CoverWorker::measure(const double (&point)[3], double slack, Index near) {
    const LocalUnits& place = exact_.near.units;
    Vec3 global;
    for (int k = 0; k < 3; ++k) global[k] = place.origin[k] + place.unit * point[k];
    // Within u slack of the piece's corners as moved to the place, which took 2u, in units of the place; rounding the sum takes less than
    // 2uM. A level stands for 2uM.
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
    // A corner first: it may raise tau, and what is nearest to it may be near all of the piece.
    CoverPiece measured = piece;
    const MeasuredPoint m = measure(piece.corners[0], piece.landmark.near, piece.source, piece.level);
    measured.landmark = {m.point, std::sqrt(m.squared), m.triangle, -1};
    measured.upper.improve(by_corners(piece, m.triangle).upper);
    if (measured.upper.value <= tau_ || stop_) return settle(measured);
    if (decide_whole(measured, piece.level >= enough_halvings)) return;
    // Too many triangles of B are near.
    if (piece.level >= most_halvings) return settle(measured);
    halve(measured, [&](const CoverPiece& part) { decide(part); });
}

// False: so many triangles of B are near that the piece had better be halved. `whatever`: some of them are tried all the same.
bool CoverWorker::decide_whole(const CoverPiece& piece, bool whatever) {
    Box box;
    for (const Vec3& corner : piece.corners) box.add(corner);
    LocalUnits place;
    place.set(box, scene_.magnitude * least_unit);
    const Vec3 centre(place.origin[0], place.origin[1], place.origin[2]);
    const double radius = farthest_corner(piece, centre);
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
        cover_.near.most = most_gathered_exact;
        scene_.blocks.gather(centre, std::min(tau_, far + radius) + radius, cover_.near, outcome_.counters);
        std::vector<Index> triangles = cover_.near.triangle;
        if (triangles.size() > most_gathered_exact) {
            if (!whatever) return false;
            triangles.resize(most_gathered_exact);
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
