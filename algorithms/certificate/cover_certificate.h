// Writes a certificate of an upper bound on h(A,B): how the triangles of A are cut into polygons, and for each
// polygon a triangle of B that is near all of it. docs/certificate.md describes the format and why it proves the
// bound; harness/check/certificate_check.h checks it.
//
// Each triangle of A has one tree. (A point of A counts as a triangle with three equal corners.) The tree is written in
// preorder: a node, the subtree of its first child, the subtree of its second child. Each node is a convex polygon. The
// root is the whole triangle; its corners 0, 1, 2 are in the order of the mesh. Edge i goes from corner i to corner
// i + 1, the last edge to corner 0. A node is either cut in two, or it is a leaf and names the triangle of B.
//
// The proof is about exact points: a point on an edge is a + t * (b - a) without rounding, where a and b are exact
// themselves. The solver must choose `proven`, the upper bound that it claims, so that it leaves room for two errors:
// - The rounding of the points and distances of the solver, unless its upper bound already holds for the exact
//   polygons.
// - The rounding of the checker, which calculates with intervals and rounds outward. For a leaf after L nested cuts,
//   this costs at most (14 * L + 100) * u * D, where u = 2^-53 and D is the diagonal of the box around both shapes.
//
// The derivation of the last bound: the checker bounds the length of p - q, where p is a corner of the leaf and q a
// point of the triangle of B. Let the triangle of A have the edges e and e' at its corner a, and the triangle of B the
// edges f and f' at its corner s. Then each coordinate of p - q is
//     (a - s) + (v * e + w * e') - (x * f + y * f')
// with weights v, w, x and y from 0 to 1. For a new corner, at the fraction t of the edge between corners with weights
// v1 and v2, the checker computes v = (1 - t) * v1 + t * v2, and w likewise. This makes the intervals of v and w wider
// by at most 7u: u for 1 - t, 2u for each of the two products, and 2u for the sum. After L cuts, this contributes at
// most
//     7 * L * u * (|e| + |e'|) <= 14 * L * u * D.
// All other terms are differences, products and sums of lengths below D, each off by at most 4u times its value;
// together they contribute less than 100 * u * D. (certificate_soups_test.cpp measures the total.)
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
// The checker keeps all polygons whose subtrees it has not read yet. It refuses a tree that needs more of them than
// this.
inline constexpr std::size_t most_certificate_pending = 4096;

// A point where a cut meets the boundary of a polygon: a corner, or a point on an edge. A point on an edge becomes a
// new corner of both parts even if it coincides with an end of the edge, so the number of corners does not depend on t.
struct CutPoint {
    static CutPoint corner(std::size_t i) { return {i, -1, false}; }
    // Returns the point at fraction t of the way from corner `edge` to the next corner.
    static CutPoint along(std::size_t edge, double t) { return {edge, t, false}; }
    // Returns the point at fraction t of the way back, from the corner after `edge` to corner `edge`.
    static CutPoint back(std::size_t edge, double t) { return {edge, t, true}; }

    std::size_t place;  // index of the corner or edge
    double t;           // in [0, 1]; negative if the point is a corner
    bool backward;      // whether t counts from the far end, as in back()
};

// The tree of one triangle of A, which shows how the triangle is cut into polygons. A solver writes it node by node,
// each node before its children. Not thread-safe.
class CertificateTree {
public:
    // Writes a polygon that is cut in two along the line from p to q. The first child has the corners p, those after p
    // and before q, and q. The second child has the corners q, those after q and before p, and p. Each child must have
    // at least three corners, and p and q must not lie on the same edge.
    void cut(const CutPoint& p, const CutPoint& q);

    // Each of the next three functions writes a polygon that is not cut, with a different bound on its distance to B:
    // - one: the largest distance from a corner to triangle k of B. This is never more than the other two bounds.
    // - centre: the distance from the mean c of the corners to triangle k, plus the largest distance from c to a
    //   corner.
    // - vertex: like centre, but with vertex v of A instead of c. One measured vertex can serve many polygons, so their
    //   corners need not be measured.
    void one(Index k);
    void centre(Index k);
    void vertex(Index v, Index k);

    // mark() returns the current end of the tree. back_to() removes everything written after that.
    std::size_t mark() const { return bytes_.size(); }
    void back_to(std::size_t mark) { bytes_.resize(mark); }
    void clear() { bytes_.clear(); }

    void append(const CertificateTree& other) { bytes_ += other.bytes_; }

    const std::string& bytes() const { return bytes_; }

private:
    void number(std::uint64_t value);
    void parameter(const CutPoint& point);

    std::string bytes_;
};

// Joins the trees of all triangles of A into a certificate. The trees may be set in any order, and by several threads
// for different triangles.
class CertificateBuilder {
public:
    explicit CertificateBuilder(Index triangles) : trees_(static_cast<std::size_t>(triangles)) {}

    // Replaces any earlier tree of the triangle.
    void set(Index triangle, const CertificateTree& tree) { trees_[static_cast<std::size_t>(triangle)] = tree.bytes(); }

    // Returns the certificate of h(A,B) <= proven. Returns nothing if some triangle has no tree.
    std::optional<Certificate> finish(double proven) const;

private:
    // A tree of one node has at most 10 bytes, which a string stores without allocating memory.
    std::vector<std::string> trees_;
};

}  // namespace hausbench
