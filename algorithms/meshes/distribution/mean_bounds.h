// Pieces of the triangles of A, and bounds on the distance to B over one piece.
#pragma once

#include "algorithms/kernel/triangle.h"
#include "algorithms/meshes/distribution/affine.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hausbench::distribution {

// A triangle of A or a part of it.
struct Piece {
    std::array<Vec3, 3> corners;
    double share;        // of the area of its triangle of A
    Index source;        // the triangle of A
    Index near;          // a triangle of B that is near; -1: none known
    std::int32_t level;  // of its corners (kernel/rounding.h)
    std::int32_t cuts;   // number of cuts that made it

    Vec3 centre() const { return (corners[0] + corners[1] + corners[2]) / 3; }
};

// Bounds on the distance d to B over one piece. Affine functions below and above d, given by their values at the
// corners; and bounds on the means of d and of d^2 over the piece. The lower function may be negative.
struct AffineBounds {
    CornerValues lower, upper;
    double mean_lower, mean_upper, square_lower, square_upper;

    double least() const { return std::max(0.0, std::min({lower[0], lower[1], lower[2]})); }
    double most() const { return std::max({upper[0], upper[1], upper[2]}); }
};

// A triangle of B, copied to a list of its own.
struct NearbyTriangle {
    Triangle corners;
    Index index;
};

// A plane through the common edge of two triangles S and T that halves their dihedral angle.
struct Bisector {
    Vec3 point, normal;  // of length 1, away from S
    double tilt;         // an upper bound on the error of the normal

    double side(const Vec3& p) const { return dot(normal, p - point); }
};
// Returns nothing if they have no edge in common, if they are nearly folded onto each other, or if one is a needle.
std::optional<Bisector> bisector_of(const Triangle& s, const Triangle& t);

// Returns a radius: every point of the piece has a nearest triangle of B within it of the centre. `squared` is the squared
// distance from the centre to any triangle of B, as closest_point computes it; `magnitude` is M of kernel/rounding.h.
double reach_of(const Piece& piece, double squared, double magnitude);

// Computes bounds for pieces, given the triangles of B near them. Has scratch memory, so each thread needs its own.
class MeanBounder {
public:
    // `magnitude` is M of kernel/rounding.h.
    explicit MeanBounder(double magnitude) : magnitude_(magnitude) {}

    // Computes the bounds for a piece. `among` are numbers of triangles in `near`, and every point of the piece has a
    // nearest triangle of B among them; the first of them is a good guess for the triangle nearest to the centre.
    // Afterwards, kept() has the triangles that parts of the piece may need; the first is nearest to the centre.
    AffineBounds bounds(const Piece& piece, std::span<const NearbyTriangle> near, std::span<const std::uint16_t> among);

    const std::vector<std::uint16_t>& kept() const { return kept_; }

    // The squared distances of the corners to each kept triangle.
    const std::vector<CornerValues>& kept_squares() const { return squares_; }

    // Computes bounds for a piece from a triangle of B that is near, and from a certified lower bound on the distance of
    // the centre from B. The distance to B changes no more than the point moves.
    AffineBounds rough(const Piece& piece, const Triangle& near, double centre_at_least);

    std::uint64_t distances = 0;  // from points to triangles, computed so far

private:
    void curved(const Piece& piece, std::span<const NearbyTriangle> near, AffineBounds& bounds);

    double magnitude_;
    std::vector<std::uint16_t> kept_;
    std::vector<CornerValues> squares_;
    std::vector<std::uint8_t>
        needed_;  // for each kept triangle, whether it is nearer than the nearest, by more than rounding
    Vec3 foot_, direction_;
};

// Fills in the bounds on means that follow from the affine bounds.
void bound_means(AffineBounds& bounds);

}  // namespace hausbench::distribution
