// Shows that a piece of A is within a distance tau of B, by covering the piece with tau-offsets of triangles of B. A
// *piece* is a triangle of A or a part of one.
//
// The tau-offset of a triangle S is the set of all points within tau of S. It is convex, because S is convex. So if all
// corners of a polygon are within tau of one S, the whole polygon is within tau of S: S *covers* the polygon. A piece
// starts as one polygon, and each polygon is treated as follows.
//   1. If one triangle covers the polygon, it is done.
//   2. Otherwise choose a triangle S that is *near* (within tau of) each corner of a run of neighbouring corners, and
//      *peel*: cut off the part that S covers. The edge before the run leaves the offset of S at some point, and so
//      does the edge after the run. These two points are the *exits*, and the cut goes from one to the other. S is near
//      the run and the exits, so it covers the part that is cut off. The remaining polygon is treated in the same way.
//   3. If a second triangle is near all other corners, look at sample points on the two edges. If each edge has a
//      sample that both triangles are near, cut the polygon from one sample to the other: the first triangle covers
//      one part and the second triangle covers the other part, so the polygon is done.
//   4. If peeling makes no progress, cut the polygon in two.
//
// Only the *gathered* triangles are tried: the triangles of B around the piece, which the caller has collected in
// NearTriangles. The proof does not depend on which triangles are tried or where a polygon is cut. It needs only that
// the covered polygons together make up the piece, and that no distance is underestimated.
//
// Rounding. u is the unit roundoff of T: 2^-24 for float, 2^-53 for double. All coordinates are *local*: relative to an
// origin near the piece, in a unit so large that |coordinate| <= 1 in the piece (LocalUnits in
// structures/triangle_blocks.h). Lengths in this unit are "in local units".
//   - Corners. Both sides of a cut share its two new corners, as rounded, so no gap opens between them. A new corner
//     on the edge ab is x = fl(a + t * (b - a)). The difference and the product each have a relative error of u, and
//     the sum errs by u * |x|. So x is within u * (2 * t * |b - a| + |x|) of the exact point of ab, where
//     |x| <= sqrt(3) < 1.74. As a and b may be off their own exact positions, too, the `slack` of x is
//     2 * t * |b - a| + |x| plus the larger slack of a and b. Slack is counted in units of u. Every exact point of the
//     piece is then within u * (the largest slack) of a point of one of the polygons.
//   - Distances. If |p| <= extent, the computed distance from p to triangle k is smaller than the exact one by at most
//     error(k). The error of the distance itself is derived in structures/triangle_blocks.h; error(k) adds the largest
//     slack.
#pragma once

#include "algorithms/certificate/cover_certificate.h"
#include "algorithms/structures/triangle_blocks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace hausbench {

inline constexpr std::size_t most_polygon_corners = 16;

// A convex polygon in local coordinates, |coordinate| <= 1.
template <class T> struct CoverPolygon {
    std::size_t count = 0;
    T x[most_polygon_corners], y[most_polygon_corners], z[most_polygon_corners];
    // For each corner, an upper bound on its distance from the exact point that it stands for, in units of u.
    float slack[most_polygon_corners];

    void add(T px, T py, T pz, float corner_slack) {
        x[count] = px;
        y[count] = py;
        z[count] = pz;
        slack[count++] = corner_slack;
    }
};

// A set of gathered triangles: bit k stands for triangle k of NearTriangles.
struct NearSet {
    static constexpr std::size_t words = NearTriangles<float>::most_triangles / 64;
    std::array<std::uint64_t, words> word{};

    bool has(std::size_t k) const { return word[k / 64] >> (k % 64) & 1; }
    bool empty() const { return (word[0] | word[1] | word[2] | word[3]) == 0; }
    std::size_t size() const {
        int bits = 0;
        for (const std::uint64_t w : word) bits += std::popcount(w);
        return static_cast<std::size_t>(bits);
    }
    NearSet operator&(const NearSet& other) const {
        NearSet both;
        for (std::size_t w = 0; w < words; ++w) both.word[w] = word[w] & other.word[w];
        return both;
    }
    template <class Call> void for_each(const Call& call) const {
        for (std::size_t w = 0; w < words; ++w) {
            for (std::uint64_t rest = word[w]; rest != 0; rest &= rest - 1)
                call(64 * w + static_cast<std::size_t>(std::countr_zero(rest)));
        }
    }
};

inline constexpr std::size_t most_shared_points = 48;

