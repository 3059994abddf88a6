// What is measured: a shape, and the scene that pairs a source A with a target B.
#pragma once

#include "geometry.h"

#include <string_view>
#include <variant>

namespace hausbench {

using Shape = std::variant<PointSet, TriangleMesh, AlgebraicSurface>;

enum class ShapeKind { points, mesh, surface };

ShapeKind kind_of(const Shape& shape);
std::string_view to_string(ShapeKind kind);

// The points of a point set, the vertices of a mesh, the two corners of the box of a surface.
const Points& points_of(const Shape& shape);
Points& points_of(Shape& shape);

// Points of a point set, triangles of a mesh; 1 for a surface.
Index element_count(const Shape& shape);

// The pose moves the source A; the target B does not move.
struct Scene {
    Shape source, target;
};

}  // namespace hausbench
