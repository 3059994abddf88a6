// Describes the work of a CoverWorker of threshold cover (meshes/cover/cover.cpp) and what comes of it.
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

// A point that was measured, near some triangles.
struct Landmark {
    Vec3 at = Vec3::Zero();
    double distance = 0;  // to B, as computed
    Index near = -1;      // triangle of B, nearest to it; -1: nothing was measured
    Index vertex = -1;    // of A that it is, or -1
};

// An upper bound of the distance of some triangles to B, and why: by the distance of this vertex of A to triangle `near` of B and the
// way there; with no vertex, -1, by the distances of all corners to that triangle.
struct KnownUpper {
    double value = std::numeric_limits<double>::infinity();
    Index near = -1, vertex = -1;

    void improve(const KnownUpper& other) {
        if (other.value < value) *this = other;
    }
};

// Triangles of A that follow one another in the order.
struct Cluster {
    std::size_t begin = 0, count = 0;
    KnownUpper upper;
    Landmark landmark;
};

// The most promising first, `first` of them; the others in the order of A, so that neighbours follow one another.
void order_clusters(std::vector<Cluster>& clusters, std::size_t first);

// One query. All are references; `elements` and `proofs` may be null.
struct CoverScene {
    const TriangleMesh& a;
    const Points& points;  // vertices of A, posed
    const Target& target;
    const TriangleBlocks& blocks;     // of B
    const std::vector<Index>& order;  // of A's triangles
    const Query& query;
    double magnitude;  // as in kernel/rounding.h
    double least_gap;  // of tau above the lower bound
    ElementBounds* elements;
    // The proofs of a certificate; null if none is wanted. With proofs or elements, workers run one after another.
    CoverProofs* proofs;
    // As in WarmStart, for each triangle of A; null if there is none. Each is read and written by one worker only.
    Index* partner;
};

// A triangle of A, or a part of one.
struct CoverPiece {
    std::array<Vec3, 3> corners;
    Index source;
    Index proof;  // number in CoverProofs
    KnownUpper upper;
    Landmark landmark;
    int level = 0;  // halvings, as kernel/rounding.h counts them

    double farthest_corner(const Vec3& from) const;  // its distance
    std::size_t longest_edge() const;                // number of the corner that it starts from
};

// The unit of a place is at least this part of the magnitude.
inline constexpr double least_place = 0x1p-100;

// From so many halvings of a triangle on, a piece is covered by some of the triangles of B near it, if there are too many.
inline constexpr int halvings_for_all_near = 8;

// The findings of one part of the work.
struct CoverOutcome {
    Farthest farthest;
    double settled = 0;  // the largest upper bound of a settled piece or group
    std::vector<Cluster> groups;
    std::vector<CoverPiece> undecided;
    Counters counters;
};

}  // namespace hausbench
