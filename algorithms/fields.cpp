#include "fields.h"

#include "error.h"
#include "kernel/rounding.h"
#include "structures/bvh.h"

#include <algorithm>
#include <cmath>

namespace hausbench {

namespace {

Points standing(const PreparedShape& shape, const Pose& pose, const char* name) {
    if (kind_of(shape.shape()) == ShapeKind::surface)
        throw InputError("an algebraic surface has no vertices, so it has no fields: triangulate it first");
    Points points = posed(shape.original(), pose);
    if (points.allFinite()) return points;
    throw InputError(std::string("the pose moves a point of ") + name +
                     " beyond the largest double, 1.8e308: give both shapes in a larger unit");
}

}  // namespace

Fields distance_fields(const PreparedShape& source, const Pose& source_pose, const PreparedShape& target,
                       const Pose& target_pose) {
    Shape vertices = PointSet{standing(source, source_pose, "A")};
    Shape there = target.shape();
    points_of(there) = standing(target, target_pose, "B");
    const int exponent = scale_exponent(std::max(magnitude(points_of(vertices)), magnitude(points_of(there))));
    const PreparedShape from(std::move(vertices), exponent), to(std::move(there), exponent);
    const TriangleBvh tree(to.triangles());
    const Points& points = points_of(from.shape());
    const auto count = static_cast<std::size_t>(points.rows());
    Field distance{"distance", Field::Of::vertices, Field::Meaning::number, std::vector<double>(count)};
    Field nearest{"nearest", Field::Of::vertices, Field::Meaning::number, std::vector<double>(count)};
    Counters unused;
    ClosestHints hints;
    for (std::size_t i = 0; i < count; ++i) {
        const ClosestPoint found = tree.closest(points.row(static_cast<Index>(i)).transpose(), hints, unused);
        distance.values[i] = std::ldexp(std::sqrt(found.squared_distance), -exponent);
        nearest.values[i] = found.triangle;
        hints.warm_triangle = found.triangle;  // neighbours in the file are often neighbours in space
    }
    return {std::move(distance), std::move(nearest)};
}

double field_error(double magnitude) { return 32 * unit_roundoff * magnitude + 0x1p-1074; }

std::string_view to_string(Field::Of of) { return of == Field::Of::vertices ? "vertices" : "elements"; }

std::string_view to_string(Field::Meaning meaning) {
    constexpr std::string_view names[] = {"lower", "upper", "number"};
    return names[static_cast<std::size_t>(meaning)];
}

}  // namespace hausbench
