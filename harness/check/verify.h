// Checks the bounds that solvers report. For points and meshes it shares no kernel, no tree and no rounding rule with
// the solvers; verify_surface.h lists the code that is shared for surfaces.
//
// Lower bound, from its witness p: with e = distance from p to A posed, h(A posed, B posed) >= d(p, B posed) - e, so `lower`
// holds if every element of B posed is at least lower + e away from p. A lower bound of H may have its witness on B instead
// (Witness::direction): the same with A and B in each other's place. An element whose box is not that far away is tried with a
// separating plane in interval arithmetic (a convex set T is at least min over its corners v of n.(p - v)/|n| away, for any n),
// then, where that is not enough, in exact rationals. e is computed in exact rationals. O(|A| + |B|) a witness.
//
// A lower bound without a witness is refuted if it is above a certified solver's upper bound; else it stays `no witness`.
//
// Upper bound: not below a verified lower bound of the same shapes and poses by any solver. That can refute, not prove. A lower
// bound of h(A,B) or of h(B,A) is one of H, but none of H is one of h.
//
// Reference answers (plan/references.h) are held against the rows likewise: their lower bounds count once their witness is checked, their upper
// bounds only if they are proven, by a certificate that was checked or point by point (verify_upper.h).
//
// A penetration depth has a check of its own, see verify_penetration.h.
//
// A row that is not certified may be off by what rounding explains, 84 * 2^-53 of the largest |coordinate| (verify.cpp derives it);
// a certified row may be off by nothing.
#pragma once

#include "harness/result/result_file.h"

#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace hausbench {

// Called now and then; once it returns true, the remaining rows stay `not checked`.
using Stop = std::function<bool()>;

// Two shapes (points or meshes, which must outlive it), to re-check several witnesses on.
class Checker {
public:
    Checker(const Shape& source, const Shape& target, Stop stop = {});

    // Returns whether the witness proves `lower` (finite), see above; if not, `shown` is the distance that it does
    // show (rounded down). `not_checked` if a pose takes a shape out of the range of doubles.
    Verdict lower(double lower, const Witness& witness, const Pose& source_pose, const Pose& target_pose,
                  double& shown) const;

private:
    const Shape &source_, &target_;
    Stop stop_;
};

// Fills in every row's check, whatever it said before; rows found unsound get that status, with the reason. `load` returns
// the shape of a model by name, or null: its rows stay `not checked`. Rows read off a trace have the witness of the finer
// run: their lower bound is checked by it, too.
// Rows from number `checked` on have been checked before: they are checked again only where that was left undone, or a row
// before them is of the same shapes in the same poses.
void verify_rows(std::vector<Row>& rows, const std::function<const Shape*(const std::string&)>& load,
                 const Stop& stop = {}, std::size_t checked = std::numeric_limits<std::size_t>::max());

// The same for the rows and the reference answers of a result together. Then gives each row the bounds of the narrowest reference of the same
// distance (shapes, poses, quantity) that is not unsound; NaN if there is none.
void verify_rows(std::vector<Row>& rows, std::vector<Row>& references,
                 const std::function<const Shape*(const std::string&)>& load, const Stop& stop = {},
                 std::size_t checked = std::numeric_limits<std::size_t>::max());

}  // namespace hausbench
