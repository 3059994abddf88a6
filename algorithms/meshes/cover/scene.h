// The input and the outcome of a CoverWorker in threshold cover (meshes/cover/cover.cpp).
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

namespace hausbench {

// A measured point, near some triangles of A.
struct Landmark {
    Vec3 at = Vec3::Zero();
    double distance = 0;  // to B, as computed
    Index near = -1;      // nearest triangle of B; -1: not measured
    Index vertex = -1;    // the vertex of A that it is, or -1
};

// An upper bound of the distance of some triangles of A to B, with its reason: the distance of `vertex` of A to
// triangle `near` of B plus the distance from the vertex to the farthest corner or, if vertex is -1, the distances of
// all corners to `near`.
struct KnownUpper {
    double value = std::numeric_limits<double>::infinity();
    Index near = -1, vertex = -1;

    void improve(const KnownUpper& other) {
        if (other.value < value) *this = other;
    }
};

// Consecutive triangles of A in the order.
struct Cluster {
    std::size_t begin = 0, count = 0;
    KnownUpper upper;
    Landmark landmark;
};

// Moves the `first` most promising clusters to the front. The others keep the order of A, so that neighbours stay
// together.
void order_clusters(std::vector<Cluster>& clusters, std::size_t first);

// The data of one query. References are kept; `elements` and `proofs` may be null.
struct CoverScene {
    const TriangleMesh& a;
    const Points& points;  // vertices of A, posed
    const Target& target;
    const TriangleBlocks& blocks;     // of B
    const std::vector<Index>& order;  // of the triangles of A
    const Query& query;
    double magnitude;  // as in kernel/rounding.h
    double least_gap;  // by which tau exceeds the lower bound
    ElementBounds* elements;
    // Certificate under construction; null if none is wanted. With `proofs` or `elements`, only one worker runs at a
    // time.
    CoverProofs* proofs;
    // One entry per triangle of A, as in WarmStart; null if there is no warm start. Only one worker reads and writes
    // each entry.
    Index* partner;
};

// A triangle of A or a part of one.
struct CoverPiece {
    std::array<Vec3, 3> corners;
    Index source;
    Index proof;  // number in CoverProofs
    KnownUpper upper;
    Landmark landmark;
    int level = 0;  // halvings, as kernel/rounding.h counts them

    double farthest_corner(const Vec3& from) const;  // returns its distance
    std::size_t longest_edge() const;                // returns the index of its first corner
};

// The unit of a place is at least this fraction of the magnitude.
inline constexpr double least_place = 0x1p-100;

// A piece halved this often or more is covered by some of the triangles of B near it if there are too many for all.
inline constexpr int halvings_for_all_near = 8;

// The outcome of one part of the work.
struct CoverOutcome {
    Farthest farthest;
    double settled = 0;  // the largest upper bound of anything settled
    std::vector<Cluster> groups;
    std::vector<CoverPiece> undecided;
    Counters counters;
};

}  // namespace hausbench
