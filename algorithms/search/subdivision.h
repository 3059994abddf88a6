// Cuts a triangle into smaller ones that share new vertices, so that each vertex is measured once.
#pragma once

#include "algorithms/kernel/point_triangle.h"

#include <array>
#include <cstddef>

namespace hausbench {

enum class Split {
    midpoint,  // four similar pieces, at the midpoints of the edges; a needle stays a needle
    // Two pieces, at the midpoint of the longest edge; a needle soon becomes compact pieces.
    longest_edge,
};

// At this level a piece is smaller than rounding: four pieces have half the diameter of their parent; two halvings of the longest
// edge divide the diameter by 2, up to a factor of sqrt(3) overall.
constexpr int most_levels(Split split) { return split == Split::midpoint ? 50 : 102; }

// The corners of the triangle (0, 1, 2), then the new vertices, and the pieces as triples of these in the orientation of the
// triangle. The pieces cover the triangle up to the rounding of midpoints (kernel/rounding.h).
template <class Vertex> struct Cut {
    std::array<Vertex, 6> vertices;
    std::size_t vertex_count = 3, piece_count = 0;
    std::array<std::array<std::size_t, 3>, 4> pieces{};

    std::array<Vertex, 3> corners(std::size_t piece) const {
        const auto& corner = pieces[piece];
        return {vertices[corner[0]], vertices[corner[1]], vertices[corner[2]]};
    }
};

// Makes four pieces, with a new vertex on each edge. `Vertex` has a member `point`. `place(one, two)` returns a point of the edge between
// two vertices, and `measure(point, near)` the vertex there; `near` is a neighbour.
template <class Vertex, class Place, class Measure>
Cut<Vertex> cut_in_four(const std::array<Vertex, 3>& corners, const Place& place, const Measure& measure) {
    Cut<Vertex> cut;
    for (std::size_t k = 0; k < 3; ++k) cut.vertices[k] = corners[k];
    for (std::size_t k = 0; k < 3; ++k) {  // 3, 4, 5 are opposite 0, 1, 2
        const Vertex &one = cut.vertices[(k + 1) % 3], &two = cut.vertices[(k + 2) % 3];
        cut.vertices[cut.vertex_count++] = measure(place(one, two), one);
    }
    cut.pieces = {{{0, 5, 4}, {1, 3, 5}, {2, 4, 3}, {3, 4, 5}}};
    cut.piece_count = 4;
    return cut;
}

// Makes four or two pieces, cut at midpoints. Calls `measure` once for each new vertex, in order.
template <class Vertex, class Measure>
Cut<Vertex> cut_triangle(const std::array<Vertex, 3>& corners, Split split, const Measure& measure) {
    const auto midpoint = [](const Vertex& one, const Vertex& two) { return Vec3(0.5 * (one.point + two.point)); };
    if (split == Split::midpoint) return cut_in_four(corners, midpoint, measure);
    Cut<Vertex> cut;
    for (std::size_t k = 0; k < 6; ++k) cut.vertices[k] = corners[k % 3];  // leaves no vertex undefined
    std::size_t opposite = 0;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const double length = squared_length(corners[(k + 1) % 3].point - corners[(k + 2) % 3].point);
        if (length > longest) {
            longest = length;
            opposite = k;
        }
    }
    const std::size_t one = (opposite + 1) % 3, two = (opposite + 2) % 3;
    cut.vertices[cut.vertex_count++] = measure(midpoint(corners[one], corners[two]), corners[one]);
    cut.pieces[0] = {opposite, one, 3};
    cut.pieces[1] = {opposite, 3, two};
    cut.piece_count = 2;
    return cut;
}

}  // namespace hausbench
