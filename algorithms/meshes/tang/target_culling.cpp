#include "algorithms/meshes/tang/target_culling.h"

#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/tang/near_walk.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hausbench::tang {

template <class Tree> void TargetCulling<Tree>::bound_by(ListedPiece& piece, Index triangle) {
    const Triangle near = target_.triangle(triangle);
    double most = 0;
    for (const MeasuredPoint& corner : piece.corners) {
        const bool is_nearest = corner.triangle == triangle;
        most = std::max(most, is_nearest ? corner.squared : target_.squared_distance(corner.point, near));
        counters_.point_triangle_distances += is_nearest ? 0 : 1;
    }
    ++counters_.bound_tests;
    const double upper = WATCHED_ELSE("tang: the bound by one triangle of B is widened",
                                      bounds_.at_most(most, piece.level), std::sqrt(most));
    if (upper < piece.upper) {
        piece.upper = upper;
        piece.best = triangle;
    }
}

template <class Tree> void TargetCulling<Tree>::measure_corners(ListedPiece& piece, Index warm) {
    const std::uint64_t before = counters_.point_triangle_distances;
    for (MeasuredPoint& corner : piece.corners) {
        if (corner.triangle < 0) corner = bounds_.measure(corner.point, warm, piece.source, 0);
        warm = corner.triangle;
    }
    for (const MeasuredPoint& corner : piece.corners) bound_by(piece, corner.triangle);
    measured_ += counters_.point_triangle_distances - before;
}

// Calls visit(triangle, squared distances to the three corners) for each triangle of B that may be within
// `search_radius` of the barycentre of a piece. visit() may lower the variable that `search_radius` refers to.
//
// Let r be the largest distance from the barycentre c to a corner. No triangle S within search_radius - r of a point p
// of the piece is missed: p is within r of c, because balls are convex, so d(c, S) <= d(p, S) + r.
template <class Tree>
template <class Visit>
void TargetCulling<Tree>::near_triangles(const ListedPiece& piece, const double& search_radius, const Visit& visit) {
    const std::array<Vec3, 3> points{piece.corners[0].point, piece.corners[1].point, piece.corners[2].point};
    const Vec3 centre = barycentre(piece.corners);
    visit_near_leaves(tree_, centre, search_radius, counters_, [&](std::size_t leaf) {
        double squared[3][leaf_capacity];
        // The factor 1 + 8u, with u = 2^-53, absorbs rounding errors: a computed squared distance exceeds the exact one
        // by at most 5u of it, and the products here lose less than 3u.
        unsigned mask = tree_.leaf_distances(leaf, points, centre,
                                             search_radius * search_radius * (1 + 8 * unit_roundoff), squared);
        for (; mask != 0; mask &= mask - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(mask));
            visit(tree_.tree().leaf(leaf)[i], std::array<double, 3>{squared[0][i], squared[1][i], squared[2][i]});
        }
    });
}

// Returns an upper bound on the distance from the barycentre of a piece to any point of the piece.
template <class Tree> double TargetCulling<Tree>::radius_at_most(const ListedPiece& piece) const {
    const Vec3 centre = barycentre(piece.corners);
    double most = 0;
    for (const MeasuredPoint& corner : piece.corners) most = std::max(most, squared_length(corner.point - centre));
    return distance_at_most(most, true) + slack(piece.level);
}

template <class Tree> void TargetCulling<Tree>::cull(ListedPiece& piece) {
    const double radius = radius_at_most(piece);
    const auto was_measured =
        std::array{piece.corners[0].triangle >= 0, piece.corners[1].triangle >= 0, piece.corners[2].triangle >= 0};
    double search_radius = WATCHED_ELSE("tang: a walk goes as far as the piece is large", next_up(piece.upper + radius),
                                        piece.upper),
           least = std::numeric_limits<double>::infinity();
    near_.clear();
    std::uint64_t tested = 0;
    near_triangles(piece, search_radius, [&](Index triangle, const std::array<double, 3>& squared) {
        ++tested;
        double most = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            MeasuredPoint& corner = piece.corners[k];
            most = std::max(most, squared[k]);
            if (was_measured[k]) continue;
            if (corner.triangle < 0 || squared[k] < corner.squared ||
                (squared[k] == corner.squared && triangle < corner.triangle)) {
                corner.squared = squared[k];
                corner.triangle = triangle;
            }
        }
        if (near_.size() <= most_near) near_.push_back({triangle, squared});
        if (!(most < least)) return;
        least = most;
        const double upper = WATCHED_ELSE("tang: culling on B widens the upper bound",
                                          bounds_.at_most(least, piece.level), std::sqrt(least));
        if (upper < piece.upper) {
            piece.upper = upper;
            piece.best = triangle;
        }
        search_radius = WATCHED_ELSE("tang: a walk goes on as far as the piece is large", next_up(piece.upper + radius),
                                     piece.upper);
    });
    piece.crowd = tested;
    counters_.point_triangle_distances += 3 * tested;
    counters_.bound_tests += tested;
    if (piece.depth == 0) measured_ += tested;
    for (std::size_t k = 0; k < 3; ++k) {
        if (!was_measured[k]) bounds_.offer(piece.corners[k], piece.source, piece.level);
    }
}

