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

CountedBy counted_by(const Shape& shape) {
    if (kind_of(shape) == ShapeKind::points) return CountedBy::points;
    const auto* mesh = std::get_if<TriangleMesh>(&shape);
    CountedBy by = CountedBy::nothing;
    for (Eigen::Index i = 0; mesh && i < mesh->triangles.rows(); ++i) {
        const auto corner = [&](int k) { return mesh->vertices.row(mesh->triangles(i, k)); };
        const bool equal[] = {corner(0) == corner(1), corner(1) == corner(2), corner(2) == corner(0)};
        if (!equal[0] && !equal[1] && !equal[2]) return CountedBy::area;
        if (!equal[0] || !equal[1]) by = CountedBy::length;
    }
    return by;
}

}  // namespace hausbench
