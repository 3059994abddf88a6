// The first step of searches over triangles of A: measures each vertex of A once.
#pragma once

#include "algorithms/search/bounds.h"
#include "algorithms/search/piece_proofs.h"
#include "algorithms/search/source_regions.h"
#include "algorithms/search/warm_start.h"

#include <array>
#include <vector>

namespace hausbench {

class SourceVertices {
public:
    // Keeps references. `points` are the posed vertices of A; `warm_start` is null for a cold start.
    SourceVertices(const TriangleMesh& a, const Points& points, const Target& target, WarmStart* warm_start,
                   int most_levels, SearchBounds& bounds, Counters& counters)
        : a_(a),
          points_(points),
          target_(target),
          warm_start_(warm_start),
          most_levels_(most_levels),
          bounds_(bounds),
          counters_(counters) {}

    // Skips groups of triangles of A that cannot hold the farthest point from now on. `tree` is over A, unposed.
    void use_regions(const TriangleTree& tree, const Pose& pose);

    // Records proofs for skipped triangles from now on.
    void use_proofs(PieceProofs& proofs) { proofs_ = &proofs; }

    // Measures the vertices triangle by triangle and offers each to the bounds. A query begins at the triangle of B
    // nearest to the previous vertex or, with a warm start, at the one that was nearest at the previous pose.
    // Triangles of A are left out if distances to these triangles, or the regions, settle them. If the bounds of
    // each triangle are kept, a vertex is offered to all its triangles. Returns false if time runs out.
    bool measure();

    // Returns whether triangle i of A was skipped with its bound kept. Call it after measure().
    bool settled(Index i) const { return !settled_.empty() && settled_[static_cast<std::size_t>(i)]; }

    // Returns the corners of a triangle. If the triangle was left out, corners that no other triangle needed are
    // not measured.
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
    std::vector<bool> settled_;  // triangles of A; empty without a warm start and regions
    std::optional<SourceRegions> regions_;
    PieceProofs* proofs_ = nullptr;  // set only if a certificate is wanted
};

}  // namespace hausbench
