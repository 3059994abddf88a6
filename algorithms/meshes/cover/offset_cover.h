// Whether a piece of A lies within a distance of B, shown by covering it with offsets of triangles of B.
//
// The tau-offset of a triangle S, all points within tau of it, is convex, because S is. So a polygon whose corners
// are all within tau of one S is entirely within tau of it. If no S serves all corners, one that serves a run of
// neighbouring corners is taken, and the part that it covers is cut off ("peeled"): the chord goes from the point at
// which the edge before the run leaves the offset to the point at which the edge after it does. If a second triangle
// is near all other corners, and both reach a sample of either edge, the two cover the polygon, cut there. If peeling
// makes no progress, the polygon is cut in two.
//
// A piece may be covered by any triangles, so it does not matter for a proof which are looked at, or where it is cut: only that
// the polygons that are covered make up the piece, and that a distance is never taken for less than it is.
//   - Both sides of a cut have the same two corners there, as rounded. A new corner, x = fl(a + t (b - a)) with |coordinate| <= 1, is
//     within u (2 t |b - a| + |x|) of the point of the edge ab that it stands for: the difference and the product err by u each in proportion
//     to themselves, the sum by u|x|, and |x| <= sqrt(3) < 1.74. That is what its `slack` counts, in units of u, on top of the larger
//     one of those of a and b, which are off their edges themselves. So every point of the piece is within the largest slack of the polygons.
//   - A distance, as computed, to triangle k is at most error(k) too small (structures/triangle_blocks.h), with |p| <= extent.
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

// In coordinates of a place (LocalUnits): |coordinate| <= 1.
template <class T> struct CoverPolygon {
    std::size_t count = 0;
    T x[most_polygon_corners], y[most_polygon_corners], z[most_polygon_corners];
    // Bound of its rounding error, in units of the roundoff of T.
    float slack[most_polygon_corners];

    void add(T px, T py, T pz, float corner_slack) {
        x[count] = px;
        y[count] = py;
        z[count] = pz;
        slack[count++] = corner_slack;
    }
};

// A set of the triangles near a place.
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

// The search that uses the cover, which asks it in double precision.
class CoverHost {
public:
    // The exact distance of a point of the piece is wanted. The host may increase its threshold. Returns a triangle of B that is nearest.
    virtual Index measure(const double (&point)[3], double slack, Index near) = 0;

    // In units of the place.
    virtual double threshold() const = 0;

    // Whether a point at this distance, in units of the place, may increase the threshold much.
    virtual bool promising(double distance) const = 0;

    // Counts one cut. False: time or budget is spent.
    virtual bool go_on() = 0;

protected:
    ~CoverHost() = default;
};

// Covers pieces at one place. Reused from place to place, so that room is made once.
template <class T> struct OffsetCover {
    NearTriangles<T> near;
    double extent = 1.75;  // upper bound of |p| for all points, in units of the place
    double threshold = 0;  // in units of the place
    double early_out = 0;  // likewise: an upper bound that is no larger need not be any smaller
    // Largest computed square that proves distance <= threshold, of each triangle; -1: none.
    std::vector<T> limit;
    std::vector<T> squared;       // rows of as many as `near` has, one a point
    std::vector<NearSet> within;  // of each point: the triangles with a square <= limit
    std::vector<CoverPolygon<T>> stack;
    // Certificate of the current piece; null: not wanted.
    CertificateTree* proof = nullptr;
    std::uint64_t distances = 0, tests = 0, cuts = 0;  // for counters

    static constexpr float most_slack = sizeof(T) == 4 ? 64 : 4096;

    NearTriangles<T> few;  // triangles of `near` that are near a part of a piece, and their limits
    std::vector<T> few_limit;

    T* squares(std::size_t point) { return squared.data() + point * NearTriangles<T>::stride; }

    // In units of the place: no computed distance of a point of a polygon to triangle k is smaller than the exact one by more.
    double error(const NearTriangles<T>& frames, std::size_t k) const {
        const double size = static_cast<double>(frames.row(frame_row::count)[k]);
        return frame_roundoff<T> * (near_error<T> * (extent + size) + most_slack) + frame_underflow<T>;
    }

    // Call it after `near` has changed, or to change the threshold. Triangles that are `within` are not examined
    // again.
    void set_threshold(double tau);
    void make_rows(std::size_t points);
};

struct CoverResult {
    bool covered = false;
    double upper = 0;  // if so: no point of the piece is farther, in units of the place
};

// Rows 0 to count - 1, of points that several pieces share, and their sets. At most most_shared_points. O(points triangles).
void measure_shared(OffsetCover<float>& cover, const CoverPoints<float>& points);

// Returns whether the near triangles cover a piece with these shared points as corners, after at most most_work cuts.
// False proves nothing.
CoverResult cover_shared(OffsetCover<float>& cover, const CoverPolygon<float>& piece,
                         const std::array<std::size_t, 3>& points, std::size_t most_work);

// Always ends, with the threshold of the host as it rises: parts that are too small to be cut, or too many, get a bound that is above it.
// Not covered: so many more triangles are near, as the threshold has risen, that they have to be gathered again.
CoverResult cover_surely(OffsetCover<double>& cover, const CoverPolygon<double>& piece, CoverHost& host,
                         const TriangleMesh& target);

}  // namespace hausbench
