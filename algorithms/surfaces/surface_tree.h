// An algebraic surface as an octree of boxes that is refined on demand. It has a linear enclosure of the surface in
// each box, and finds points that are proven to lie on the surface.
//
// The caller of every function must hold an UpwardRounding (kernel/interval.h), which sets the rounding mode.
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/surfaces/surface_piece.h"

#include <optional>

namespace hausbench {

// A *proven point*: the surface contains some point within the distance `error` of `at`. The proof is that the
// polynomial changes sign on a segment through `at` that lies in the box of the surface.
struct SurfacePoint {
    Vec3 at;
    double error;
};

// An octree over the box of a surface. A box has no node if interval arithmetic proves that it contains no point of the
// surface.
class SurfaceTree {
public:
    struct Node : SurfacePiece {
        std::int32_t first = -1;  // the first child; -1: not split yet
        std::int32_t count = 0;
        std::int32_t depth = 0;
    };

    explicit SurfaceTree(const AlgebraicSurface& surface);

    const Node& operator[](std::int32_t i) const { return nodes_[static_cast<std::size_t>(i)]; }
    // Returns the number of nodes; 0 means that the surface has no point in its box.
    std::size_t size() const { return nodes_.size(); }
    const Box& box() const { return box_; }
    const Polynomial& polynomial() const { return evaluator_.polynomial(); }
    const Polynomial& derivative(int axis) const { return derivatives_[static_cast<std::size_t>(axis)].polynomial(); }

    // Splits node i unless it is split already: halves its box along each axis and keeps the children that may contain
    // a point of the surface. Does not halve an axis if no double lies between the two sides of the box. Call it only
    // if may_split(i). Invalidates references to nodes.
    void split(std::int32_t i, Counters& counters);
    // Returns whether the box of node i is large enough to be split.
    bool may_split(std::int32_t i) const;

    // Return, for any box, a linear enclosure of the polynomial, and an interval that contains the values of its
    // derivative along an axis.
    LinearForm form(const Box& box, Counters& counters);
    Interval derivative(int axis, const Box& box, Counters& counters);

    // A point z of the surface at which z - p is normal to the surface, so that the distance from p is stationary. z
    // and the factor m solve z - p + m * grad f(z) = 0 and f(z) = 0.
    struct CriticalPoint {
        Vec3 at;
        double factor;            // m
        Eigen::Matrix4d inverse;  // of the Jacobian of these equations near z
    };
    // Searches for a CriticalPoint with Newton's method, starting from `start`. The result is not proven. Returns
    // nothing if the method fails.
    std::optional<CriticalPoint> newton(const Vec3& p, const Vec3& start) const;

    // Searches for the point of the surface nearest to p, starting from `seed`, and returns a proven point near it. If
    // several points are about equally near, returns any of them. Returns nothing if no point could be proven, which
    // does not mean that there is none.
    std::optional<SurfacePoint> nearby(const Vec3& p, const Vec3& seed, Counters& counters) const;

private:
    std::optional<SurfacePoint> prove(const Vec3& p, Counters& counters) const;

    Box box_;
    FormEvaluator evaluator_;
    std::array<FormEvaluator, 3> derivatives_;
    std::vector<Node> nodes_;
};

}  // namespace hausbench
