// Certificates for tests: a slow writer that tries random cuts and triangles, and the exact bound that a proof shows.
#pragma once

#include "algorithms/certificate/cover_certificate.h"
#include "tests/support/random.h"
#include "tests/support/reference.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace hausbench::certificates {

using Real = long double;
using V = MeshReference::V;

struct Node {
    enum class Kind { cut, one, centre, vertex } kind = Kind::one;
    Index k = 0, v = 0;                                         // for a leaf
    CutPoint p = CutPoint::corner(0), q = CutPoint::corner(0);  // for a cut
};
using Tree = std::vector<Node>;
using Proof = std::vector<Tree>;  // one tree for each triangle of A

inline CertificateTree written(const Tree& tree) {
    CertificateTree out;
    for (const Node& node : tree) {
        if (node.kind == Node::Kind::cut) out.cut(node.p, node.q);
        if (node.kind == Node::Kind::one) out.one(node.k);
        if (node.kind == Node::Kind::centre) out.centre(node.k);
        if (node.kind == Node::Kind::vertex) out.vertex(node.v, node.k);
    }
    return out;
}

// Returns empty bytes if a triangle has no node at all.
inline Certificate written(const Proof& proof, double proven) {
    CertificateBuilder builder(static_cast<Index>(proof.size()));
    for (std::size_t i = proof.size(); i-- > 0;) builder.set(static_cast<Index>(i), written(proof[i]));  // in any order
    return builder.finish(proven).value_or(Certificate{});
}

inline TriangleMesh triangles_of(const Shape& shape) {
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return *mesh;
    TriangleMesh mesh{points_of(shape), {}};
    mesh.triangles.resize(mesh.vertices.rows(), 3);
    for (Index i = 0; i < mesh.vertices.rows(); ++i) mesh.triangles.row(i).setConstant(i);
    return mesh;
}

// The corners of the two children of a cut polygon, as cover_certificate.h defines them, for any type of point.
template <class Point> struct Children {
    std::vector<Point> first, second;

    template <class Between>  // between(corner, corner, t)
    Children(const std::vector<Point>& whole, const CutPoint& p, const CutPoint& q, const Between& between) {
        const std::size_t n = whole.size();
        const auto at = [&](const CutPoint& c) {
            const Point &from = whole[c.place], &to = whole[(c.place + 1) % n];
            return c.t < 0 ? from : c.backward ? between(to, from, c.t) : between(from, to, c.t);
        };
        const auto part = [&](const CutPoint& from, const CutPoint& to) {
            std::vector<Point> corners = {at(from)};
            for (std::size_t i = from.place + 1;; ++i) {  // up to `to`, or to the start of its edge
                if (to.t < 0 && i % n == to.place) break;
                corners.push_back(whole[i % n]);
                if (to.t >= 0 && i % n == to.place) break;
            }
            corners.push_back(at(to));
            return corners;
        };
        first = part(p, q);
        second = part(q, p);
    }
};

// A writer that proves with random polygons that A lies within tau of B. Both shapes are at rest.
class Writer {
public:
    Writer(const Shape& a, const Shape& b, Real tau, Random& random) : a_(triangles_of(a)), tau_(tau), random_(random) {
        const TriangleMesh target = triangles_of(b);
        for (Index k = 0; k < target.triangles.rows(); ++k)
            targets_.emplace_back(TriangleMesh{target.vertices, target.triangles.row(k)});
    }

    // Returns nothing if the proof would take too many cuts.
    std::optional<Proof> run() {
        Proof proof;
        for (Index i = 0; i < a_.triangles.rows(); ++i) {
            proof.emplace_back();
            std::vector<V> corners;
            for (int c = 0; c < 3; ++c) corners.push_back(MeshReference::vector(a_.vertices.row(a_.triangles(i, c))));
            if (!cover(corners, proof.back())) return std::nullopt;
        }
        return proof;
    }

private:
    static constexpr std::size_t most_nodes = 4000;

    static Real distance(const V& a, const V& b) {
        return std::sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
    }

