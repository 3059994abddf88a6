// How far each place of A is from B, as a field for pictures. Needs no solver.
#pragma once

#include "algorithms/prepared.h"
#include "algorithms/solver.h"

#include <vector>

namespace hausbench {

// How finely A is cut before it is drawn.
struct Drawing {
    // Largest difference allowed between the distance and its linear interpolation, as a fraction of h: of the larger of `lower`, a lower
    // bound of it, and the largest distance of a vertex of A. It is compared at the midpoint of every edge and at the centroid of every
    // piece, so a spike in between can be missed. Infinity: A is not cut.
    double fraction = infinity;
    double lower = 0;
    // A point of A posed that becomes a vertex if it lies on this triangle of A; -1: no such point.
    Vec3 witness = Vec3::Zero();
    Index witness_element = -1;
    std::size_t most_pieces = 2'000'000;  // A itself may have more
};

// A posed, cut into pieces of its triangles, with the distance to B posed at each vertex.
struct DrawnField {
    Points vertices;              // the vertices of A posed, to the bit, then those that cuts added
    Triangles pieces;             // none if A is a point set
    std::vector<Index> elements;  // for each piece, its triangle of A
    std::vector<double> distances;
    // Nearest element of B to each vertex; the lowest index of several that seem as near.
    std::vector<Index> nearest;
    // False: most_pieces ended the cutting with differences above the resolution left.
    bool resolved = true;

    double largest() const;
};

// Cuts where the field needs it, the largest differences first when pieces run out. No edge that is left is longer than 1/64 of the
// diagonal of A posed, but for needles. O((|A| + |pieces|) log |B|) on well-behaved shapes. The shapes must have the same exponent. Throws InputError
// for a surface, or if a pose moves a point beyond the largest double.
//
// Error, u = 2^-53, M = max |coordinate| of A posed and B posed: a distance, and the distance to the element named, differ from the
// exact distance of the vertex by at most field_error(M), which fields.cpp derives. A vertex that a cut added is within
// 2 field_error(M) of its triangle.
DrawnField draw_distance(const PreparedShape& source, const Pose& source_pose, const PreparedShape& target,
                         const Pose& target_pose, const Drawing& drawing = {});

// As results keep it: of vertices "distance", "nearest", "x", "y", "z"; of pieces "a", "b", "c" (vertices) and "element".
Fields as_fields(const DrawnField& drawn);

// Adds a solver's own fields to these. A name that as_fields() uses gets "own " before it.
void add_own(Fields& fields, Fields own);

double field_error(double magnitude);

std::string_view to_string(Field::Of of);
std::string_view to_string(Field::Meaning meaning);

}  // namespace hausbench
