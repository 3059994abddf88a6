// The fields that need no solver: how far each vertex of A is from B, and which element of B is the nearest.
#pragma once

#include "prepared.h"
#include "solver.h"

namespace hausbench {

// Of two points or meshes that are scaled by the same exponent, in the units of the input:
//
//     "distance"  of each vertex of A posed, its distance to B posed
//     "nearest"   the element of B that is as near; of several that seem equally near, the one of lowest index
//
// O((|A| + |B|) log |B|) on well-behaved shapes. Throws InputError for a surface, or a pose that moves a point beyond the largest
// double.
//
// Error, u = 2^-53, M = max |coordinate| of A posed and B posed: distance, and that to the element named, differ from the exact
// distance by at most field_error(M), which fields.cpp derives.
Fields distance_fields(const PreparedShape& source, const Pose& source_pose, const PreparedShape& target,
                       const Pose& target_pose);

double field_error(double magnitude);

std::string_view to_string(Field::Of of);
std::string_view to_string(Field::Meaning meaning);

}  // namespace hausbench
