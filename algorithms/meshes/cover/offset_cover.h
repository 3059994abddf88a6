// Shows that a piece of A is within a distance tau of B, by covering the piece with tau-offsets of triangles of B. A
// *piece* is a triangle of A or a part of one.
//
// The tau-offset of a triangle S is the set of all points within tau of S. It is convex, because S is convex. So if all
// corners of a polygon are within tau of one S, the whole polygon is within tau of S: S *covers* the polygon. A piece
// starts as one polygon, and each polygon is treated as follows.
//   1. If one triangle covers the polygon, it is done.
//   2. Otherwise choose a triangle S that is *near* (within tau of) all corners of a *run* of neighbouring corners, and
//      *peel*: cut off the part that S covers. The edges before and after the run leave the offset of S at two points,
//      the *exits*, and the cut goes from one exit to the other. S is near the run and the exits, so it covers the part
//      that is cut off. The remaining polygon is treated in the same way.
//   3. If a second triangle is near all other corners, look at sample points on the two edges. If each edge has a
//      sample that both triangles are near, cut the polygon from one sample to the other: each triangle covers one
//      part, so the polygon is done.
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
#include "algorithms/kernel/watched.h"
#include "algorithms/structures/triangle_blocks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace hausbench::cover {

inline constexpr std::size_t most_polygon_corners = 16;

// A convex polygon cut out of a triangle of A. Coordinates are local: relative to a nearby origin, and scaled so that
// |coordinate| <= 1.
template <class T> struct Polygon {
    std::size_t count = 0;
    T x[most_polygon_corners], y[most_polygon_corners], z[most_polygon_corners];
    // For each corner, an upper bound on the distance by which rounding moved it, as a multiple of the unit roundoff of
    // T.
    float slack[most_polygon_corners];

    void add(T px, T py, T pz, float corner_slack) {
        x[count] = px;
        y[count] = py;
        z[count] = pz;
        slack[count++] = corner_slack;
    }
};

// A set of triangles of B, as bits: bit k stands for triangle k of the NearTriangles in use.
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
    NearSet operator|(const NearSet& other) const {
        NearSet any;
        for (std::size_t w = 0; w < words; ++w) any.word[w] = word[w] | other.word[w];
        return any;
    }
    template <class Call> void for_each(const Call& call) const {
        for (std::size_t w = 0; w < words; ++w) {
            for (std::uint64_t rest = word[w]; rest != 0; rest &= rest - 1)
                call(64 * w + static_cast<std::size_t>(std::countr_zero(rest)));
        }
    }
};

inline constexpr std::size_t no_triangle = static_cast<std::size_t>(-1);

inline constexpr std::size_t most_shared_points = 48;

// The corners of several pieces of A, in local coordinates. Shared corners are stored once, so that their distances to
// B are computed once.
template <class T> struct LocalPoints {
    std::size_t count = 0;
    T x[most_shared_points], y[most_shared_points], z[most_shared_points];
};

// Callbacks from cover_surely() to the search that uses it. All points and lengths are in local coordinates.
class Host {
public:
    // Returns the triangle of B nearest to a point of the piece; tries triangle `near` first. May raise threshold(),
    // because the distance of the point is a lower bound on h(A,B). Rounding may have moved the point by up to `slack`
    // times the unit roundoff.
    virtual Index measure(const double (&point)[3], double slack, Index near) = 0;

    virtual double threshold() const = 0;

    // Returns whether a point at this distance from B should be measured, because that may raise the threshold
    // considerably.
    virtual bool promising(double distance) const = 0;

    // Returns false if the time or the budget is spent. Called before every step.
    virtual bool go_on() = 0;

protected:
    ~Host() = default;
};

