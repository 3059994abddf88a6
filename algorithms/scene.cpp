#include "algorithms/scene.h"

namespace hausbench {

ShapeKind kind_of(const Shape& shape) {
    constexpr ShapeKind kinds[] = {ShapeKind::points, ShapeKind::mesh,
                                   ShapeKind::surface};  // in the order of the variant
    return kinds[shape.index()];
}

std::string_view to_string(ShapeKind kind) {
    constexpr std::string_view names[] = {"points", "mesh", "surface"};
    return names[static_cast<std::size_t>(kind)];
}

const Points& points_of(const Shape& shape) {
    if (const auto* set = std::get_if<PointSet>(&shape)) return set->points;
    if (const auto* surface = std::get_if<AlgebraicSurface>(&shape)) return surface->box;
    return std::get<TriangleMesh>(shape).vertices;
}

Points& points_of(Shape& shape) { return const_cast<Points&>(points_of(static_cast<const Shape&>(shape))); }

Index element_count(const Shape& shape) {
    if (const auto* set = std::get_if<PointSet>(&shape)) return static_cast<Index>(set->points.rows());
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return static_cast<Index>(mesh->triangles.rows());
    return 1;
}

}  // namespace hausbench
