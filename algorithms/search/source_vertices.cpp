#include "algorithms/search/source_vertices.h"

#include "algorithms/kernel/watched.h"

namespace hausbench {

Triangle SourceVertices::posed_triangle(Index i) const {
    const auto corners = a_.triangles.row(i);
    return {points_.row(corners[0]), points_.row(corners[1]), points_.row(corners[2])};
}

// First measures the point that was farthest at the previous pose, so that the lower bound is large from the start.
void SourceVertices::begin_warm() {
    WarmStart& last = *warm_start_;
    last.nearest.resize(vertices_.size(), -1);
    if (WATCHED_ELSE("warm start: what was farthest is measured first", last.source < 0, true)) return;
    if (last.corner < 0) {
        const Vec3 point = last.point_in(posed_triangle(last.source));
        bounds_.measure(point, last.target, last.source,
                        WATCHED("warm start: a warm witness is widened", level_of_closest_point));
    } else {
        const Index v = a_.triangles(last.source, last.corner);
        vertices_[static_cast<std::size_t>(v)] = bounds_.measure(points_.row(v), last.target, last.source, 0);
    }
}

// Tries to skip triangle i without a closest point query. An upper bound is its largest distance to a triangle of B
// that was nearest to one of its corners at the previous pose. Distance is convex, so it is largest at a corner.
bool SourceVertices::settle_by_last_pose(Index i) {
    const auto corners = a_.triangles.row(i);
    for (const Index v : corners) {
        const Index nearest = warm_start_->nearest[static_cast<std::size_t>(v)];
        if (nearest < 0) return false;
        const Triangle near = target_.triangle(nearest);
        double most = 0;
        for (const Index other : corners) {
            most = std::max(most, target_.squared_distance(
                                      points_.row(WATCHED_ELSE(
                                          "warm start: each corner counts in the bound by what was nearest", other, v)),
                                      near));
        }
        counters_.point_triangle_distances += 3;
        ++counters_.bound_tests;
        if (leave_out(WATCHED("fields: what a warm start settles has its bound", i),
                      WATCHED_ELSE("warm start: what was nearest bounds a triangle, widened", bounds_.at_most(most, 0),
                                   std::sqrt(most)),
                      nearest))
            return true;
    }
    return false;
}

// Offers each measured vertex to the bounds of all triangles that contain it. measure_triangle() offered it only to the
// first.
void SourceVertices::offer_to_all_triangles() const {
    for (Index i = 0; i < a_.triangles.rows(); ++i) {
        for (const MeasuredPoint& corner : corners(i)) {
            if (corner.triangle >= 0) bounds_.elements()->offer(corner, i, 0);
        }
    }
}

void SourceVertices::use_regions(const TriangleTree& tree, const Pose& pose) {
    regions_.emplace(tree, points_, pose, target_, bounds_, counters_);
}

bool SourceVertices::measure() {
    const bool done = measure_triangles();
    if (WATCHED("fields: a vertex counts for all its triangles", bounds_.elements())) offer_to_all_triangles();
    return done;
}

// Skips triangle i and returns true if `upper` is small enough. No point of the triangle is farther than `upper` from
// triangle `near` of B, which is recorded as the proof if proofs are wanted.
bool SourceVertices::leave_out(Index i, double upper, Index near) {
    if (!bounds_.settle(upper, i, 0, most_levels_)) return false;
    if (WATCHED("proofs: what a vertex or a region leaves out", proofs_))
        proofs_->prove(static_cast<PieceProofs::Node>(i), upper, near);
    settled_[static_cast<std::size_t>(i)] = true;
    return true;
}

// Measures the corners of triangle i, unless hints from the previous pose show that it can be skipped. `near` is a
// triangle of B to start at, or -1. Returns a start for the next triangle of A: the triangle of B nearest to the last
// corner, or `near` if no corner was measured.
Index SourceVertices::measure_triangle(Index i, Index near) {
    if (warm_start_ && settle_by_last_pose(i)) return near;
    const auto vertex = [&](Index v) -> MeasuredPoint& { return vertices_[static_cast<std::size_t>(v)]; };
    for (const Index v : a_.triangles.row(i)) {
        if (vertex(v).triangle >= 0) near = vertex(v).triangle;
    }
    for (const Index v : a_.triangles.row(i)) {
        if (vertex(v).triangle < 0) {
            const Index last = warm_start_ ? warm_start_->nearest[static_cast<std::size_t>(v)] : -1;
            vertex(v) = bounds_.measure(points_.row(v), last >= 0 ? last : near, i, 0);
        }
        near = vertex(v).triangle;
    }
    return near;
}

// Measures one triangle first, even if its region could be skipped, so that there is a witness and a first lower bound.
bool SourceVertices::measure_regions() {
    if (WATCHED("vertices: nothing is measured where regions settle all", true)) measure_triangle(0, -1);
    return regions_->walk([&](Index i, Index near) { measure_triangle(i, near); },
                          [&](Index i, double upper, Index shown) {
                              leave_out(i, WATCHED("vertices: what a region leaves out has no bound", upper), shown);
                          });
}

bool SourceVertices::measure_triangles() {
    vertices_.resize(static_cast<std::size_t>(points_.rows()));
    if (warm_start_ || regions_) settled_.resize(static_cast<std::size_t>(a_.triangles.rows()));
    if (warm_start_) begin_warm();
    if (regions_) return measure_regions();
    Index near = -1;
    for (Index i = 0; i < a_.triangles.rows(); ++i) {
        if (i % 128 == 0 && bounds_.out_of_time()) return false;
        near = measure_triangle(i, near);
    }
    return true;
}

void SourceVertices::remember() const {
    if (!warm_start_) return;
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        if (vertices_[v].triangle >= 0) warm_start_->nearest[v] = vertices_[v].triangle;
    }
    const Farthest& farthest = bounds_.farthest();
    if (farthest.source >= 0) warm_start_->remember(farthest, posed_triangle(farthest.source));
}

}  // namespace hausbench
