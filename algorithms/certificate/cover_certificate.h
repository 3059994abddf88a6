// Writes a certificate of an upper bound of h(A,B): how the triangles of A are cut into polygons, and for each
// polygon a triangle of B that is near all of it. docs/certificate.md describes the format and why it proves the
// bound; harness/check/certificate_check.h checks it.
//
// Each triangle of A (a point of A is a triangle with three equal corners) has one tree in preorder: a node, the
// subtree of its first child, the subtree of its second child. A node is a convex polygon; the root has the three
// corners of the triangle, 0, 1, 2 in the order of the mesh. Edge i goes from corner i to corner i + 1; the last
// edge goes to corner 0.
//
// The proof is about exact points: a point on an edge is a + t (b - a) without rounding, where a and b are
// themselves exact. `proven` must leave room for two things:
// - The errors of the solver's own points and distances, if its upper bound does not also hold for the exact
//   polygons.
// - The checker's own rounding outward, which costs a leaf below L cuts at most (14 L + 100) u D, where u = 2^-53
//   and D is the diagonal of the box of both posed shapes. A coordinate of a point p - q of the difference of the
//   two triangles is a sum (a - s) + v e + w e' - (x f + y f'), with edges e, e' of the triangle of A and f, f' of
//   the triangle of B. A cut widens the weights v and w by 7u: u for 1 - t, 2u for each product and 2u for the sum;
//   so by 7 L u (|e| + |e'|) <= 14 L u D. The rest is differences, products and sums of lengths below D, each off
//   by at most 4u of its value. (certificate_soups_test.cpp measures it.)
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
inline constexpr std::size_t most_certificate_corners = 64;  // per polygon
// The most nodes that may wait for their second child.
inline constexpr std::size_t most_certificate_pending = 4096;

// The point where a cut meets the boundary of a polygon: a corner, or the fraction t of the way along an edge. On
// an edge it is always a new corner of both children, even if t is 0 or 1, so the shape of the children does not
// depend on t.
struct CutPoint {
    static CutPoint corner(std::size_t i) { return {i, -1, false}; }
    // Measures t from corner `edge`.
    static CutPoint along(std::size_t edge, double t) { return {edge, t, false}; }
    // Measures t from the next corner, backward.
    static CutPoint back(std::size_t edge, double t) { return {edge, t, true}; }

    std::size_t place;  // number of the corner or edge
    double t;           // in [0, 1]; negative: a corner
    bool backward;
};

// The tree of one triangle, written as the solver goes along. Not shared by threads.
class CertificateTree {
public:
    // Cuts a node along the line from P to Q. The first child has the corners P, those after P and before Q, and Q.
    // The second child has the corners Q, those after Q and before P, and P. Each child must have at least three
    // corners, and P and Q must not lie on one edge.
    void cut(const CutPoint& p, const CutPoint& q);

    // Write a leaf. No point of the polygon is farther from B than
    // - one: the largest distance of a corner to triangle k of B. Never more than the two others.
    // - centre: the distance of its centre, the mean of its corners, to triangle k, plus the largest distance from
    //   the centre to a corner.
    // - vertex: the same with vertex v of A (its row in the points of A) in place of the centre. Needs no distance
    //   from a corner to B.
    void one(Index k);
    void centre(Index k);
    void vertex(Index v, Index k);

    // mark() returns a position in the tree; back_to() takes back everything written after it.
    std::size_t mark() const { return bytes_.size(); }
    void back_to(std::size_t mark) { bytes_.resize(mark); }
    void clear() { bytes_.clear(); }

    // Appends a tree or subtree that was written elsewhere.
    void append(const CertificateTree& other) { bytes_ += other.bytes_; }

    const std::string& bytes() const { return bytes_; }

private:
    void number(std::uint64_t value);
    void parameter(const CutPoint& point);

    std::string bytes_;
};

// The trees of all triangles of A, set in any order. Several threads may set the trees of different triangles at
// the same time.
class CertificateBuilder {
public:
    explicit CertificateBuilder(Index triangles) : trees_(static_cast<std::size_t>(triangles)) {}

    // Replaces any earlier tree of the triangle.
    void set(Index triangle, const CertificateTree& tree) { trees_[static_cast<std::size_t>(triangle)] = tree.bytes(); }

    // Returns nothing if some triangle has no tree. O(bytes).
    std::optional<Certificate> finish(double proven) const;

private:
    std::vector<std::string> trees_;  // a leaf takes at most 10 bytes: no allocation
};

}  // namespace hausbench
