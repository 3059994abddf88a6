#include "algorithms/surfaces/surface_descent.h"

#include <cmath>

namespace hausbench {

// Applies Newton's method along the gradient. A coordinate in which a step would leave the box is fixed at
// the side of the box.
Vec3 SurfaceDescent::onto(Vec3 y) const {
    y = clamped(y);
    const double ulp = 0x1p-52 * y.cwiseAbs().maxCoeff();
    for (int step = 0; step < 8; ++step) {
        if (!step_onto(y, ulp)) break;
    }
    return y;
}

// Makes one step of Newton's method. Returns false if y is on the surface up to rounding, or if the gradient is 0 in
// the coordinates that are still free.
bool SurfaceDescent::step_onto(Vec3& y, double ulp) const {
    Vec3 free = Vec3::Ones();
    for (int tries = 0; tries < 4; ++tries) {  // each try fixes at least one coordinate to a side of the box
        Vec3 g;
        const double f = polynomial_.value(y, g);
        if (f == 0 || f * f <= ulp * ulp * g.squaredNorm()) return false;
        g = g.cwiseProduct(free);
        const double size = g.squaredNorm();
        if (!(size > 0)) return false;
        const Vec3 to = y - (f / size) * g, inside = clamped(to);
        if (to == inside) {
            y = to;
            return true;
        }
        for (int k = 0; k < 3; ++k) {
            if (to[k] != inside[k]) {
                y[k] = inside[k];
                free[k] = 0;
            }
        }
    }
    return true;
}

// Repeats a step as long as it comes nearer to p: finds the point nearest to p on the tangent plane at y, within the
// box, and moves it to the surface.
Vec3 SurfaceDescent::descend(const Vec3& p, Vec3 y) const {
    double distance = (p - y).squaredNorm();
    for (int step = 0; step < 24; ++step) {
        Vec3 to = onto(tangent_foot(p, y));
        const double next = (p - to).squaredNorm();
        if (next < distance) {
            const bool settled = next > distance * (1 - 1e-13);
            distance = next;
            y = to;
            if (settled) break;
        } else {  // too far along the tangent: halves the step, once per iteration
            to = onto(Vec3(0.5 * (y + to)));
            const double half = (p - to).squaredNorm();
            if (!(half < distance)) break;
            distance = half;
            y = to;
        }
    }
    return y;
}

// Returns the point of the tangent plane at y that is nearest to p. If this point lies outside the box, returns a point
// of the plane near the box instead, about the one nearest to p.
Vec3 SurfaceDescent::tangent_foot(const Vec3& p, const Vec3& y) const {
    Vec3 g;
    const double f = polynomial_.value(y, g);
    const double size = g.squaredNorm();
    if (!(size > 0)) return p;
    const Vec3 foot = p - ((f + g.dot(p - y)) / size) * g, inside = clamped(foot);
    if (foot == inside) return foot;
    // Sets each coordinate that is outside the box to the side of the box, then moves along the other coordinates onto
    // the plane.
    Vec3 to = p;
    for (int k = 0; k < 3; ++k) {
        if (foot[k] != inside[k]) to[k] = inside[k];
    }
    Vec3 free = g;
    for (int k = 0; k < 3; ++k) {
        if (to[k] == box_.low[k] || to[k] == box_.high[k]) free[k] = 0;
    }
    const double left = free.squaredNorm();
    return left > 0 ? Vec3(to - ((f + g.dot(to - y)) / left) * free) : to;
}

}  // namespace hausbench
