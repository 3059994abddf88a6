// Computes the distance from A to B at many points of A, as a field (solver.h) from which pictures are drawn. Needs no
// solver.
#pragma once

#include "algorithms/prepared.h"
#include "algorithms/solver.h"

#include <vector>

namespace hausbench {

// Options for cutting A before it is drawn.
struct Drawing {
    // The largest difference allowed between the distance and its linear interpolation from the vertices, as a fraction
    // of h(A,B). As h is not known, the larger of `lower` (a lower bound on h) and the largest distance of a vertex of
    // A stands for it. The difference is measured at the midpoint of every edge and at the centroid of every piece, so
    // a spike in between can be missed. Infinity: A is not cut.
    double fraction = infinity;
    double lower = 0;
    // A point that becomes a vertex if it lies on triangle `witness_element` of A in its pose; -1: no such point.
    Vec3 witness = Vec3::Zero();
    Index witness_element = -1;
    std::size_t most_pieces = 2'000'000;  // no limit on the triangles of A itself
};

// A in its pose, with its triangles cut into smaller triangles, called *pieces*, and the distance to B in its pose at
// each vertex.
struct DrawnField {
    Points vertices;              // the vertices of A in its pose, to the bit, then vertices added by cuts
    Triangles pieces;             // empty if A is a point set
    std::vector<Index> elements;  // for each piece, its triangle of A
    std::vector<double> distances;
    // The element of B nearest to each vertex; the lowest index if several seem equally near.
    std::vector<Index> nearest;
    // False if the limit Drawing::most_pieces ended the cutting while some differences were still too large.
    bool resolved = true;

    double largest() const;
};

// Computes the distances at the vertices of A and cuts A where interpolating them linearly is not good enough. Begins
// with the largest differences, because the limit on pieces may end the cutting. If nothing does, no edge is longer
// than 1/64 of the diagonal of A, except on thin triangles. O((|A| + |pieces|) log |B|) on well-behaved shapes.
// Throws InputError for a surface, or if a pose moves a point beyond the largest double.
//
// Error: let M be the largest |coordinate| of A and B in their poses. The computed distance of a vertex differs from
// its exact distance by at most field_error(M), and so does the exact distance of the vertex to the element in
// `nearest`. A vertex added by a cut is within 2 * field_error(M) of its triangle of A. fields.cpp derives both.
DrawnField draw_distance(const PreparedShape& source, const Pose& source_pose, const PreparedShape& target,
                         const Pose& target_pose, const Drawing& drawing = {});

// Returns the fields that results keep: for vertices "distance", "nearest", "x", "y" and "z"; for
// pieces "a", "b", "c" (vertices) and "element".
Fields as_fields(const DrawnField& drawn);

// Adds a solver's own fields. A name that as_fields() uses gets the prefix "own ".
void add_own(Fields& fields, Fields own);

// Returns 320 * 2^-53 * magnitude, plus a term for subnormal numbers; see draw_distance().
double field_error(double magnitude);

std::string_view to_string(Field::Of of);
std::string_view to_string(Field::Meaning meaning);

}  // namespace hausbench