template <class Tree> void TargetCulling<Tree>::list(ListedPiece& piece) {
    const auto& v = piece.corners;
    std::array<double, 3> squared_edge{}, most{};
    for (std::size_t k = 0; k < 3; ++k) squared_edge[k] = squared_length(v[(k + 1) % 3].point - v[(k + 2) % 3].point);
    for (std::size_t k = 0; k < 3; ++k) {
        const double edge = std::sqrt(std::max(squared_edge[(k + 1) % 3], squared_edge[(k + 2) % 3]));
        const double search_radius = WATCHED_ELSE("tang: a list keeps what is near to all corners",
                                                  (piece.upper + edge) * (1 + 8 * unit_roundoff), piece.upper) +
                                     slack(piece.level);
        most[k] = search_radius * search_radius;
    }
    std::array<Index, most_listed> kept;
    std::size_t count = 0;
    if (near_.size() > most_near) return;
    for (const NearTriangle& candidate : near_) {
        if (candidate.squared[0] > most[0] || candidate.squared[1] > most[1] || candidate.squared[2] > most[2])
            continue;
        if (count == most_listed) return;
        kept[count++] = candidate.triangle;
    }
    piece.list = lists_.store(std::span(kept).first(count));
}

// Sets candidates_ to the list of the piece. If the piece has no list, uses the triangle that gave its upper bound and
// the triangles nearest to the vertices of the cut instead.
template <class Tree>
void TargetCulling<Tree>::find_candidates(const ListedPiece& piece, const Cut<MeasuredPoint>& cut) {
    candidates_.count = 0;
    for (const Index triangle : lists_.numbers(piece.list)) candidates_.add(triangle);
    if (candidates_.count > 0) return;
    candidates_.add(piece.best);
    for (std::size_t v = 0; v < cut.vertex_count; ++v) {
        const auto end = candidates_.triangle.begin() + static_cast<std::ptrdiff_t>(candidates_.count);
        if (std::find(candidates_.triangle.begin(), end, cut.vertices[v].triangle) == end)
            candidates_.add(cut.vertices[v].triangle);
    }
}

template <class Tree> void TargetCulling<Tree>::measure(const ListedPiece& piece, Cut<MeasuredPoint>& cut) {
    find_candidates(piece, cut);
    lists_.give_back(piece.list);
    PointBlock block;
    for (std::size_t lane = 0; lane < block_width; ++lane) {
        const Vec3& point = cut.vertices[std::min(lane, cut.vertex_count - 1)].point;
        for (int k = 0; k < 3; ++k) block.coordinate[k][lane] = point[k];
    }
    std::array<bool, 6> open{};
    for (std::size_t v = 0; v < cut.vertex_count; ++v) open[v] = cut.vertices[v].triangle < 0;
    for (std::size_t s = 0; s < candidates_.count; ++s) {
        const Index triangle = candidates_.triangle[s];
        target_.squared_distances(block, cut.vertex_count, target_.triangle(triangle), candidates_.feet[s]);
        for (std::size_t v = 3; v < cut.vertex_count; ++v) {
            MeasuredPoint& vertex = cut.vertices[v];
            const double squared = candidates_.feet[s].squared_distance[v];
            if (open[v] && (s == 0 || squared < vertex.squared)) vertex = {vertex.point, squared, triangle};
        }
    }
    counters_.point_triangle_distances += candidates_.count * cut.vertex_count;
    counters_.bound_tests += candidates_.count * cut.piece_count;
}

template <class Tree>
ListedPiece TargetCulling<Tree>::part(const ListedPiece& piece, const Cut<MeasuredPoint>& cut, std::size_t c,
                                      int level) {
    ListedPiece part{cut.corners(c), piece.upper,     piece.source, piece.best,
                     level,          piece.depth + 1, {},           piece.crowd / cut.piece_count};
    const auto& v = cut.pieces[c];
    near_.clear();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < candidates_.count; ++s) {
        const double* squared = candidates_.feet[s].squared_distance;
        near_.push_back({candidates_.triangle[s], {squared[v[0]], squared[v[1]], squared[v[2]]}});
        const double most = std::max({squared[v[0]], squared[v[1]], squared[v[2]]});
        if (most < least) {
            least = most;
            part.best = candidates_.triangle[s];
        }
    }
    part.upper =
        std::min(part.upper, bounds_.at_most(least, WATCHED("tang: a part's bound is widened by its level", level)));
    return part;
}

template class TargetCulling<SweptSphereBvh>;
template class TargetCulling<TriangleBvh>;

}  // namespace hausbench::tang
