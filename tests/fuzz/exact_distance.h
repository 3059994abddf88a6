#pragma once

#include "algorithms/kernel/triangle.h"
#include "algorithms/scene.h"
#include "tests/support/exact.h"

namespace hausbench {

inline exact::Rational squared_to(const exact::RVec3& p, const Shape& shape) {
    exact::Rational least = -1;
    const auto take = [&](const exact::Rational& squared) { least = least < 0 || squared < least ? squared : least; };
    if (kind_of(shape) == ShapeKind::points) {
        for (Index i = 0; i < points_of(shape).rows(); ++i)
            take(exact::squared_distance(p, exact::vector(points_of(shape).row(i))));
        return least;
    }
    for (Index t = 0; t < mesh_of(shape).triangles.rows(); ++t) {
        const Triangle v = triangle_of(mesh_of(shape), t);
        take(exact::squared_distance_to_triangle(p, exact::vector(v.a), exact::vector(v.b), exact::vector(v.c)));
    }
    return least;
}

}  // namespace hausbench
