// Re-checks the answers of solvers. For points and meshes it shares no kernel, no tree and no rounding rule with
// the solvers; verify_surface.h says which code is shared for surfaces.
//
// Lower bound, from its witness p: let e be the distance from p to A posed. As h(A posed, B posed) >=
// d(p, B posed) - e, `lower` holds if every element of B posed is at least lower + e away from p. A lower bound of H may have its
// witness on B instead (Witness::direction); A and B then swap roles. If the box of an element is nearer than that,
// the element is tried with a separating plane in interval arithmetic (for any n, a convex set T is at least the
// minimum over its corners v of n.(p - v)/|n| away), then, if that is not enough, in exact rationals. e is computed
// in exact rationals. O(|A| + |B|) per witness.
//
// A lower bound without a witness is refuted if it is above a certified solver's upper bound; otherwise it stays
// `no witness`.
//
// Upper bound: it must not be below a lower bound of the same shapes and poses that was verified for any solver.
// This can refute, not prove. A lower bound of h(A,B) or of h(B,A) is also one of H, but not the other way round.
//
// Reference answers (plan/references.h) are compared with the rows in the same way: a lower bound counts once its
// witness is checked, an upper bound only if it is proven, by a checked certificate or point by point
// (verify_upper.h).
//
// Penetration depths have their own check, see verify_penetration.h.
//
// Bounds that are not certified may be off by as much as rounding explains, 84 * 2^-53 of the largest |coordinate|
// (verify.cpp derives it); a certified row gets no slack.
#pragma once

#include "harness/result/result_file.h"

#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace hausbench {

// Polled from time to time; once it returns true, everything not checked yet stays `not checked`.
using Stop = std::function<bool()>;

// Checks witnesses on two shapes: points or meshes, which must outlive it.
class Checker {
public:
    Checker(const Shape& source, const Shape& target, Stop stop = {});

    // Returns whether the witness proves `lower` (finite), see above. If not, `shown` is the lower bound that it
    // does prove, rounded down. Returns `not_checked` if a pose moves a shape out of the range of doubles.
    Verdict lower(double lower, const Witness& witness, const Pose& source_pose, const Pose& target_pose,
                  double& shown) const;

private:
    const Shape &source_, &target_;
    Stop stop_;
};

// Fills in every row's check, overwriting earlier results; rows found unsound get that status and the reason.
// `load` returns the shape of a model by name, or null: its rows then stay `not checked`. A row read off a trace
// has the witness of the finer run, and its lower bound is checked by that witness.
// Rows from number `checked` on were checked before. They are checked again only if that was left unfinished, or if
// an earlier row has the same shapes in the same poses.
void verify_rows(std::vector<Row>& rows, const std::function<const Shape*(const std::string&)>& load,
                 const Stop& stop = {}, std::size_t checked = std::numeric_limits<std::size_t>::max());

// Does the same for the rows and the reference answers of a result together. Then gives each row the bounds of the
// narrowest reference answer of the same distance (shapes, poses, quantity) that is not unsound; NaN if there is
// none.
void verify_rows(std::vector<Row>& rows, std::vector<Row>& references,
                 const std::function<const Shape*(const std::string&)>& load, const Stop& stop = {},
                 std::size_t checked = std::numeric_limits<std::size_t>::max());

}  // namespace hausbench
