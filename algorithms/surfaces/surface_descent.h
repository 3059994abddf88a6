// Finds points of an algebraic surface in its box with plain floating-point arithmetic; nothing is proven.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/polynomial.h"

namespace hausbench {

class SurfaceDescent {
public:
    // Keeps references to both arguments.
    SurfaceDescent(const Polynomial& polynomial, const Box& box) : polynomial_(polynomial), box_(box) {}

    bool holds(const Vec3& p) const { return p == clamped(p); }

    // Returns a point of the box near y at which the polynomial is 0 up to rounding, if Newton's method finds one.
    // Otherwise returns the last point that it reached.
    Vec3 onto(Vec3 y) const;

    // Returns a point of the surface whose distance to p is about a local minimum. Starts from y, a point of the
    // surface, and moves along the surface as long as the distance to p decreases.
    Vec3 descend(const Vec3& p, Vec3 y) const;

private:
    Vec3 clamped(const Vec3& p) const { return p.cwiseMax(box_.low).cwiseMin(box_.high); }
    bool step_onto(Vec3& y, double ulp) const;
    Vec3 tangent_foot(const Vec3& p, const Vec3& y) const;

    const Polynomial& polynomial_;
    const Box& box_;
};

}  // namespace hausbench
