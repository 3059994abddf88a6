// Distances from points to a shape in its pose, for checking solvers: exact in rationals, or bounded in interval
// arithmetic. Shares no kernel, no tree and no rounding rule with the solvers.
#pragma once

#include "harness/check/exact_roots.h"
#include "harness/check/verify.h"

#include <optional>
#include <vector>

namespace hausbench {

using Element = std::vector<Vec3>;  // the corners: one for a point, three for a triangle

// A point set or mesh moved by its pose. The shape must outlive this object. The constructor computes the moved points;
// call it while rounding is to nearest.
class Standing {
public:
    Standing(const Shape& shape, const Pose& pose);
    Standing(const Standing&) = delete;

    Index count() const { return element_count(shape_); }
    const Points& points() const { return *points_; }
    bool finite() const { return points_->allFinite(); }
    Element operator[](Index i) const;

    // Returns true if along some axis all corners of element i are more than r away from p, on the same side. Then the
    // whole element is. Rounding the differences to nearest is safe, because a difference of at most r never rounds to
    // more than r.
    bool beyond(Index i, const Vec3& p, double r) const;

private:
    const Shape& shape_;
    const Points* points_;
    Points moved_;
};

Rational squared_distance(const Vec3& p, const Element& e);

// Returns the vector from p to the nearest point of the element, computed in doubles. No proof depends on its accuracy.
Vec3 rough_offset(const Vec3& p, Element e);

// Decides whether the shape is at least r away from p: it is if the result is nothing, or at least r^2. Skips elements
// that beyond() or interval arithmetic proves to be at least r away. Returns the smallest exact squared distance of the
// others, or nothing if all were skipped. If `stop` ends the search, sets `stopped` and returns nothing. O(count).
std::optional<Rational> nearer_than(const Standing& shape, const Vec3& p, double r, const Stop& stop, bool& stopped);

}  // namespace hausbench