// The data to show that neighbouring pieces of A are within a threshold of B: the triangles of B near them, and the
// distances computed so far. Reusing the object avoids allocating its buffers again.
template <class T> struct OffsetCover {
    NearTriangles<T> near;  // the triangles of B that are tried
    // Upper bound on the length of any measured point, in local units.
    double extent = WATCHED_ELSE("offset cover: the extent of local coordinates", 1.75, 0.875);
    double threshold = 0;  // tau, in local units
    // The largest upper bound accepted so far for other pieces, in local units. The final upper bound cannot be
    // smaller, so the first triangle of B that proves a bound of at most this is good enough.
    double early_out = 0;
    // For each triangle of `near`, the largest computed squared distance for which the exact distance is certainly at
    // most the threshold. Negative if rounding errors are too large for that.
    std::vector<T> limit;
    std::vector<T> squared;         // squared distances: a row per point, a column per triangle of `near` or `few`
    std::vector<NearSet> within;    // for each point, the triangles certainly within the threshold
    std::vector<Polygon<T>> stack;  // polygons still to be covered
    // Receives the certificate of the current piece. Null if no certificate is wanted.
    CertificateTree* proof = nullptr;
    std::uint64_t distances = 0, tests = 0, cuts = 0;  // counters of the work done

    // The largest rounding error that a corner may have, in units of Polygon::slack. Cuts that might exceed it are
    // not made.
    static constexpr float most_slack = sizeof(T) == 4 ? 64 : 4096;

    // The triangles of `near` that are close enough to the current polygon to matter, and their limits. Set by
    // Engine::keep_few().
    NearTriangles<T> few;
    std::vector<T> few_limit;

    T* squares(std::size_t point) { return squared.data() + point * NearTriangles<T>::stride; }
    const T* squares(std::size_t point) const { return squared.data() + point * NearTriangles<T>::stride; }

    // Returns an upper bound on the rounding error of the distance from a corner to triangle k, in local units: the
    // exact distance is at most the computed one plus this error.
    double error(const NearTriangles<T>& frames, std::size_t k) const {
        const double size = static_cast<double>(frames.row(frame_row::count)[k]);
        return WATCHED_ELSE(
            "offset cover: the error of a distance",
            frame_roundoff<T> * (near_error<T> * (extent + size) +
                                 WATCHED("offset cover: the slack of corners in the error of a distance", most_slack)) +
                frame_underflow<T>,
            0.0);
    }

    // Sets the threshold, in local units, and computes the limits of all triangles from it. Call it after changing
    // `near`, too. Does not update `within`.
    void set_threshold(double tau);

    // Makes room in `squared` and `within` for this many points.
    void make_rows(std::size_t points);
};

struct CoverResult {
    bool covered = false;
    double upper = 0;  // if covered: upper bound on the distance to B of any point of the piece, in local units
};

// Computes the squared distances from all points to all triangles of cover.near. Point i gets row i of cover.squared
// and entry i of cover.within.
void measure_shared(OffsetCover<float>& cover, const LocalPoints<float>& points);

// Tries to show in single precision that a piece is within the threshold of B, and gives up after most_work polygons.
// Before the call, measure_shared() must have measured the corners of the piece; `points` are their row numbers in
// cover.squared.
CoverResult cover_shared(OffsetCover<float>& cover, const Polygon<float>& piece,
                         const std::array<std::size_t, 3>& points, std::size_t most_work);

// Returns the triangle of B with the least computed distance to the farthest corner of a piece. Returns no_triangle if
// even this distance, less its error, is above the threshold. Takes the arguments of cover_shared().
std::size_t may_cover(const OffsetCover<float>& cover, const std::array<std::size_t, 3>& points);

// Finds an upper bound on the distance from a piece to B in double precision. The host measures points that may be
// beyond the threshold, which may raise the threshold. A part that must not be cut further gets the best bound found
// for it, even one above the threshold. Returns covered == false only if cover.near has no room for another triangle of
// B. Then gather the triangles anew, with the new threshold, and call again.
CoverResult cover_surely(OffsetCover<double>& cover, const Polygon<double>& piece, Host& host,
                         const TriangleMesh& target);

}  // namespace hausbench::cover
