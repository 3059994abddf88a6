// What an OffsetCover computes with at one place: polygons, points that they share, and sets of the triangles near.
#pragma once

#include "algorithms/structures/triangle_blocks.h"

#include <array>
#include <bit>
#include <cstdint>

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

}  // namespace hausbench