    bool cover(const std::vector<V>& corners, Tree& tree) {
        if (tree.size() > most_nodes) return false;
        if (const auto node = leaf(corners)) {
            tree.push_back(*node);
            return true;
        }
        Node node;
        node.kind = Node::Kind::cut;
        std::tie(node.p, node.q) = corners.size() < 12 && random_.unit() < 0.3 ? any_cut(corners) : halves(corners);
        tree.push_back(node);
        const Children<V> children(corners, node.p, node.q, [](const V& a, const V& b, double t) {
            return V{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
        });
        return cover(children.first, tree) && cover(children.second, tree);
    }

    std::optional<Node> leaf(const std::vector<V>& corners) {
        Node node;
        Real least = std::numeric_limits<Real>::infinity();
        for (std::size_t k = 0; k < targets_.size(); ++k) {
            Real most = 0;
            for (const V& corner : corners) most = std::max(most, targets_[k].distance(corner));
            if (most < least) least = most, node.k = static_cast<Index>(k);
        }
        if (least > tau_) return std::nullopt;
        V centre{};
        for (const V& corner : corners) {
            for (std::size_t i = 0; i < 3; ++i) centre[i] += corner[i] / static_cast<Real>(corners.size());
        }
        node.v = random_.below(static_cast<Index>(a_.vertices.rows()));
        if (random_.unit() < 0.5 && around(corners, centre, node.k) <= tau_) node.kind = Node::Kind::centre;
        if (random_.unit() < 0.5 && around(corners, MeshReference::vector(a_.vertices.row(node.v)), node.k) <= tau_)
            node.kind = Node::Kind::vertex;
        return node;
    }

    Real around(const std::vector<V>& corners, const V& point, Index k) const {
        Real radius = 0;
        for (const V& corner : corners) radius = std::max(radius, distance(corner, point));
        return targets_[static_cast<std::size_t>(k)].distance(point) + radius;
    }

    // Cuts from the middle of the longest edge to the corner roughly opposite.
    std::pair<CutPoint, CutPoint> halves(const std::vector<V>& corners) {
        const std::size_t n = corners.size();
        std::size_t longest = 0;
        Real most = -1;
        for (std::size_t i = 0; i < n; ++i) {
            const Real length = distance(corners[i], corners[(i + 1) % n]);
            if (length > most) most = length, longest = i;
        }
        const CutPoint middle = random_.unit() < 0.5 ? CutPoint::along(longest, 0.5) : CutPoint::back(longest, 0.5);
        const CutPoint corner = CutPoint::corner((longest + 1 + n / 2) % n);
        return random_.unit() < 0.5 ? std::pair(middle, corner) : std::pair(corner, middle);
    }

    std::pair<CutPoint, CutPoint> any_cut(const std::vector<V>& corners) {
        const auto n = static_cast<Index>(corners.size());
        // Numbers the boundary: corner i is 2i, edge i is 2i + 1. On each side of the cut, a corner must lie between
        // its ends.
        const auto least = [](Index place) { return place % 2 == 0 ? 3 : 2; };
        Index p = 0, gap = 0;
        do {
            p = random_.below(2 * n), gap = random_.below(2 * n);
        } while (gap < least(p) || 2 * n - gap < least(p));
        const auto point = [&](Index place) {
            const auto i = static_cast<std::size_t>(place % (2 * n) / 2);
            const double t = random_.unit();
            return place % 2 == 0         ? CutPoint::corner(i)
                   : random_.unit() < 0.5 ? CutPoint::along(i, t)
                                          : CutPoint::back(i, t);
        };
        return {point(p), point(p + gap)};
    }

    TriangleMesh a_;
    std::vector<MeshReference> targets_;  // one per triangle
    Real tau_;
    Random& random_;
};

// The bound that the leaves of a proof show, exact except for the last root and sum. `squared` covers only leaves of
// kind `one`, `length` all leaves.
struct ExactValue {
    exact::Rational squared = 0;
    Real length = 0;
    std::size_t depth = 0;  // the largest number of cuts above a leaf
};

inline ExactValue exact_value(const Shape& a, const Shape& b, const Proof& proof) {
    using exact::RVec3, exact::Rational, exact::operator-;
    const TriangleMesh source = triangles_of(a), target = triangles_of(b);
    const auto corner = [](const TriangleMesh& mesh, Index i, int c) {
        return exact::vector(mesh.vertices.row(mesh.triangles(i, c)));
    };
    ExactValue value;
    for (std::size_t i = 0; i < proof.size(); ++i) {
        std::vector<std::vector<RVec3>> stack(1);
        std::vector<std::size_t> depth = {0};
        for (int c = 0; c < 3; ++c) stack.back().push_back(corner(source, static_cast<Index>(i), c));
        for (const Node& node : proof[i]) {
            const std::vector<RVec3> polygon = stack.back();
            stack.pop_back();
            const std::size_t cuts = depth.back();
            depth.pop_back();
            value.depth = std::max(value.depth, cuts);
            if (node.kind == Node::Kind::cut) {
                Children<RVec3> children(polygon, node.p, node.q, [](const RVec3& from, const RVec3& to, double t) {
                    return exact::along(from, Rational(t), to - from);
                });
                stack.push_back(std::move(children.second));
                stack.push_back(std::move(children.first));
                depth.insert(depth.end(), 2, cuts + 1);
                continue;
            }
            const auto squared = [&](const RVec3& p) {
                return exact::squared_distance_to_triangle(p, corner(target, node.k, 0), corner(target, node.k, 1),
                                                           corner(target, node.k, 2));
            };
            if (node.kind == Node::Kind::one) {
                for (const RVec3& p : polygon) value.squared = std::max(value.squared, squared(p));
                value.length = std::max(value.length, exact::root(value.squared));
                continue;
            }
            RVec3 at = exact::vector(source.vertices.row(node.v));
            if (node.kind == Node::Kind::centre) {
                at = {0, 0, 0};
                for (const RVec3& p : polygon)
                    at = exact::along(at, Rational(1) / Rational(static_cast<int>(polygon.size())), p);
            }
            Rational radius = 0;
            for (const RVec3& p : polygon) radius = std::max(radius, exact::squared_distance(at, p));
            value.length = std::max(value.length, exact::root(squared(at)) + exact::root(radius));
        }
    }
    return value;
}

}  // namespace hausbench::certificates
