// The input and the results of a Work, which does one part of the work of threshold cover
// (meshes/cover/cover.cpp).
//
// To *settle* triangles of A or a piece is to record a proven upper bound on their distance to B, after which the
// search no longer looks at them.
#pragma once

#include "algorithms/meshes/cover/proofs.h"
#include "algorithms/search/element_bounds.h"
#include "algorithms/search/target.h"
#include "algorithms/solver.h"
#include "algorithms/structures/triangle_blocks.h"

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace hausbench::cover {

// A point whose distance to a triangle of B is known. The distance of any point p to B is at most `distance` + |p -
// at|, so a landmark bounds the distances of the triangles of A around it.
struct Landmark {
    Vec3 at = Vec3::Zero();
    double distance = 0;  // to triangle `near`, as computed
    Index near = -1;      // the nearest triangle of B, or a partner (Input::partner); -1: not measured
    Index vertex = -1;    // if the landmark is a vertex of A: its index; otherwise -1
};

// An upper bound on the distance of some triangles of A to B, and the reason for it. If `vertex` is -1, the bound is
// the largest distance from a corner to triangle `near` of B. Otherwise it is at least the distance from this vertex of
// A to triangle `near`, plus the distance from the vertex to the farthest corner.
struct KnownUpper {
    double value = std::numeric_limits<double>::infinity();
    Index near = -1, vertex = -1;

    void improve(const KnownUpper& other) {
        if (other.value < value) *this = other;
    }
};

// A group of neighbouring triangles of A, with the best known upper bound on its distance to B.
struct Cluster {
    std::size_t begin = 0, count = 0;  // its triangles are entries begin to begin + count - 1 of Input::order
    KnownUpper upper;
    Landmark landmark;
};

// Moves the `first` clusters that are most likely to contain the farthest point of A to the front. The others keep
// their order, so that neighbours stay together.
void order_clusters(std::vector<Cluster>& clusters, std::size_t first);

// What a Work gets. Keeps references.
struct Input {
    const TriangleMesh& a;
    const Points& points;  // vertices of A, after its pose
    const Target& target;
    const TriangleBlocks& blocks;     // of B
    const std::vector<Index>& order;  // the triangles of A in an order that keeps neighbours together
    const Query& query;
    double magnitude;  // the largest |coordinate| of B and of A, after its pose
    double least_gap;  // the threshold exceeds the lower bound by at least this, unless floor = cutoff
    // Receives the bounds of each triangle of A for Result::fields; null if no fields are wanted. If `elements` or
    // `proofs` is set, only one of them works at a time.
    ElementBounds* elements;
    Proofs* proofs;  // certificate under construction; null if none is wanted
    // For each triangle of A, a triangle of B that is probably near it, or -1 if none is known. Null without a warm
    // start (WarmStart::partner). Those that work at the same time use different entries.
    Index* partner;
};

// A triangle of A or a part of one.
struct Piece {
    std::array<Vec3, 3> corners;
    Index source;  // triangle of A
    Index proof;   // index of the piece in Proofs
    KnownUpper upper;
    Landmark landmark;
    int level = 0;  // number of halvings; bounds the rounding error of the corners (kernel/rounding.h)

    // Returns the largest distance from a point to a corner.
    double farthest_corner(const Vec3& from) const;

    // Returns the number k of the longest edge, which goes from corner k to the next corner.
    std::size_t longest_edge() const;
};

// Least unit of local coordinates (LocalUnits), as a fraction of the largest coordinate, so that the unit is positive
// even around a single point.
inline constexpr double least_place = 0x1p-100;

// If too many triangles of B are near a piece of A to try all of them, the piece is halved. After this many halvings,
// only some of the near triangles are tried instead.
inline constexpr int halvings_for_all_near = 8;

// The results of one part of the work (see "Rounds" in cover.cpp).
struct Outcome {
    Farthest farthest;
    double settled = 0;            // largest upper bound of a settled group or piece
    std::vector<Cluster> groups;   // groups that Work::narrow() did not settle
    std::vector<Piece> undecided;  // pieces that single precision did not settle
    Counters counters;
};

}  // namespace hausbench::cover
