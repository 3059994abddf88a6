#include "algorithms/kernel/geometry.h"

#include <cmath>

namespace hausbench {

double diagonal(const Points& points) {
    if (points.rows() == 0) return 0;
    const Eigen::RowVector3d extent = points.colwise().maxCoeff() - points.colwise().minCoeff();
    const double largest = extent.maxCoeff();
    if (!(largest > 0) || std::isinf(largest)) return largest;
    // Scale the sides by a power of two that brings the largest into [1, 2). Then no square overflows, and squares that
    // underflow are negligible.
    const int exponent = std::ilogb(largest);
    const double x = std::ldexp(extent.x(), -exponent);
    const double y = std::ldexp(extent.y(), -exponent);
    const double z = std::ldexp(extent.z(), -exponent);
    return std::ldexp(std::sqrt(x * x + y * y + z * z), exponent);
}

double longest_side(const Points& points) {
    return points.rows() == 0 ? 0 : (points.colwise().maxCoeff() - points.colwise().minCoeff()).maxCoeff();
}

double magnitude(const Points& points) { return points.rows() == 0 ? 0 : points.cwiseAbs().maxCoeff(); }

bool Pose::is_identity() const {
    return (rotation.array() == Eigen::Matrix3d::Identity().array()).all() && (translation.array() == 0).all();
}

Points posed(const Points& points, const Pose& pose) {
    if (pose.is_identity()) return points;
    const Eigen::Matrix3d& r = pose.rotation;
    const Vec3& t = pose.translation;
    Points result(points.rows(), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const double x = points(i, 0), y = points(i, 1), z = points(i, 2);
        for (int k = 0; k < 3; ++k) result(i, k) = ((r(k, 0) * x + r(k, 1) * y) + r(k, 2) * z) + t(k);
    }
    return result;
}

}  // namespace hausbench
