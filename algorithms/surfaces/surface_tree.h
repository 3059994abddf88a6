// An algebraic surface as a tree of boxes that is refined on demand, with the data for the bounds of
// surface_enclosure.cpp: linear enclosures of its pieces, and points that are proven to lie on it.
//
// All functions require UpwardRounding (kernel/interval.h).
#pragma once

#include "algorithms/kernel/counters.h"
#include "algorithms/surfaces/surface_piece.h"

#include <optional>

namespace hausbench {

// A proof that some point of the surface is within `error` of `at`: the polynomial changes its sign on a segment
// through `at` that lies in the box of the surface.
struct SurfacePoint {
    Vec3 at;
    double error;
};

class SurfaceTree {
public:
    struct Node : SurfacePiece {
        std::int32_t first = -1;  // child; -1: not split yet
        std::int32_t count = 0;   // children kept
        std::int32_t depth = 0;
    };

    explicit SurfaceTree(const AlgebraicSurface& surface);

    const Node& operator[](std::int32_t i) const { return nodes_[static_cast<std::size_t>(i)]; }
    std::size_t size() const { return nodes_.size(); }  // 0: the surface has no point in its box
    const Box& box() const { return box_; }
    const Polynomial& polynomial() const { return evaluator_.polynomial(); }
    const Polynomial& derivative(int axis) const { return derivatives_[static_cast<std::size_t>(axis)].polynomial(); }

    // Makes the children that may contain a point of the surface, if not done yet. An axis is divided only if a
    // double lies between the sides of the box, so that no child equals the box: ask may_split() first. Invalidates
    // references into the tree.
    void split(std::int32_t i, Counters& counters);
    bool may_split(std::int32_t i) const;  // whether the box is still larger than rounding

    // Return an enclosure of f over any box, and the range of its derivative along an axis.
    LinearForm form(const Box& box, Counters& counters);
    Interval derivative(int axis, const Box& box, Counters& counters);

    // A critical point z of the distance from p, found by Newton's method on z - p + m grad f(z) = 0 and f(z) = 0;
    // not proven.
    struct CriticalPoint {
        Vec3 at;
        double factor;            // m
        Eigen::Matrix4d inverse;  // of the Jacobian, near z
    };
    std::optional<CriticalPoint> newton(const Vec3& p, const Vec3& start) const;

    // Searches from a seed for the point of the surface nearest to p and returns a proven point near it; if several
    // points are about nearest, any of them. Returns nothing if no point could be proven, which does not mean that
    // there is none.
    std::optional<SurfacePoint> nearby(const Vec3& p, const Vec3& seed, Counters& counters) const;

private:
    std::optional<SurfacePoint> prove(const Vec3& p, Counters& counters) const;

    Box box_;
    FormEvaluator evaluator_;
    std::array<FormEvaluator, 3> derivatives_;
    std::vector<Node> nodes_;
};

}  // namespace hausbench
