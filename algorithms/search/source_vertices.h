// The first step of searches over triangles of A: measures each vertex of A once, that is, computes its distance to B.
#pragma once

#include "algorithms/search/bounds.h"
#include "algorithms/search/piece_proofs.h"
#include "algorithms/search/source_regions.h"
#include "algorithms/search/warm_start.h"

#include <array>
#include <vector>

namespace hausbench {

// The distances of the vertices of A, and the triangles of A that need no further work after this step.
class SourceVertices {
public:
    // Keeps references. `points` are the vertices of A, moved by its pose; `warm_start` is null for a cold start;
    // `most_levels` as in SearchBounds::settle.
    SourceVertices(const TriangleMesh& a, const Points& points, const Target& target, WarmStart* warm_start,
                   int most_levels, SearchBounds& bounds, Counters& counters)
        : a_(a),
          points_(points),
          target_(target),
          warm_start_(warm_start),
          most_levels_(most_levels),
          bounds_(bounds),
          counters_(counters) {}

    // Makes measure() skip groups of triangles of A that cannot contain the farthest point (source_regions.h). `tree`
    // is over A in its own coordinates, and `pose` is the pose of A.
    void use_regions(const TriangleTree& tree, const Pose& pose);

    // Makes measure() record a proof for each triangle of A that it skips.
    void use_proofs(PieceProofs& proofs) { proofs_ = &proofs; }

    // Measures the vertices, triangle by triangle, and offers each to the bounds. Returns false if time runs out.
    // - To be fast, the query of a vertex starts at the triangle of B nearest to the vertex before it or, with a warm
    //   start, at the triangle of B nearest to the same vertex at the previous pose.
    // - A triangle of A is skipped if a bound settles it (bounds.h): with a warm start, its distance to the triangle of
    //   B that was nearest to one of its corners at the previous pose; with regions, the bound of its region. Vertices
    //   that belong only to skipped triangles are not measured.
    // - If the bounds of each triangle are kept (ElementBounds), a vertex is offered to every triangle
    //   that contains it.
    bool measure();

    // Returns whether triangle i of A was skipped; the search bounds then have its upper bound. Call
    // it after measure().
    bool settled(Index i) const { return !settled_.empty() && settled_[static_cast<std::size_t>(i)]; }

    // Returns the corners of triangle i. If the triangle was skipped, only corners that other triangles needed are
    // measured; for the others, MeasuredPoint::triangle is -1.
    std::array<MeasuredPoint, 3> corners(Index i) const {
        const auto v = [&](int k) { return vertices_[static_cast<std::size_t>(a_.triangles(i, k))]; };
        return {v(0), v(1), v(2)};
    }

    // Saves hints for the next pose when the search is over.
    void remember() const;

private:
    void begin_warm();
    bool measure_triangles();
    bool measure_regions();
    Index measure_triangle(Index i, Index near);
    bool leave_out(Index i, double upper, Index near);
    void offer_to_all_triangles() const;
    bool settle_by_last_pose(Index i);
    Triangle posed_triangle(Index i) const;

    const TriangleMesh& a_;
    const Points& points_;
    const Target& target_;
    WarmStart* warm_start_;
    int most_levels_;
    SearchBounds& bounds_;
    Counters& counters_;
    std::vector<MeasuredPoint> vertices_;
    std::vector<bool> settled_;  // by triangle of A; empty if there is neither a warm start nor regions
    std::optional<SourceRegions> regions_;
    PieceProofs* proofs_ = nullptr;  // set only if a certificate is wanted
};

}  // namespace hausbench
