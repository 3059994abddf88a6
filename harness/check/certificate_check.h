// Checks a certificate of an upper bound of h(A,B) (docs/certificate.md). Shares no kernel with the solvers: it
// reads the bytes, cuts the triangles of A itself and bounds each distance from above in interval arithmetic.
//
// The returned bound holds for any bytes: the tree shows that each triangle of A is the union of its polygons, and
// the bound of a polygon holds because the distance to one triangle is convex (`one`) or by the triangle inequality
// (`centre`, `vertex`). So a certificate may come from anywhere; a wrong index makes the bound larger, not wrong.
#pragma once

#include "algorithms/scene.h"
#include "algorithms/solver.h"

#include <cstdint>
#include <string>

namespace hausbench {

struct CertificateCheck {
    bool accepted = false;
    std::string refusal;     // one line with the reason; empty: accepted
    double found = 0;        // proven upper bound of h(A,B); infinite: not a certificate of A
    Index worst = -1;        // the triangle of A that attains it
    std::uint64_t cuts = 0;  // number of nodes of each kind
    std::uint64_t one = 0, centre = 0, vertex = 0;
    double seconds = 0;

    std::uint64_t leaves() const { return one + centre + vertex; }
};

// Checks a certificate of h(A,B), or of h(B,A) with A and B swapped. Refuses algebraic surfaces. Never throws
// because of the content of the certificate. O(bytes) time; O(|A| + |B|) memory, whatever the bytes say.
CertificateCheck check_certificate(const Shape& source, const Pose& source_pose, const Shape& target,
                                   const Pose& target_pose, const Certificate& certificate);

}  // namespace hausbench
