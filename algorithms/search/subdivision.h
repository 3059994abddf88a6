// Cuts a triangle into two or four smaller ones, its pieces. Pieces share their new vertices, so a solver computes the
// distance from each new vertex to B only once.
#pragma once

#include "algorithms/kernel/point_triangle.h"
#include "algorithms/kernel/watched.h"

#include <array>
#include <cstddef>

namespace hausbench {

enum class Split {
    // Four pieces, cut at the midpoints of all edges. They are similar to the triangle, so a thin triangle stays thin.
    midpoint,
    // Two pieces, cut at the midpoint of the longest edge. A few such cuts turn a thin triangle into compact pieces.
    longest_edge,
};

// Returns the number of subdivisions after which further cuts are pointless, because a piece is then smaller than the
// rounding errors of its corners. Let u = 2^-53, and M be the largest |coordinate|. At first the diameter is at most
// 2 sqrt(3) M. Split::midpoint halves it each time, so after 50 times it is at most 28uM, while the corners may be off
// by 100uM (kernel/rounding.h). Split::longest_edge halves the diameter every second time, up to a factor of sqrt(3)
// overall. 102 times make it as small, because sqrt(3) * 2^-51 < 2^-50.
inline int most_levels(Split split) {
    return split == Split::midpoint ? 50 : WATCHED_ELSE("subdivision: a needle needs twice as many halvings", 102, 51);
}

// A triangle cut into pieces. `vertices` holds its corners (0, 1, 2), then the new vertices. A piece is three indices
// into `vertices`, in the orientation of the triangle. The pieces cover the triangle, except for the rounding of the
// new vertices (kernel/rounding.h).
template <class Vertex> struct Cut {
    std::array<Vertex, 6> vertices;
    std::size_t vertex_count = 3, piece_count = 0;
    std::array<std::array<std::size_t, 3>, 4> pieces{};

    std::array<Vertex, 3> corners(std::size_t piece) const {
        const auto& corner = pieces[piece];
        return {vertices[corner[0]], vertices[corner[1]], vertices[corner[2]]};
    }
};

// Cuts a triangle into four pieces, with a new vertex on each edge. `Vertex` has a member `point`. place(from, to)
// returns the point at which to cut the edge between two vertices. measure(point, near) returns the new vertex at this
// point; `near` is an end of the edge, whose nearest triangle of B is a good start for a query.
template <class Vertex, class Place, class Measure>
Cut<Vertex> cut_in_four(const std::array<Vertex, 3>& corners, const Place& place, const Measure& measure) {
    Cut<Vertex> cut;
    for (std::size_t k = 0; k < 3; ++k) cut.vertices[k] = corners[k];
    for (std::size_t k = 0; k < 3; ++k) {  // vertices 3, 4, 5 are on the edges opposite to corners 0, 1, 2
        const Vertex &from = cut.vertices[(k + 1) % 3], &to = cut.vertices[(k + 2) % 3];
        cut.vertices[cut.vertex_count++] = measure(place(from, to), from);
    }
    cut.pieces = {{{0, 5, 4}, {1, 3, 5}, {2, 4, 3}, {3, 4, 5}}};
    cut.piece_count = WATCHED_ELSE("subdivision: the piece in the middle", 4, 3);
    return cut;
}

// Cuts a triangle at the midpoints of all edges (four pieces) or of the longest edge (two pieces). Calls `measure` (see
// cut_in_four) once for each new vertex, in the order of Cut::vertices. If only the longest edge is cut, pieces[0][0]
// is the corner opposite to it.
template <class Vertex, class Measure>
Cut<Vertex> cut_triangle(const std::array<Vertex, 3>& corners, Split split, const Measure& measure) {
    const auto midpoint = [](const Vertex& from, const Vertex& to) { return Vec3(0.5 * (from.point + to.point)); };
    if (split == Split::midpoint) return cut_in_four(corners, midpoint, measure);
    Cut<Vertex> cut;
    for (std::size_t k = 0; k < 6; ++k) cut.vertices[k] = corners[k % 3];  // initialises unused vertices, too
    std::size_t opposite = 0;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k) {
        const double length = squared_length(corners[(k + 1) % 3].point - corners[(k + 2) % 3].point);
        if (WATCHED_ELSE("subdivision: the longest edge is halved", length > longest, longest < 0)) {
            longest = length;
            opposite = k;
        }
    }
    const std::size_t next = (opposite + 1) % 3, last = (opposite + 2) % 3;
    cut.vertices[cut.vertex_count++] = measure(midpoint(corners[next], corners[last]), corners[next]);
    cut.pieces[0] = {opposite, next, 3};
    cut.pieces[1] =
        WATCHED_ELSE("subdivision: both halves", (std::array<std::size_t, 3>{opposite, 3, last}), cut.pieces[0]);
    cut.piece_count = 2;
    return cut;
}

}  // namespace hausbench
