// The volume that two solids have in common, in connected parts, each with its surface cut in two: what is of A and what is of B.
//
// Source: Tang et al. 2009, section 7.3, step 1. The cutting is CGAL's corefinement: which triangles cross, and on which side of B a part of A lies, is
// decided exactly; the points where they cross are rounded to doubles. So nothing here is certified.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <memory>
#include <string>
#include <vector>

namespace hausbench {

// A closed mesh, ready to be cut. Vertices with equal coordinates become one; its triangles are turned so that they face outward.
class Solid {
public:
    explicit Solid(const TriangleMesh& mesh);  // o(n log n), plus the number of self-intersections
    ~Solid();
    Solid(Solid&&) noexcept;

    // Why the mesh bounds no volume: it is open, crosses itself, is no manifold; empty where it does.
    const std::string& flaw() const { return flaw_; }

    Points posed(const Pose& pose) const { return hausbench::posed(vertices_, pose); }
    std::size_t bytes() const;

private:
    struct Faces;
    friend struct Cutting;

    Points vertices_;
    std::string flaw_;
    std::unique_ptr<Faces> faces_;
};

// One connected part of the volume. Where A and B lie in one plane and face the same way, the surface is of both. Without triangles: the part is
// enclosed by the other mesh alone.
struct CommonPart {
    TriangleMesh of_source, of_target;
};

struct CommonVolume {
    std::vector<CommonPart> parts;  // the one with the largest box first
    std::string failure;            // why there are none, where it could not be cut
};

// Of solids without a flaw. Parts of volume zero, where the two only touch, are none.
CommonVolume common_volume(const Solid& source, const Pose& source_pose, const Solid& target, const Pose& target_pose);

}  // namespace hausbench
