// Distances of points to a posed shape for the harness's own checks: exact in rationals, or proven in interval
// arithmetic. Shares no kernel, no tree and no rounding rule with the solvers.
#pragma once

#include "harness/check/exact_roots.h"
#include "harness/check/verify.h"

#include <optional>
#include <vector>

namespace hausbench {

using Element = std::vector<Vec3>;  // one corner or three

// A shape in its pose: points or a mesh, which must outlive this object. The constructor poses the points, in
// round-to-nearest.
class Standing {
public:
    Standing(const Shape& shape, const Pose& pose);
    Standing(const Standing&) = delete;

    Index count() const { return element_count(shape_); }
    const Points& points() const { return *points_; }
    bool finite() const { return points_->allFinite(); }
    Element operator[](Index i) const;

    // Returns whether along some axis all corners of an element are more than r away from p, on the same side; then
    // every point of the element is. This is a proof in round-to-nearest, because a difference of at most r never
    // rounds to more than r.
    bool beyond(Index i, const Vec3& p, double r) const;

private:
    const Shape& shape_;
    const Points* points_;
    Points moved_;
};

Rational squared_distance(const Vec3& p, const Element& e);

// Returns the vector from p to about the nearest point of the element. No proof depends on its accuracy.
Vec3 rough_offset(const Vec3& p, Element e);

// Returns the least squared distance from p to the elements that interval arithmetic cannot prove to be at least r
// away, or nothing if it settles all of them. If `stop` ends the search, sets `stopped` and returns nothing.
// O(count).
std::optional<Rational> nearer_than(const Standing& shape, const Vec3& p, double r, const Stop& stop, bool& stopped);

}  // namespace hausbench
