// Writes a certificate of an upper bound of h(A,B): how the triangles of A are cut into polygons, and for each polygon a triangle of B
// that is near all of it. docs/certificate.md describes the format and why it proves the bound; harness/certificate_check.h checks it.
//
// Each triangle of A (a point of A is a triangle with three equal corners) has one tree in preorder: a node, its first child with all
// below it, its second child. A node is a convex polygon; the root has the three corners of the triangle, 0, 1, 2 in the order of
// the mesh. Edge i goes from corner i to corner i + 1, or to corner 0 from the last one.
//
// The proof is about exact points: a point on an edge is a + t (b - a) without rounding, where a and b are themselves exact. A solver that
// works with rounded points must have room for the difference in `proven`.
#pragma once

#include "geometry.h"
#include "solver.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

inline constexpr std::string_view cover_certificate_format = "hausbench cover 1";
inline constexpr std::size_t most_certificate_corners = 64;  // of a polygon
inline constexpr std::size_t most_certificate_depth = 4096;  // cuts from the root to a node

// Where a cut meets the boundary of a polygon: at a corner, or at t of the way along an edge. On an edge it is always a new corner
// of both children, even where t is 0 or 1: the shape of the children does not depend on t.
struct CutPoint {
    static CutPoint corner(std::size_t i) { return {i, -1, false}; }
    static CutPoint along(std::size_t edge, double t) { return {edge, t, false}; }  // from corner `edge` on
    static CutPoint back(std::size_t edge, double t) { return {edge, t, true}; }    // from the next corner backward

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

    // To take back what was written after a mark.
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
