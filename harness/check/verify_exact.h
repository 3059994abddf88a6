// Distances of points to a posed shape for the harness's own checks: exact, in rationals, and proven, in interval arithmetic.
// Shares no kernel, no tree and no rounding rule with the solvers.
#pragma once

#include "harness/check/exact_roots.h"
#include "harness/check/verify.h"

#include <optional>
#include <vector>

namespace hausbench {

using Element = std::vector<Vec3>;  // one corner or three

// A shape (points or a mesh, which must outlive it) where it stands. Points are posed when it is made, in round-to-nearest.
class Standing {
public:
    Standing(const Shape& shape, const Pose& pose);
    Standing(const Standing&) = delete;

    Index count() const { return element_count(shape_); }
    const Points& points() const { return *points_; }
    bool finite() const { return points_->allFinite(); }
    Element operator[](Index i) const;

    // Whether some coordinate of all corners of an element is more than r away from p's, on one side: then every
    // point of it is. This is a proof in round-to-nearest, because a difference of at most r is not rounded to more
    // than r.
    bool beyond(Index i, const Vec3& p, double r) const;

private:
    const Shape& shape_;
    const Points* points_;
    Points moved_;
};

Rational squared_distance(const Vec3& p, const Element& e);

// From p to a foot on the element that is about the nearest; only its quality, not the proof, hangs on it.
Vec3 rough_offset(const Vec3& p, Element e);

// The least squared distance from p to those elements that interval arithmetic does not prove to be at least r away; none where it
// settles all. `stopped` is set, and nothing said, where `stop` asks for that. O(count).
std::optional<Rational> nearer_than(const Standing& shape, const Vec3& p, double r, const Stop& stop, bool& stopped);

}  // namespace hausbench
