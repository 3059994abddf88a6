// The distance from each point of A to B, as a field for pictures. Needs no solver.
#pragma once

#include "algorithms/prepared.h"
#include "algorithms/solver.h"

#include <vector>

namespace hausbench {

// Options for cutting A before it is drawn.
struct Drawing {
    // Largest difference allowed between the distance and its linear interpolation, as a fraction
    // of h. For h it takes the larger of `lower` (a lower bound of h) and the largest distance of
    // a vertex of A. The difference is measured at the midpoint of every edge and at the centroid
    // of every piece, so a spike in between can be missed. Infinity: A is not cut.
    double fraction = infinity;
    double lower = 0;
    // A point of A posed that becomes a vertex if it lies on triangle `witness_element` of A; -1: no such point.
    Vec3 witness = Vec3::Zero();
    Index witness_element = -1;
    std::size_t most_pieces = 2'000'000;  // no limit on the triangles of A itself
};

// A posed, cut into pieces of its triangles, with the distance to B posed at each vertex.
struct DrawnField {
    Points vertices;              // the vertices of A posed, to the bit, then vertices added by cuts
    Triangles pieces;             // empty if A is a point set
    std::vector<Index> elements;  // for each piece, its triangle of A
    std::vector<double> distances;
    // The element of B nearest to each vertex; the lowest index if several seem equally near.
    std::vector<Index> nearest;
    // False if most_pieces ended the cutting while some differences were still above the resolution.
    bool resolved = true;

    double largest() const;
};

// Cuts A where linear interpolation is not good enough, the largest differences first in case pieces
// run out. If cutting is complete, no edge is longer than 1/64 of the diagonal of A posed, except
// on needles. O((|A| + |pieces|) log |B|) on well-behaved shapes. The shapes must have the same
// exponent. Throws InputError for a surface, or if a pose moves a point beyond the largest double.
//
// Error, with u = 2^-53 and M = max |coordinate| of A posed and B posed: a distance, and the distance
// to the named element, differ from the exact distance of the vertex by at most field_error(M), which
// fields.cpp derives. A vertex added by a cut is within 2 field_error(M) of its triangle.
DrawnField draw_distance(const PreparedShape& source, const Pose& source_pose, const PreparedShape& target,
                         const Pose& target_pose, const Drawing& drawing = {});

// Returns the fields that results keep: for vertices "distance", "nearest", "x", "y" and "z"; for
// pieces "a", "b", "c" (vertices) and "element".
Fields as_fields(const DrawnField& drawn);

// Adds a solver's own fields. A name that as_fields() uses gets the prefix "own ".
void add_own(Fields& fields, Fields own);

double field_error(double magnitude);

std::string_view to_string(Field::Of of);
std::string_view to_string(Field::Meaning meaning);

}  // namespace hausbench
