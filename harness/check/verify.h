// Re-checks the answers of solvers. For points and meshes, it shares no kernel, no tree and no rounding rule with the
// solvers; verify_surface.h says which code is shared for surfaces.
//
// Below, A and B are the shapes moved by their poses, and d is the distance.
//
// Lower bound, from its witness p, which should lie on A: let e = d(p, A), which is 0 if p lies exactly on A. Because
// h(A,B) >= d(p, B) - e, `lower` holds if every element T of B is at least r = lower + e away from p. One of three
// tests must show this; they are tried in this order:
// - Along some axis, all corners of T are more than r away from p, on the same side.
// - A plane separates T from the ball of radius r around p, in interval arithmetic: for any vector n, the convex set T
//   is at least min n.(p - v) / |n| away from p, where the minimum is over the corners v of T.
// - The exact distance of T from p, in rationals, is at least r.
// e is computed in rationals, too. Each witness takes O(|A| + |B|) time. The witness of a lower bound on H may lie on B
// instead (Witness::direction); A and B then swap roles.
//
// A lower bound without a witness is refuted if it is above a certified solver's upper bound; otherwise its verdict is
// `no witness`.
//
// Upper bound: it must not be below a lower bound on the same distance that was verified for any solver. This can
// refute an upper bound, not prove it. A lower bound on h(A,B) or on h(B,A) is also a lower bound on H, but not the
// other way round.
//
// Reference answers (plan/references.h) are compared with the rows in the same way. A lower bound counts once its
// witness is checked, an upper bound only if it is proven, by a checked certificate or point by point (verify_upper.h).
//
// The largest distance among statistics ("maximum" and "maximum larger", by area) is checked like h(A,B) and H(A,B).
// Penetration depths and other statistics have their own checks, see verify_penetration.h and verify_statistics.h.
//
// Certified bounds must hold exactly. Other bounds may be off by as much as rounding explains, 84 * 2^-53 of the
// largest |coordinate| (verify.cpp derives it).
#pragma once

#include "harness/result/result_file.h"

#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace hausbench {

// Called from time to time during a check. Once it returns true, everything not checked yet stays `not checked`.
using Stop = std::function<bool()>;

// Checks lower bounds on the distance between two point sets or meshes. The shapes must outlive the checker.
class Checker {
public:
    Checker(const Shape& source, const Shape& target, Stop stop = {});

    // Returns `holds` if the witness proves `lower`, which must be finite. Otherwise returns `unsound` and sets `shown`
    // to the lower bound that the witness does prove, rounded down. Returns `not_checked` if a pose moves a shape out
    // of the range of doubles or the check was stopped.
    Verdict lower(double lower, const Witness& witness, const Pose& source_pose, const Pose& target_pose,
                  double& shown) const;

private:
    const Shape &source_, &target_;
    Stop stop_;
};

// Checks every row and overwrites earlier results. Rows found unsound get that status and the reason. `load` returns
// the shape of a model by name, or null; the rows of that model then stay `not checked`. A row read from the trace of a
// run with a finer tolerance has the witness of that run, which proves its smaller lower bound, too.
//
// The rows from index `checked` on were checked earlier. They are checked again only if that check was not finished, or
// if a row before `checked` has the same shapes in the same poses.
void verify_rows(std::vector<Row>& rows, const std::function<const Shape*(const std::string&)>& load,
                 const Stop& stop = {}, std::size_t checked = std::numeric_limits<std::size_t>::max());

// Checks the rows and the reference answers of a result together, like verify_rows() above. Then sets `reference` of
// each row to the bounds of the narrowest sound reference answer for the same shapes, poses and quantity, or to NaN if
// there is none.
void verify_rows(std::vector<Row>& rows, std::vector<Row>& references,
                 const std::function<const Shape*(const std::string&)>& load, const Stop& stop = {},
                 std::size_t checked = std::numeric_limits<std::size_t>::max());

}  // namespace hausbench
