#include "algorithms/meshes/tang/volumes.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <cmath>

namespace hausbench::tang {

// The distance from q is convex, so within the hull of the corners it is largest at a corner, where distance_at_most()
// of kernel/rounding.h bounds it. Adding the radius rounds by up to half an ulp, which next_up absorbs.
double distance_at_most(const CornerVolume& volume, const Vec3& q) {
    double most = 0;
    for (std::size_t i = 0; i < volume.count; ++i) most = std::max(most, squared_length(volume.corner[i] - q));
    return WATCHED_ELSE(
        "volumes: a distance to a corner is widened",
        next_up(distance_at_most(most, true) + WATCHED("volumes: the radius of a volume counts", volume.radius)),
        std::sqrt(most) + volume.radius);
}

// Returns the corners of the rectangle, and a radius that includes their rounding errors. With the centre c, the sides
// u and v, and eps = 2^-53: a corner (c + s u) + t v, with s and t = 1 or -1, errs by 2.01 eps m in each coordinate,
// where m is the largest coordinate of |c| + |u| + |v| (absolute values by coordinate). In length, this is less than
// sqrt(3) * 2.01 eps m < 4 eps m. The code adds 5 eps m, because computing m and the product loses a few eps of it.
CornerVolume corners_of(const SweptSphereBvh& tree, std::size_t node, int child) {
    const SweptSphere& swept = tree.volume(node, child);
    CornerVolume volume;
    for (const double s : {-1.0, 1.0}) {
        for (const double t : {-1.0, 1.0}) volume.corner[volume.count++] = (swept.centre + s * swept.u) + t * swept.v;
    }
    const double m = (swept.centre.cwiseAbs() + swept.u.cwiseAbs() + swept.v.cwiseAbs()).maxCoeff();
    volume.radius = WATCHED_ELSE("volumes: the corners of a swept sphere are rounded",
                                 next_up(swept.radius + 5 * unit_roundoff * m), swept.radius);
    return volume;
}

// Returns the box that the tree stores for the child. It contains the exact box of the triangles, although it is
// quantised (structures/quantised_boxes.h), so the radius is 0.
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

// Returns a lower bound that is valid under rounding. Rounding cannot make the squared distance from q to the box exceed
// the squared distance from q to a point in it (box.h), so rounding.h only has to allow for the last steps.
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
    return WATCHED_ELSE("volumes: a box is no nearer than its content, but for rounding",
                        distance_at_least(squared_distance_to_box(q, box), true),
                        std::sqrt(squared_distance_to_box(q, box)));
}

// Computes stretch_, an upper bound on |R x| / |x|. |R x|^2 = x.(R^T R x) is at most |x|^2 times the largest row sum of
// |R^T R| (Gershgorin).
//
// Rounding, with u = 2^-53: entry (i, j) of R^T R errs by 3.01u |column i||column j|, which is at most 3.01u times
// the square of the longest column. This square is an entry of R^T R, so it is part of one of the row sums. So the
// three entries of a row err by 9.1u of the largest row sum together, and adding them up errs by 2u more. The root
// halves this relative error: 5.6u. The code takes 8u, which leaves room for the rounding of the root; next_up covers
// the rounding of the product.
//
// Underflow: R is first scaled by a power of two, so that its largest entry is in [1, 2). Then only products that are
// negligible beside the largest square underflow. If stretch_ itself is subnormal after scaling back, a stretched
// radius is less than 2^-600, so its error is far below the uM by which a bound is widened (kernel/rounding.h).
VolumePose::VolumePose(const Pose& pose) : pose_(pose), identity_(pose.is_identity()) {
    if (identity_) return;
    const double largest = pose.rotation.cwiseAbs().maxCoeff();
    const int exponent =
        largest > 0 ? WATCHED("volumes: the stretch of a pose whose squares underflow", std::ilogb(largest)) : 0;
    const Eigen::Matrix3d scaled = pose.rotation.unaryExpr([&](double x) { return std::ldexp(x, -exponent); });
    const Eigen::Matrix3d square = scaled.transpose() * scaled;
    const double most = square.cwiseAbs().rowwise().sum().maxCoeff();
    stretch_ = std::ldexp(
        next_up(std::sqrt(most) * (1 + WATCHED("volumes: the stretch is rounded", 8 * unit_roundoff))), exponent);
    rows_ = pose.rotation.cwiseAbs().rowwise().sum().maxCoeff();
}

// The pose maps x to R x + t. A point of the volume is sum w_i c_i + e, with corners c_i, weights w_i >= 0 that add
// up to 1, and |e| <= radius. Exactly, it moves to sum w_i (R c_i + t) + R e, and |R e| <= stretch_ * radius.
//
// Rounding, with u = 2^-53: let m be the largest |coordinate| of a corner plus the radius, and G = rows_ * m + max
// |t_k|. G bounds every |coordinate| that occurs. fl(R x + t) errs by 4.01u * G in each coordinate, so by less than
// 7u * G in length. This happens twice, for the corner and for the point of the volume: 14u * G. The code adds 15u *
// G, because G as computed (`most`) may be too small by 4u of itself. If G overflows, the radius is infinite.
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
    const double most = rows_ * (m + volume.radius) +
                        WATCHED("volumes: a translation is rounded too", pose_.translation.cwiseAbs().maxCoeff());
    result.radius =
        next_up(WATCHED_ELSE("volumes: a pose stretches the radius", next_up(stretch_ * volume.radius), volume.radius) +
                WATCHED("volumes: a pose is rounded", 15 * unit_roundoff * most));
    if (!(result.radius < std::numeric_limits<double>::infinity()))
        result.radius =
            WATCHED("volumes: nothing is known where a pose overflows", std::numeric_limits<double>::infinity());
    return result;
}

}  // namespace hausbench::tang
