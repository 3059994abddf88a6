// Writes a certificate of an upper bound of h(A,B): how the triangles of A are cut into polygons, and for each polygon a triangle of B
// that is near all of it. docs/certificate.md describes the format and why it proves the bound; harness/check/certificate_check.h checks it.
//
// Each triangle of A (a point of A is a triangle with three equal corners) has one tree in preorder: a node, its first child with all
// below it, its second child. A node is a convex polygon; the root has the three corners of the triangle, 0, 1, 2 in the order of
// the mesh. Edge i goes from corner i to corner i + 1, or to corner 0 from the last one.
//
// The proof is about exact points: a point on an edge is a + t (b - a) without rounding, where a and b are themselves exact. `proven` has
// to leave room for two things:
// - What the solver's own points and distances are off, if its upper bound does not hold for the exact polygons too.
// - What the check loses by rounding outward: for a leaf below L cuts at most (14 L + 100) u D, where u = 2^-53 and D is the diagonal of
//   the box of both shapes where they stand. A coordinate of a point p - q of the difference of the two triangles at hand is a sum
//   (a - s) + v e + w e' - (x f + y f'), of edges e, e' of A's and f, f' of B's triangle. A cut widens the weights v and w by 7u:
//   u for 1 - t, 2u for either product and 2u for the sum; so 7 L u (|e| + |e'|) <= 14 L u D. The rest is differences, products and
//   sums of lengths below D, each off by at most 4u of its value. (The tests measure it: certificate_soups_test.cpp.)
#pragma once

#include "algorithms/kernel/geometry.h"
#include "algorithms/solver.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

inline constexpr std::string_view cover_certificate_format = "hausbench cover 1";
inline constexpr std::size_t most_certificate_corners = 64;  // of a polygon
// Nodes waiting for their second child.
inline constexpr std::size_t most_certificate_pending = 4096;

// A point at which a cut meets the boundary of a polygon: a corner, or the place t along an edge. A point on an edge
// is always a new corner of both children, even if t is 0 or 1, so the shape of the children does not depend on t.
struct CutPoint {
    static CutPoint corner(std::size_t i) { return {i, -1, false}; }
    // From corner `edge` on.
    static CutPoint along(std::size_t edge, double t) { return {edge, t, false}; }
    // From the next corner backward.
    static CutPoint back(std::size_t edge, double t) { return {edge, t, true}; }

    std::size_t place;  // of the corner or edge
    double t;           // in [0, 1]; below 0: a corner
    bool backward;
};

// The tree of one triangle, as a solver goes along. Not shared by threads.
class CertificateTree {
public:
    // Cuts a node along the line from P to Q. Corners of the first child: P, those after P and before Q, Q. Corners of the
    // second one: Q, those after Q and before P, P. Each child must have at least three, and P and Q must not be on one edge.
    void cut(const CutPoint& p, const CutPoint& q);

    // Leaves. No point of the polygon is farther from B than
    // - one: the largest distance of a corner to triangle k of B. Never more than the two others say.
    // - centre: the distance of its centre, the mean of its corners, to triangle k, and the largest distance from there to a corner.
    // - vertex: the same, from vertex v of A (its row in the points of A) in place of the centre. Needs no distance of a corner.
    void one(Index k);
    void centre(Index k);
    void vertex(Index v, Index k);

    // Takes back the bytes written after a mark.
    std::size_t mark() const { return bytes_.size(); }
    void back_to(std::size_t mark) { bytes_.resize(mark); }
    void clear() { bytes_.clear(); }

    // What comes next was written elsewhere.
    void append(const CertificateTree& other) { bytes_ += other.bytes_; }

    const std::string& bytes() const { return bytes_; }

private:
    void number(std::uint64_t value);
    void parameter(const CutPoint& point);

    std::string bytes_;
};

// The trees of all triangles of A, in any order. Several threads may set trees of different triangles at the same time.
class CertificateBuilder {
public:
    explicit CertificateBuilder(Index triangles) : trees_(static_cast<std::size_t>(triangles)) {}

    // Replaces the tree that was there.
    void set(Index triangle, const CertificateTree& tree) { trees_[static_cast<std::size_t>(triangle)] = tree.bytes(); }

    // None where a triangle has no tree. O(bytes).
    std::optional<Certificate> finish(double proven) const;

private:
    std::vector<std::string> trees_;  // a leaf takes at most 10 bytes: no allocation
};

}  // namespace hausbench
