// The input and the outcome of a CoverWorker in threshold cover (meshes/cover/cover.cpp).
//
// To *settle* triangles of A or a piece is to record a proven upper bound on their distance to B; the search is then
// done with them.
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

// A point with a known distance to a triangle of B. It bounds the distance of the triangles of A around it: the
// distance from any of their points to B is at most the distance of the landmark plus the distance from that point to
// it.
struct Landmark {
    Vec3 at = Vec3::Zero();
    double distance = 0;  // to triangle `near`, as computed
    Index near = -1;      // the nearest triangle of B, or a partner (CoverScene::partner); -1: not measured
    Index vertex = -1;    // if the landmark is a vertex of A: its index; otherwise -1
};

// An upper bound on the distance of some triangles of A to B, and the reason for it. If `vertex` is set, the bound is
// the distance from this vertex of A to triangle `near` of B, plus at least the distance from the vertex to the
// farthest corner of the triangles. If `vertex` is -1, the bound is the largest distance of a corner to triangle
// `near`.
struct KnownUpper {
    double value = std::numeric_limits<double>::infinity();
    Index near = -1, vertex = -1;

    void improve(const KnownUpper& other) {
        if (other.value < value) *this = other;
    }
};

// A group of neighbouring triangles of A (groups.h), with the best upper bound known.
struct Cluster {
    std::size_t begin = 0, count = 0;  // its triangles are entries begin to begin + count - 1 of CoverScene::order
    KnownUpper upper;
    Landmark landmark;
};

// Moves the `first` most promising clusters, those that may contain the farthest point of A, to the front. The others
// keep their order, so that neighbours stay together.
void order_clusters(std::vector<Cluster>& clusters, std::size_t first);

// The data of one query. Keeps references.
struct CoverScene {
    const TriangleMesh& a;
    const Points& points;  // vertices of A, after its pose
    const Target& target;
    const TriangleBlocks& blocks;     // of B
    const std::vector<Index>& order;  // the triangles of A in an order that keeps neighbours together
    const Query& query;
    double magnitude;  // M of kernel/rounding.h: the largest |coordinate| of A, after its pose, and of B
    double least_gap;  // tau exceeds the lower bound by at least this, unless floor = cutoff
    // Receives bounds of each triangle of A for Result::fields; null if no fields are wanted. With `elements` or
    // `proofs`, only one worker runs at a time.
    ElementBounds* elements;
    CoverProofs* proofs;  // certificate under construction; null if none is wanted
    // For each triangle of A, a triangle of B that is probably near it, or -1 (WarmStart::partner); null without a warm
    // start. Workers that run at the same time use different entries.
    Index* partner;
};

// A triangle of A or a part of one.
struct CoverPiece {
    std::array<Vec3, 3> corners;
    Index source;  // triangle of A
    Index proof;   // index of the piece in CoverProofs
    KnownUpper upper;
    Landmark landmark;
    int level = 0;  // number of halvings; bounds the rounding error of the corners (kernel/rounding.h)

    // Returns the largest distance from a point to a corner.
    double farthest_corner(const Vec3& from) const;

    // Returns k if the longest edge goes from corner k to the next corner.
    std::size_t longest_edge() const;
};

// The unit of local coordinates (LocalUnits) is at least this fraction of the magnitude, even around a single point.
inline constexpr double least_place = 0x1p-100;

// If too many triangles of B are near a piece to try all of them, the piece is halved, but only up to this level. From
// this level on, only some of the near triangles are tried.
inline constexpr int halvings_for_all_near = 8;

// The outcome of one part of the work (see "Rounds" in cover.cpp).
struct CoverOutcome {
    Farthest farthest;
    double settled = 0;                 // largest upper bound of anything settled
    std::vector<Cluster> groups;        // groups that CoverWorker::narrow() did not settle
    std::vector<CoverPiece> undecided;  // pieces that single precision did not settle
    Counters counters;
};

}  // namespace hausbench
