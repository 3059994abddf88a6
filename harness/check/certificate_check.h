// Checks a certificate of an upper bound of h(A,B) (docs/certificate.md). Shares no kernel with the solvers: it reads the bytes, cuts the
// triangles of A itself and bounds each distance from above in interval arithmetic.
//
// The bound that it returns holds, whatever the bytes are: each triangle of A is the union of its polygons, as their tree shows, and a polygon
// lies within its bound of B since the distance to one triangle is convex (`one`), or by the triangle inequality (`centre`,
// `vertex`). So a certificate may come from anywhere, and a wrong index makes the bound larger, not wrong.
#pragma once

#include "algorithms/scene.h"
#include "algorithms/solver.h"

#include <cstdint>
#include <string>

namespace hausbench {

struct CertificateCheck {
    bool accepted = false;
    std::string refusal;     // one line, why not; empty: accepted
    double found = 0;        // proven upper bound of h(A,B); infinite: not a certificate of A
    Index worst = -1;        // the triangle of A with that bound
    std::uint64_t cuts = 0;  // nodes by kind
    std::uint64_t one = 0, centre = 0, vertex = 0;
    double seconds = 0;

    std::uint64_t leaves() const { return one + centre + vertex; }
};

// Both shapes are points or meshes. For a certificate of h(B,A), A and B change places. Never throws because of the
// certificate's content. O(bytes) time; O(|A| + |B|) memory, whatever the bytes.
CertificateCheck check_certificate(const Shape& source, const Pose& source_pose, const Shape& target,
                                   const Pose& target_pose, const Certificate& certificate);

}  // namespace hausbench
