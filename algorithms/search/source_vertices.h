// The first step of searches over triangles of A: computes the distance from each vertex of A to B, once per vertex.
#pragma once

#include "algorithms/search/bounds.h"
#include "algorithms/search/piece_proofs.h"
#include "algorithms/search/source_regions.h"
#include "algorithms/search/warm_start.h"

#include <array>
#include <vector>

namespace hausbench {

// The distances from the vertices of A to B, and the triangles of A that need no further work.
class SourceVertices {
public:
    // Keeps references. `points` are the vertices of A, moved by its pose. `warm_start` holds hints from an earlier
    // pose, or is null. `most_levels` is passed to SearchBounds::settle().
    SourceVertices(const TriangleMesh& a, const Points& points, const Target& target, WarmStart* warm_start,
                   int most_levels, SearchBounds& bounds, Counters& counters)
        : a_(a),
          points_(points),
          target_(target),
          warm_start_(warm_start),
          most_levels_(most_levels),
          bounds_(bounds),
          counters_(counters) {}

    // Makes measure() skip groups of triangles of A that cannot contain the point farthest from B (source_regions.h).
    // `tree` is over A in its own coordinates.
    void use_regions(const TriangleTree& tree, const Pose& pose);

    // Makes measure() record a proof of the upper bound of each triangle of A that it skips.
    void use_proofs(PieceProofs& proofs) { proofs_ = &proofs; }

    // Computes the distances of the vertices, triangle by triangle, and passes each to SearchBounds::offer(). Returns
    // false if time runs out.
    // - Each query starts at the triangle of B nearest to the previous vertex or, with a warm start, to the same vertex
    //   at the previous pose.
    // - A triangle of A is skipped if an upper bound is small enough. With a warm start, this is its distance to a
    //   triangle of B that was nearest to one of its corners; with regions, the bound of its region. Vertices that
    //   belong only to skipped triangles are not measured.
    // - With ElementBounds, a vertex is offered to every triangle that contains it.
    bool measure();

    // Returns whether measure() skipped triangle i of A. The search bounds then include its upper bound.
    bool settled(Index i) const { return !settled_.empty() && settled_[static_cast<std::size_t>(i)]; }

    // Returns the corners of triangle i. Some corners of a skipped triangle may not be measured; their
    // MeasuredPoint::triangle is -1.
    std::array<MeasuredPoint, 3> corners(Index i) const {
        const auto v = [&](int k) { return vertices_[static_cast<std::size_t>(a_.triangles(i, k))]; };
        return {v(0), v(1), v(2)};
    }

    // Saves the nearest triangles and the farthest point of a finished search as hints for the next pose.
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
    std::vector<bool> settled_;  // by triangle of A; empty if nothing allows to skip triangles
    std::optional<SourceRegions> regions_;
    PieceProofs* proofs_ = nullptr;  // set only if a certificate is wanted
};

}  // namespace hausbench
