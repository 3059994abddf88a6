// Basic types: vectors, point sets, triangle meshes, algebraic surfaces and poses.
//
// Lengths are in the unit of the input. Nothing here rescales them; session/scaled.h does.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products
#include <cstdint>
#include <limits>
#include <string>

namespace hausbench {

using Vec3 = Eigen::Vector3d;
using Index = std::int32_t;
inline constexpr double infinity = std::numeric_limits<double>::infinity();
// One point or triangle per row.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Triangles = Eigen::Matrix<Index, Eigen::Dynamic, 3, Eigen::RowMajor>;

// A set of points. File loaders check that it is not empty and that all coordinates are finite.
struct PointSet {
    Points points;
};

// A triangle soup: no adjacency, orientation or manifoldness is assumed, and degenerate triangles are allowed. Every
// vertex belongs to a triangle; file loaders drop unused vertices and report how many.
struct TriangleMesh {
    Points vertices;
    Triangles triangles;
};

// The points of a closed box at which a polynomial in x, y, z is zero. Like every shape, the surface must not be empty.
// A solver that finds it empty throws InputError in prepare().
struct AlgebraicSurface {
    // The syntax is in kernel/polynomial.h. Coefficients are exact: "0.1" is one tenth, not the nearest double.
    std::string polynomial;
    Points box;  // two rows: the smallest and the largest corner, which differ in every coordinate
};

// Returns the length of the diagonal of the bounding box of the points; 0 for an empty set.
double diagonal(const Points& points);

// Returns the length of the longest side of the bounding box of the points; 0 for an empty set.
double longest_side(const Points& points);

// Returns the largest |coordinate| of the points; 0 for an empty set.
double magnitude(const Points& points);

// The map v -> rotation * v + translation, which moves a shape in a query. Usually a rigid motion, but any matrix is
// allowed. Result files store these twelve numbers.
struct Pose {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Vec3 translation = Vec3::Zero();

    bool is_identity() const;
};

// Returns the points moved by a pose. Coordinate k of a point (x, y, z) becomes
//     ((r(k,0) * x + r(k,1) * y) + r(k,2) * z) + t(k),   where r is the rotation and t the translation,
// rounded after each operation, in this order. The identity returns the same bits.
//
// In all comments, "posed" points and meshes are the ones with these rounded coordinates; every bound and witness
// refers to them. Algebraic surfaces cannot be moved: a session accepts only the identity for them.
Points posed(const Points& points, const Pose& pose);

}  // namespace hausbench
