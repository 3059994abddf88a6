// Holds the input and the output of a CoverWorker of threshold cover (meshes/cover/cover.cpp).
#pragma once

#include "algorithms/meshes/cover/cluster.h"
#include "algorithms/meshes/cover/proofs.h"
#include "algorithms/search/elements.h"
#include "algorithms/solver.h"
#include "algorithms/structures/triangle_blocks.h"

#include <array>
#include <vector>

namespace hausbench {

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
    // Of a certificate; null: none is wanted. With one, or with elements, workers work one after another.
    CoverProofs* proofs;
    // As in WarmStart, of each triangle of A; null: there is none. Each is read and written by one worker alone.
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

// Of one part of the work.
struct CoverOutcome {
    Farthest farthest;
    double settled = 0;  // the largest upper bound of what was settled
    std::vector<Cluster> groups;
    std::vector<CoverPiece> undecided;
    Counters counters;
};

}  // namespace hausbench
