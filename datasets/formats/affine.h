// Affine maps of points, for the readers of scenes; private to datasets/.
#pragma once

#include "algorithms/scene.h"

#include <Eigen/Core>

namespace hausbench::readers {

// An affine map: a point p moves to matrix * p + shift.
struct Affine {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
    Vec3 shift = Vec3::Zero();

    bool is_identity() const { return matrix == Eigen::Matrix3d::Identity() && shift == Vec3::Zero(); }

    // Adds the products from left to right, and then the shift.
    Vec3 linear(const Vec3& p) const {
        Vec3 moved;
        for (int i = 0; i < 3; ++i) moved[i] = matrix(i, 0) * p[0] + matrix(i, 1) * p[1] + matrix(i, 2) * p[2];
        return moved;
    }
    Vec3 operator()(const Vec3& p) const { return linear(p) + shift; }

    // Returns the map that applies `inner` first. An identity changes no bit.
    Affine operator*(const Affine& inner) const {
        if (inner.is_identity()) return *this;
        if (is_identity()) return inner;
        Affine both;
        for (int column = 0; column < 3; ++column) both.matrix.col(column) = linear(inner.matrix.col(column));
        both.shift = (*this)(inner.shift);
        return both;
    }
};

}  // namespace hausbench::readers
