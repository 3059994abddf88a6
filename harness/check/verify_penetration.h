// Re-checks a penetration depth, independently of the solver and of its cutting: the volume that the two have in common is never computed here, only whether points
// lie inside of A and of B (the parity of exact crossings of a ray) and how far they are from the other surface (verify_exact.h).
//
// Lower bound, from the witness p, a point of one surface in the other solid: it holds if no point of the other surface that bounds the same part of the volume is nearer
// to p than `lower`. A nearer triangle does not count if its nearer part is proven to lie outside of the first solid. But if the other mesh alone encloses the part,
// the whole of that mesh counts. The bound is refuted by a nearer point that a segment inside both solids joins to p. Else the row stays `not checked`: the
// nearer points may bound another part.
//
// Upper bound: a vertex of one mesh inside of the other one bounds the volume, so that the depth is at least its distance to that other surface. That can refute, not prove.
//
// No depth is certified, because cut points are rounded, by more if triangles are nearly parallel: bounds may be off
// by 1e-10 of the largest |coordinate|.
#pragma once

#include "harness/check/verify.h"
#include "harness/result/result_file.h"

namespace hausbench {

// For closed meshes, each in its pose. Rows of the same pair share the results of the vertices.
class PenetrationChecker {
public:
    PenetrationChecker(const Shape& source, const Pose& source_pose, const Shape& target, const Pose& target_pose,
                       Stop stop = {});
    ~PenetrationChecker();

    Check check(const Bounds& bounds, const Witness& witness);

    // Whether an upper bound is below a lower bound that held in one of the checks before.
    bool refutes(const Bounds& bounds, std::string& reason) const;

private:
    struct Pair;
    std::unique_ptr<Pair> pair_;
};

}  // namespace hausbench
