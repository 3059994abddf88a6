// Checks a certificate of an upper bound on h(A,B) (docs/certificate.md). A certificate contains a tree of cuts for
// each triangle of A. The cuts divide the triangle into polygons, the leaves of the tree; each leaf names one triangle
// of B. The check shares no kernel with the solvers: it reads the bytes, cuts the triangles of A itself and bounds each
// distance from above in interval arithmetic.
//
// The bound that it finds holds for any bytes, for two reasons. A cut divides a polygon into two whose union is the
// polygon, so the leaves of a tree cover the triangle. And the distance of a polygon to its triangle of B is bounded
// either by the distances of its corners, since the distance to a triangle is a convex function (leaf `one`), or by the
// triangle inequality through one point (leaves `centre` and `vertex`). So a certificate may come from anywhere; a
// wrong index makes the bound larger, not wrong.
#pragma once

#include "algorithms/scene.h"
#include "algorithms/solver.h"

#include <cstdint>
#include <string>

namespace hausbench {

struct CertificateCheck {
    bool accepted = false;
    std::string refusal;     // one line with the reason; empty: accepted
    double found = 0;        // proven upper bound on h(A,B); infinite: the bytes are not a certificate of A
    Index worst = -1;        // the triangle of A with the largest bound
    std::uint64_t cuts = 0;  // number of nodes of each kind: cuts, and three kinds of leaves
    std::uint64_t one = 0, centre = 0, vertex = 0;
    double seconds = 0;

    std::uint64_t leaves() const { return one + centre + vertex; }
};

// Checks a certificate of h(A,B) or, if its direction is target_to_source, of h(B,A). Refuses algebraic surfaces. Never
// throws because of the content of the certificate. O(bytes) time; O(|A| + |B|) memory, whatever the bytes say.
CertificateCheck check_certificate(const Shape& source, const Pose& source_pose, const Shape& target,
                                   const Pose& target_pose, const Certificate& certificate);

}  // namespace hausbench
