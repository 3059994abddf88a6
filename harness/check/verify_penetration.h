// Re-checks a penetration depth, independently of the solver and of its cutting. The common volume is never
// computed here, only whether points lie inside A and B (by the parity of exact crossings of a ray) and how far
// they are from the other surface (verify_exact.h).
//
// Lower bound, from the witness p, a point of one surface in the other solid: it holds if no point of the other
// surface that bounds the same part of the common volume is nearer to p than `lower`. A nearer triangle does not
// count if its nearer part is proven to lie outside the first solid. But if the other mesh alone encloses the part,
// all of that mesh counts. A nearer point that is joined to p by a segment inside both solids refutes the bound.
// Otherwise the row stays `not checked`, because the nearer points may bound another part.
//
// Upper bound: a vertex of one mesh inside the other solid bounds the common volume, so the depth is at least its
// distance to the other surface. This can refute, not prove.
//
// No solver certifies a depth, since cut points are rounded, by more if triangles are nearly parallel. So bounds
// may be off by 1e-10 of the largest |coordinate|.
#pragma once

#include "harness/check/verify.h"
#include "harness/result/result_file.h"

namespace hausbench {

// Checks depths of two closed meshes, each in its pose. All checks of a pair share the work on its vertices.
class PenetrationChecker {
public:
    PenetrationChecker(const Shape& source, const Pose& source_pose, const Shape& target, const Pose& target_pose,
                       Stop stop = {});
    ~PenetrationChecker();

    Check check(const Bounds& bounds, const Witness& witness);

    // Returns whether an upper bound is below a lower bound that held in an earlier check.
    bool refutes(const Bounds& bounds, std::string& reason) const;

private:
    struct Pair;
    std::unique_ptr<Pair> pair_;
};

}  // namespace hausbench
