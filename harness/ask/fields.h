// Computes the distance to B at many points of A, as fields (solver.h) from which pictures are drawn. Needs no solver.
#pragma once

#include "algorithms/prepared.h"
#include "algorithms/solver.h"

#include <vector>

namespace hausbench {

// Options for cutting A into pieces that are small enough for a picture of the distance.
struct Drawing {
    // A is cut until the distance differs from its linear interpolation by at most this fraction of h(A,B), at the
    // midpoint of every edge and at the centroid of every piece. A spike in between can be missed. The larger of
    // `lower` and the largest distance of a vertex of A stands for h(A,B), which is not known. Infinity: A is not cut.
    double fraction = infinity;
    double lower = 0;
    // A point that becomes a vertex if it lies on triangle `witness_element` of A, moved by its pose; -1: no such
    // point.
    Vec3 witness = Vec3::Zero();
    Index witness_element = -1;
    std::size_t most_pieces = 2'000'000;  // no limit on the triangles of A itself
    // Once it has passed, the remaining vertices of A get an infinite distance and the element -1. Null: none. Only for
    // an A that is not cut.
    const Deadline* deadline = nullptr;
};

// A in its pose, cut into small triangles called *pieces*, with the distance from each vertex to B in its pose.
struct DrawnField {
    Points vertices;              // the vertices of A in its pose, unchanged, then vertices added by cuts
    Triangles pieces;             // empty if A is a point set
    std::vector<Index> elements;  // for each piece, its triangle of A
    std::vector<double> distances;
    // The element of B nearest to each vertex. If several seem equally near, the one with the lowest index.
    std::vector<Index> nearest;
    // False if Drawing::most_pieces ended the cutting while some differences were still too large.
    bool resolved = true;

    double largest() const;
};

// Computes the distances at the vertices of A and cuts A where linear interpolation is not good enough
// (Drawing::fraction). Cuts the largest differences first, because Drawing::most_pieces may end the cutting. If it does
// not, no edge is longer than 1/64 of the diagonal of A, except on thin triangles. O((|A| + |pieces|) log |B|) on
// well-behaved shapes. Throws InputError for a surface, or if a pose moves a point beyond the largest double.
//
// Error: let M be the largest |coordinate| of A and B in their poses. The computed distance of a vertex differs from
// its exact distance by at most field_error(M), and so does the exact distance of the vertex to the element in
// `nearest`. A vertex added by a cut is within 2 * field_error(M) of its triangle of A. field_error.cpp derives both.
DrawnField draw_distance(const PreparedShape& source, const Pose& source_pose, const PreparedShape& target,
                         const Pose& target_pose, const Drawing& drawing = {});

// Returns the fields that a result file stores: for each vertex "distance", "nearest", "x", "y" and "z"; for each piece
// "a", "b" and "c" (its vertices) and "element".
Fields as_fields(const DrawnField& drawn);

// Appends a solver's own fields. A name that as_fields() also uses gets the prefix "own ".
void add_own(Fields& fields, Fields solver_fields);

// Returns the error limit of draw_distance(): 320 * 2^-53 * magnitude, plus a term for subnormal numbers.
double field_error(double magnitude);

// Returns an error limit for the distance of one vertex. `magnitude` is the largest |coordinate| of B in its pose, and
// `largest` of both shapes. A vertex of A far away does not count.
double field_error(const Vec3& vertex, double magnitude, double largest);

std::string_view to_string(Field::Of of);
std::string_view to_string(Field::Meaning meaning);

}  // namespace hausbench
