// Points of an algebraic surface in its box, found in plain arithmetic: nothing is proven.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/polynomial.h"

namespace hausbench {

class SurfaceDescent {
public:
    // References are kept.
    SurfaceDescent(const Polynomial& polynomial, const Box& box) : polynomial_(polynomial), box_(box) {}

    bool holds(const Vec3& p) const { return p == clamped(p); }  // whether the box does

    // A point of the surface near y.
    Vec3 onto(Vec3 y) const;

    // From a point y of the surface to one that is about the nearest to p, if the way goes down all along.
    Vec3 descend(const Vec3& p, Vec3 y) const;

private:
    Vec3 clamped(const Vec3& p) const { return p.cwiseMax(box_.low).cwiseMin(box_.high); }
    bool step_onto(Vec3& y, double ulp) const;
    Vec3 tangent_foot(const Vec3& p, const Vec3& y) const;

    const Polynomial& polynomial_;
    const Box& box_;
};

}  // namespace hausbench
