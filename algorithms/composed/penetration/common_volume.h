// Computes the common volume of two solids as a list of connected parts. The boundary of each part is split into its
// triangles from A and its triangles from B.
//
// Source: Tang et al. 2009, section 7.3, step 1. CGAL's corefinement does the cutting. It decides exactly which
// triangles cross, and on which side of B a part of A lies, but it rounds the points where triangles cross to doubles.
// So nothing here is certified.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <memory>
#include <string>
#include <vector>

namespace hausbench::penetration {

// A closed mesh prepared for intersection: coincident vertices are merged, and all triangles face outward.
class Solid {
public:
    explicit Solid(const TriangleMesh& mesh);  // O(n log n) plus the number of self-intersections
    ~Solid();
    Solid(Solid&&) noexcept;

    // Returns the reason why the mesh bounds no volume: it is open, crosses itself, or is not a manifold. Returns an
    // empty string if the mesh bounds a volume.
    const std::string& flaw() const { return flaw_; }

    Points posed(const Pose& pose) const { return hausbench::posed(vertices_, pose); }
    std::size_t bytes() const;

private:
    struct Faces;
    friend struct VolumeCutting;

    Points vertices_;
    std::string flaw_;
    std::unique_ptr<Faces> faces_;
};

// The boundary of one connected part of the common volume, as the triangles from A and the triangles from B. A triangle
// that belongs to both A and B, facing the same way, is in both meshes. If the part lies inside one of the solids, the
// mesh of that solid is empty.
struct CommonPart {
    TriangleMesh of_source, of_target;
};

struct CommonVolume {
    std::vector<CommonPart> parts;  // the part with the largest box first
    std::string failure;            // why cutting failed, or empty
};

// Intersects two solids. Neither may have a flaw(). Places where they only touch have no volume and are left out.
CommonVolume common_volume(const Solid& source, const Pose& source_pose, const Solid& target, const Pose& target_pose);

}  // namespace hausbench::penetration
