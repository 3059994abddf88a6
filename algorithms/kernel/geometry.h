// Vectors, points, the data of shapes, and poses. The base of kernel/, structures/ and search/, which know nothing
// of scenes.
//
// Lengths are in the unit of the input files; nothing here rescales them (see session.h).
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

// A finite set of points; never empty, all coordinates finite (checked when files are loaded).
struct PointSet {
    Points points;
};

// A triangle soup: no adjacency, orientation or manifoldness is assumed, and degenerate triangles are legal. Every
// vertex belongs to a triangle (loaders drop the others and report their number).
struct TriangleMesh {
    Points vertices;
    Triangles triangles;
};

// The points of a closed box where a polynomial in x, y, z vanishes. Like every shape, it must not be empty; a solver that
// finds it empty throws InputError in prepare().
struct AlgebraicSurface {
    // Syntax: kernel/polynomial.h. Coefficients are exact decimal numbers, not doubles.
    std::string polynomial;
    Points box;  // two rows: least and largest corner, first < second in each coordinate
};

// Returns the length of the diagonal of the bounding box of the points.
double diagonal(const Points& points);

// Returns the length of the longest side of the bounding box.
double longest_side(const Points& points);

// Returns the largest |coordinate|.
double magnitude(const Points& points);

// A rigid motion or any other affine map, as stored in result files.
struct Pose {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Vec3 translation = Vec3::Zero();

    bool is_identity() const;
};

// Returns the points fl(R v + t), computed as (r0 x + r1 y) + r2 z + t and rounded after each operation, in that
// order. "A posed" is by definition the shape on these rounded points, and every bound and witness refers to it.
// The identity pose returns the same bits. Surfaces do not move: a session refuses any pose of a surface but the
// identity.
Points posed(const Points& points, const Pose& pose);

}  // namespace hausbench
