// Shapes, and scenes, which pair a source shape A with a target shape B.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <concepts>
#include <memory>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

namespace hausbench {

using Shape = std::variant<PointSet, TriangleMesh, AlgebraicSurface>;

enum class ShapeKind { points, mesh, surface };  // in the order of Shape

ShapeKind kind_of(const Shape& shape);
std::string_view to_string(ShapeKind kind);

// Returns the points of a point set, the vertices of a mesh, or the two corners of the box of a surface.
const Points& points_of(const Shape& shape);
Points& points_of(Shape& shape);

// Returns the number of points of a point set or of triangles of a mesh; 1 for a surface.
Index element_count(const Shape& shape);

// What the parts of a shape count by in statistics by area.
enum class CountedBy {
    points,   // a point set: each point once
    area,     // a mesh with a triangle of three different corners
    length,   // a mesh of line segments, which are triangles with two equal corners, and single points
    nothing,  // a mesh of single points alone, or a surface
};

CountedBy counted_by(const Shape& shape);  // O(n)

// Return the mesh or the surface in a shape. Throw std::bad_variant_access if the shape is of another kind.
inline const TriangleMesh& mesh_of(const Shape& shape) { return std::get<TriangleMesh>(shape); }
inline const AlgebraicSurface& surface_of(const Shape& shape) { return std::get<AlgebraicSurface>(shape); }

// A read-only shape that several scenes may share. Copying a SharedShape copies a pointer, not the points.
class SharedShape {
public:
    template <class S>
    requires(std::constructible_from<Shape, S&&> && !std::same_as<std::remove_cvref_t<S>, SharedShape>)
        SharedShape(S&& shape)  // NOLINT(google-explicit-constructor): for Scene{a, b}
        : shape_(std::make_shared<const Shape>(std::forward<S>(shape))) {}

    operator const Shape&() const { return *shape_; }  // NOLINT(google-explicit-constructor): used as a Shape

private:
    std::shared_ptr<const Shape> shape_;
};

// A source A and a target B before any motion. Queries move them by poses; the scene itself does not change.
struct Scene {
    SharedShape source, target;
};

}  // namespace hausbench
