#include "algorithms/meshes/tang/volumes.h"

#include "algorithms/kernel/rounding.h"

#include <algorithm>
#include <cmath>

namespace hausbench {

// The distance to q is convex, so over the hull it is largest at a corner; these distances are bounded as point to
// point in rounding.h. Rounding the sum costs half an ulp, which next_up makes up for.
double distance_at_most(const CornerVolume& volume, const Vec3& q) {
    double most = 0;
    for (std::size_t i = 0; i < volume.count; ++i) most = std::max(most, squared_length(volume.corner[i] - q));
    return next_up(distance_at_most(most, true) + volume.radius);
}

// A corner (c + s u) + t v errs by 2.01u m in each coordinate, where m is the largest |coordinate| of |c| + |u| +
// |v|, so by less than 4u m in length. The product and the sums that compute m lose a few u of it.
CornerVolume corners_of(const SweptSphereBvh& tree, std::size_t node, int child) {
    const SweptSphere& swept = tree.volume(node, child);
    CornerVolume volume;
    for (const double s : {-1.0, 1.0}) {
        for (const double t : {-1.0, 1.0}) volume.corner[volume.count++] = (swept.centre + s * swept.u) + t * swept.v;
    }
    const double m = (swept.centre.cwiseAbs() + swept.u.cwiseAbs() + swept.v.cwiseAbs()).maxCoeff();
    volume.radius = next_up(swept.radius + 5 * unit_roundoff * m);
    return volume;
}

// The computed planes never cut off content (structures/quantised_boxes.h).
CornerVolume corners_of(const TriangleBvh& tree, std::size_t node, int child) {
    const QuantisedBoxes& boxes = tree.tree().nodes[node].boxes;
    CornerVolume volume;
    volume.count = 8;
    for (std::size_t i = 0; i < 8; ++i) {
        for (int k = 0; k < 3; ++k) {
            const auto lane = static_cast<std::size_t>(child);
            const bool high = (i >> k & 1) != 0;
            volume.corner[i][k] = k < 2 ? boxes.plane(k, high ? boxes.high_xy[lane][k] : boxes.low_xy[lane][k])
                                        : boxes.plane(k, high ? boxes.high_z[lane] : boxes.low_z[lane]);
        }
    }
    return volume;
}

double distance_at_least(const SweptSphereBvh& tree, std::size_t node, int child, const Vec3& q) {
    return distance_at_least(tree.volume(node, child), q);
}

// Computed squared distances to points of the box are never smaller (box.h).
double distance_at_least(const TriangleBvh& tree, std::size_t node, int child, const Vec3& q) {
    const QuantisedBoxes& boxes = tree.tree().nodes[node].boxes;
    const auto lane = static_cast<std::size_t>(child);
    Box box;
    for (int k = 0; k < 2; ++k) {
        box.low[k] = boxes.plane(k, boxes.low_xy[lane][k]);
        box.high[k] = boxes.plane(k, boxes.high_xy[lane][k]);
    }
    box.low[2] = boxes.plane(2, boxes.low_z[lane]);
    box.high[2] = boxes.plane(2, boxes.high_z[lane]);
    return distance_at_least(squared_distance_to_box(q, box), true);
}

// |R x|^2 = x.R^T R x is at most |x|^2 times the largest row sum of |R^T R| (Gershgorin). A computed entry errs by
// 3.01u |column i||column j|, at most 3.01u times the square of the largest column, which is part of one of the sums.
// So a sum errs by 9.1u of the largest sum, and by 2u more when it is added up. The root needs 5.6u of the 8u, and
// next_up covers the product. R is first scaled by a power of two, which is exact, so that no square underflows next
// to the largest. If the stretch itself is subnormal, it stretches no radius to 2^-600, which is far below the uM
// that a bound is widened by (kernel/rounding.h).
VolumePose::VolumePose(const Pose& pose) : pose_(pose), identity_(pose.is_identity()) {
    if (identity_) return;
    const double largest = pose.rotation.cwiseAbs().maxCoeff();
    const int exponent = largest > 0 ? std::ilogb(largest) : 0;
    const Eigen::Matrix3d scaled = pose.rotation.unaryExpr([&](double x) { return std::ldexp(x, -exponent); });
    const Eigen::Matrix3d square = scaled.transpose() * scaled;
    const double most = square.cwiseAbs().rowwise().sum().maxCoeff();
    stretch_ = std::ldexp(next_up(std::sqrt(most) * (1 + 8 * unit_roundoff)), exponent);
    rows_ = pose.rotation.cwiseAbs().rowwise().sum().maxCoeff();
}

// A point inside is sum w_i c_i + e with |e| <= radius and weights w_i >= 0 that add up to 1, and R e is at most
// `stretch` times as long as e. The rest is rounding. Let m be the largest |coordinate| of a corner, plus radius, and
// G = rows m + |t|, which bounds every |coordinate| that occurs. fl(R x + t) errs by 4.01u G in each coordinate, less
// than 7u G in length, both for a corner and for the point inside: together 14u G. G as computed is at most 4u of
// itself too small. If G overflows, the radius is infinite.
CornerVolume VolumePose::operator()(const CornerVolume& volume) const {
    if (identity_) return volume;
    CornerVolume result;
    result.count = volume.count;
    double m = 0;
    for (std::size_t i = 0; i < volume.count; ++i) {
        const Vec3& c = volume.corner[i];
        const auto row = [&](int k) {
            return ((pose_.rotation(k, 0) * c[0] + pose_.rotation(k, 1) * c[1]) + pose_.rotation(k, 2) * c[2]) +
                   pose_.translation[k];
        };
        result.corner[i] = {row(0), row(1), row(2)};
        m = std::max(m, c.cwiseAbs().maxCoeff());
    }
    const double most = rows_ * (m + volume.radius) + pose_.translation.cwiseAbs().maxCoeff();
    result.radius = next_up(next_up(stretch_ * volume.radius) + 15 * unit_roundoff * most);
    if (!(result.radius < std::numeric_limits<double>::infinity()))
        result.radius = std::numeric_limits<double>::infinity();
    return result;
}

}  // namespace hausbench
