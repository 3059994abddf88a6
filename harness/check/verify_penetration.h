// Re-checks a penetration depth (Quantity in solver.h), independently of the solver and of its cutting.
//
// The common volume of the solids A and B consists of connected *parts*. Some of a part's boundary comes from the
// surface of A, the rest from the surface of B. The depth is the largest Hausdorff distance between the two, over all
// parts. The check never computes the parts, only whether points lie inside A and B (by the parity of exact crossings
// of a ray) and how far they are from the other surface (verify_exact.h).
//
// Lower bound, from its witness p: a point on the surface of one solid, here called the *own* solid, that lies inside
// the other solid. So p is on the boundary of a part, the part of p. The bound holds if the other surface has no point
// on the boundary of this part that is nearer to p than `lower`. The triangles of the other surface nearer than `lower`
// are judged one by one:
// - A triangle does not count if its points nearer than `lower` are proven to lie outside the own solid, because such
//   points are on the boundary of no part. Exception: if the other surface bounds the part of p nowhere, the other mesh
//   encloses the part, and every point of that mesh counts.
// - A nearer point that is joined to p by a segment inside both solids bounds the part of p and refutes the bound.
// - In any other case the verdict is `not checked`, because the nearer points may bound another part.
//
// Upper bound: a vertex of one mesh inside the other solid bounds a part, so the depth is at least the distance from
// this vertex to the other surface. This can refute an upper bound, not prove it.
//
// No solver certifies a depth: the points at which surfaces cut each other are rounded, and more so the more parallel
// the triangles are. So with s = 1e-10 times the largest |coordinate|, the check allows points to be off by 2s and
// bounds by 4s.
#pragma once

#include "harness/check/verify.h"
#include "harness/result/result_file.h"

namespace hausbench {

// Checks penetration depths of two closed meshes in fixed poses. Use one checker for all rows of a pair, because it
// reuses earlier results.
class PenetrationChecker {
public:
    PenetrationChecker(const Shape& source, const Pose& source_pose, const Shape& target, const Pose& target_pose,
                       Stop stop = {});
    ~PenetrationChecker();

    // Checks the bounds of one row. O(|A| |B|) if the upper bound must be compared with all vertices.
    Check check(const Bounds& bounds, const Witness& witness);

    // Returns whether the upper bound is below a lower bound that an earlier check() verified; if so, sets `reason`.
    bool refutes(const Bounds& bounds, std::string& reason) const;

private:
    struct Pair;
    std::unique_ptr<Pair> pair_;
};

}  // namespace hausbench
