// A cut into pieces, each with bounds on the distance to B.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/meshes/distribution/mean_bounds.h"
#include "algorithms/scene.h"
#include "algorithms/statistic.h"
#include "algorithms/structures/triangle_blocks.h"

#include <functional>
#include <limits>
#include <vector>

namespace hausbench::distribution {

// A piece with its bounds.
struct Leaf {
    Piece piece;
    AffineBounds bounds;
    double weight;  // relative error at most weight_error; areas are relative to a square about as large as the scene
    bool final;     // not cut further: too small, or its gap is only rounding
};

// The relative error of a weight: area_error (weights.h) and 3u for each of the up to 200 cuts that made the piece,
// u = 2^-53. Together less than 2^-42.
inline constexpr double weight_error = 0x1p-42;

// Returns the share of a piece for which it is open whether d <= t: the mean over t = low, high and the middle.
double open_in(const AffineBounds& bounds, double low, double high);

// The pieces to cut: those that exceed one of these limits.
struct CutWhere {
    static constexpr double never = std::numeric_limits<double>::infinity();

    double mean = never;     // weight times the gap of the mean of d
    double square = never;   // weight times the gap of the mean of d^2
    double maximum = never;  // the largest upper bound of d, for pieces whose
    double maximum_gap = 0;  // gap between the largest bounds is more than this
    struct Band {
        double low, high, limit;  // weight times open_in(low, high)
    };
    std::vector<Band> bands;
    struct Spread {
        double about, limit;  // weight times the gap of the mean of (d - about)^2
    };
    std::vector<Spread> spreads;

    bool operator()(const AffineBounds& bounds, double weight) const;
};

// Bounds on the mean of (d - about)^2 over a piece.
struct SpreadBounds {
    double lower, upper;
};
SpreadBounds spread_about(const AffineBounds& bounds, double about);

// Returns the segments (a, b, b) of a mesh of segments as triangles (a, b, b) and, behind all of these, (b, a, a).
//
// Pieces of a triangle have shares of its area, and a degenerate triangle is the image of a proper one under an affine
// map. Of (a, b, b), the image of equal areas is denser near b: its density falls linearly from 2 at b to 0 at a. The
// triangle (b, a, a) has the opposite density, so both together, with half of the length each, weigh every part of the
// segment by its length.
Triangles both_orders(const Triangles& triangles, const Points& points);

// The pieces of all triangles of A. At first none; refine() makes them.
class Dissection {
public:
    // Keeps references. `points` are the vertices of A, moved by its pose, `magnitude` is M of kernel/rounding.h.
    // O(n). CountedBy::length is for the triangles of both_orders().
    Dissection(const Triangles& triangles, const Points& points, const TriangleBlocks& target, double magnitude,
               CountedBy weigh, int threads);

    // Tells whether to stop, given the number of pieces so far. Threads call it concurrently. It may throw; the pieces
    // are then incomplete.
    using Stop = std::function<bool(std::size_t pieces)>;

    // Cuts pieces, and their parts, as long as they exceed a limit of `where`. Returns false if there was nothing to
    // cut. After `stop` has returned true, no piece is cut much further. Stops cutting a piece when it has many parts,
    // so that there will be fewer than 5 * most_leaves + 16 * (the pieces so far) in all. Unless stopped, the result is
    // the same for any number of threads.
    bool refine(const CutWhere& where, const Stop& stop, std::size_t most_leaves);

    const std::vector<Leaf>& leaves() const { return leaves_; }

    // Returns the number of pieces, with those that the current round of refine() has still to look at.
    std::size_t count() const { return leaves_.size() + open_; }
    const Counters& counters() const { return counters_; }

    // The weights of all triangles together may be larger than the sum of the computed ones by this much, because
    // triangles that are nearly segments have uncertain areas.
    double extra_weight() const { return extra_; }

    // Whether every leaf has the weight 1. This holds for points, because they are never cut.
    bool counted() const { return counted_; }

private:
    class Worker;
    Leaf uncut(std::size_t triangle) const;  // without bounds
    Leaf unknown(const Piece& piece) const;  // with rough bounds
    double weight_of(const Piece& piece) const {
        return weights_[static_cast<std::size_t>(piece.source)] * piece.share;
    }

    const Triangles& triangles_;
    const Points& points_;
    const TriangleBlocks& target_;
    double magnitude_;
    Threads threads_;
    bool counted_;
    std::vector<double> weights_;  // of the triangles of A
    double extra_ = 0;
    std::vector<Leaf> leaves_;
    std::size_t open_ = 0;  // pieces of the current round that are not in `leaves_` yet
    Counters counters_;
};

}  // namespace hausbench::distribution
