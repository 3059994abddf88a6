// Shows that a piece of A lies within a distance of B by covering it with offsets of triangles of B.
//
// The tau-offset of a triangle S, the set of points within tau of it, is convex because S is. So a polygon whose
// corners are all within tau of one S lies within tau of S. If no S is near all corners, we take one that is near a
// run of neighbouring corners and cut off ("peel") the part that it covers: the chord goes from the exit of the edge
// before the run to the exit of the edge after it, the points at which these edges leave the offset. If a second
// triangle is near all other corners, and both triangles reach a common sample on each of the two edges, they cover
// the polygon when it is cut at these samples. If peeling makes no progress, the polygon is cut in two.
//
// A piece may be covered by any triangles. The proof does not depend on which triangles are tried or where a piece is
// cut. It needs only that the covered polygons make up the piece and that no distance is underestimated.
//   - Both sides of a cut share the two new corners, as rounded. A new corner, x = fl(a + t (b - a)) with
//     |coordinate| <= 1, is within u (2 t |b - a| + |x|) of the point of the edge ab that it stands for: the
//     difference and the product each have a relative error of u, the sum errs by u|x|, and |x| <= sqrt(3) < 1.74.
//     The `slack` of a corner counts this error in units of u, on top of the larger slack of a and b, which may be
//     off their edges themselves. So every point of the piece is within the largest slack of one of the polygons.
//   - The computed distance to triangle k is at most error(k) too small (structures/triangle_blocks.h), for |p| <=
//     extent.
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

// A polygon in coordinates of a place (LocalUnits): |coordinate| <= 1.
template <class T> struct CoverPolygon {
    std::size_t count = 0;
    T x[most_polygon_corners], y[most_polygon_corners], z[most_polygon_corners];
    // Bounds of the rounding errors of the corners, in units of the roundoff of T.
    float slack[most_polygon_corners];

    void add(T px, T py, T pz, float corner_slack) {
        x[count] = px;
        y[count] = py;
        z[count] = pz;
        slack[count++] = corner_slack;
    }
};

// A set of triangles near a place.
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

template <class T> struct CoverPoints {
    std::size_t count = 0;
    T x[most_shared_points], y[most_shared_points], z[most_shared_points];
};

// The search that a cover in double precision calls back.
class CoverHost {
public:
    // Measures the exact distance of a point of the piece, which may raise the threshold. Returns a nearest triangle
    // of B.
    virtual Index measure(const double (&point)[3], double slack, Index near) = 0;

    // Returns the threshold in units of the place.
    virtual double threshold() const = 0;

    // Returns whether a point at this distance, in units of the place, may raise the threshold much.
    virtual bool promising(double distance) const = 0;

    // Counts one cut. Returns false if time or budget is spent.
    virtual bool go_on() = 0;

protected:
    ~CoverHost() = default;
};

// Covers pieces at one place. Reuse it from place to place to keep its buffers.
template <class T> struct OffsetCover {
    NearTriangles<T> near;
    double extent = 1.75;  // upper bound of |p| over all points, in units of the place
    double threshold = 0;  // in units of the place
    double early_out = 0;  // in units of the place: an upper bound up to this is good enough
    // For each triangle, the largest computed square that proves distance <= threshold; -1: none does.
    std::vector<T> limit;
    std::vector<T> squared;       // one row per point, one column per triangle of `near`
    std::vector<NearSet> within;  // for each point, the triangles with a square <= limit
    std::vector<CoverPolygon<T>> stack;
    // Certificate of the current piece; null if none is wanted.
    CertificateTree* proof = nullptr;
    std::uint64_t distances = 0, tests = 0, cuts = 0;  // for the counters

    static constexpr float most_slack = sizeof(T) == 4 ? 64 : 4096;

    NearTriangles<T> few;  // the triangles of `near` that are near a part of a piece, and their limits
    std::vector<T> few_limit;

    T* squares(std::size_t point) { return squared.data() + point * NearTriangles<T>::stride; }

    // Returns, in units of the place, how much smaller than the exact one a computed distance to triangle k can be.
    double error(const NearTriangles<T>& frames, std::size_t k) const {
        const double size = static_cast<double>(frames.row(frame_row::count)[k]);
        return frame_roundoff<T> * (near_error<T> * (extent + size) + most_slack) + frame_underflow<T>;
    }

    // Call it after changing `near` or to change the threshold. It does not update `within`.
    void set_threshold(double tau);
    void make_rows(std::size_t points);
};

struct CoverResult {
    bool covered = false;
    double upper = 0;  // if covered: bounds the distance of all points of the piece, in units of the place
};

// Measures points that several pieces share into rows 0 to count - 1, with their sets; at most most_shared_points.
// O(points triangles).
void measure_shared(OffsetCover<float>& cover, const CoverPoints<float>& points);

// Tries to cover a piece whose corners are these shared points, with at most most_work cuts. A failure proves
// nothing.
CoverResult cover_shared(OffsetCover<float>& cover, const CoverPolygon<float>& piece,
                         const std::array<std::size_t, 3>& points, std::size_t most_work);

// Covers a piece. It always ends: the threshold follows the host's as it rises, and parts that are too small or too
// many to be cut further get a bound above it. Returns `covered == false` if the risen threshold brings so many more
// triangles near that they must be gathered again.
CoverResult cover_surely(OffsetCover<double>& cover, const CoverPolygon<double>& piece, CoverHost& host,
                         const TriangleMesh& target);

}  // namespace hausbench