// Corners of several pieces, in local coordinates. Neighbouring pieces share corners, and each is measured once.
template <class T> struct CoverPoints {
    std::size_t count = 0;
    T x[most_shared_points], y[most_shared_points], z[most_shared_points];
};

// The functions of a search that cover_surely() calls back. Points and lengths are local.
class CoverHost {
public:
    // Measures the distance from a point of the piece to all of B, not only to the gathered triangles. This may raise
    // the threshold. The point may be off the piece by `slack`, in units of u. `near` is a triangle of B to try first.
    // Returns the triangle of B nearest to the point.
    virtual Index measure(const double (&point)[3], double slack, Index near) = 0;

    // Returns the present threshold tau.
    virtual double threshold() const = 0;

    // Returns whether it is worth measuring a point at this distance, because it may raise the threshold much.
    virtual bool promising(double distance) const = 0;

    // Called before every step. Returns false if time or budget is spent.
    virtual bool go_on() = 0;

protected:
    ~CoverHost() = default;
};

// The data for covering the pieces around one local origin: the gathered triangles of B, the threshold, and the
// distances measured so far. Reuse the object for the next origin, so that its buffers are not allocated again.
template <class T> struct OffsetCover {
    NearTriangles<T> near;  // the gathered triangles of B
    double extent = 1.75;   // upper bound on |p| over all measured points p, in local units
    double threshold = 0;   // tau, in local units
    // The largest upper bound that the search has recorded elsewhere, in local units. The final upper bound cannot be
    // less, so if one triangle proves a bound of at most this, no triangle with a smaller bound is looked for.
    double early_out = 0;
    // For each triangle, the largest computed squared distance that proves distance <= threshold; -1: none does.
    std::vector<T> limit;
    std::vector<T> squared;              // squared distances: one row per point, one column per triangle of `near`
    std::vector<NearSet> within;         // for each point, the triangles whose squared distance is at most their limit
    std::vector<CoverPolygon<T>> stack;  // polygons still to be covered
    // Certificate of the current piece; null if none is wanted.
    CertificateTree* proof = nullptr;
    std::uint64_t distances = 0, tests = 0, cuts = 0;  // work done, for the counters of the search

    // The largest slack of a corner. A cut that might make a corner with more is not made.
    static constexpr float most_slack = sizeof(T) == 4 ? 64 : 4096;

    // The triangles of `near` that can still cover a part of the present polygon, and their limits
    // (Engine::keep_few()).
    NearTriangles<T> few;
    std::vector<T> few_limit;

    T* squares(std::size_t point) { return squared.data() + point * NearTriangles<T>::stride; }

    // Returns, in local units, the most by which the computed distance from a corner to triangle k can be less than the
    // distance from the exact point that the corner stands for.
    double error(const NearTriangles<T>& frames, std::size_t k) const {
        const double size = static_cast<double>(frames.row(frame_row::count)[k]);
        return frame_roundoff<T> * (near_error<T> * (extent + size) + most_slack) + frame_underflow<T>;
    }

    // Sets the threshold, in local units, and the limits of all triangles. Call it after changing `near`, too. It does
    // not update `within`.
    void set_threshold(double tau);

    // Makes room in `squared` and `within` for this many points.
    void make_rows(std::size_t points);
};

struct CoverResult {
    bool covered = false;
    double upper = 0;  // if covered: upper bound on the distance of every point of the piece to B, in local units
};

// Measures all points. Point i fills row i of `squared` and entry i of `within`. Takes O(points * triangles).
void measure_shared(OffsetCover<float>& cover, const CoverPoints<float>& points);

// Tries to cover a piece in single precision, in at most most_work steps (a step covers, peels or cuts one polygon).
// measure_shared() must have measured its corners; `points` are their indices. A failure proves nothing: the piece may
// still be within tau.
CoverResult cover_shared(OffsetCover<float>& cover, const CoverPolygon<float>& piece,
                         const std::array<std::size_t, 3>& points, std::size_t most_work);

// Covers a piece in double precision. It always ends: measured points raise the threshold of the host, and a part that
// is too small to be cut further, or that comes when the stack is full, gets the bound that it has, even if this is
// above the threshold. Returns `covered == false` if the triangle nearest to a measured point must join `near`, which
// has no room left. The host should then gather the triangles anew, with its new threshold.
CoverResult cover_surely(OffsetCover<double>& cover, const CoverPolygon<double>& piece, CoverHost& host,
                         const TriangleMesh& target);

}  // namespace hausbench
