// Checks a certificate of an upper bound on the directed Hausdorff distance h(A,B) (format: docs/certificate.md). For
// each triangle of A, a certificate contains a tree of cuts. The cuts divide the triangle into polygons, the leaves of
// the tree; each leaf names one triangle of B. The checker shares no kernel with the solvers: it reads the bytes, cuts
// the triangles of A itself, and bounds each distance from above in interval arithmetic.
//
// The computed bound is true for any bytes, for two reasons. A cut divides a polygon into two whose union is the
// polygon, so the leaves cover the triangle. And the distance from a leaf to its triangle of B is bounded by the
// distances of its corners, because the distance to a triangle is a convex function (leaf kind `one`), or by the
// triangle inequality through one point (leaf kinds `centre` and `vertex`). So a wrong index makes the bound larger,
// not wrong.
#pragma once

#include "algorithms/scene.h"
#include "algorithms/solver.h"

#include <cstdint>
#include <functional>
#include <string>

namespace hausbench {

struct CertificateCheck {
    bool accepted = false;
    std::string refusal;     // one line with the reason; empty: accepted
    double found = 0;        // upper bound that the leaves prove; infinite if the certificate cannot be read
    Index worst = -1;        // the triangle of A with the largest bound
    std::uint64_t cuts = 0;  // number of nodes of each kind: cuts, and three kinds of leaves
    std::uint64_t one = 0, centre = 0, vertex = 0;
    double seconds = 0;

    std::uint64_t leaves() const { return one + centre + vertex; }
};

// Checks a certificate of h(A,B), or of h(B,A) if its direction is target_to_source. Refuses algebraic surfaces. Never
// throws because of the certificate's content. Takes O(bytes) time and O(|A| + |B|) memory for any bytes. `looking`, if it
// is not empty, is called before each thousandth triangle.
CertificateCheck check_certificate(const Shape& source, const Pose& source_pose, const Shape& target,
                                   const Pose& target_pose, const Certificate& certificate,
                                   const std::function<void()>& looking = {});

}  // namespace hausbench
