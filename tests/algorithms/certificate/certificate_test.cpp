// The certificate checker: everything it accepts is true, it accepts every true and well-formed certificate, and its
// bound is exact up to rounding.
#include "harness/check/certificate_check.h"

#include "harness/check/verify_exact.h"
#include "tests/support/certificates.h"
#include "tests/support/scenes.h"

#include <gtest/gtest.h>

#include <functional>

namespace hausbench {
namespace {

using namespace certificates;
using Kind = Node::Kind;

CertificateCheck check_at_rest(const Shape& a, const Shape& b, const Certificate& certificate) {
    return check_certificate(a, Pose{}, b, Pose{}, certificate);
}

// A is a right triangle, B two large triangles above it, at heights 1 and 2.
const TriangleMesh flat = soup(rows({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}));
const TriangleMesh above = soup(rows({{-9, -9, 1}, {29, -9, 1}, {-9, 29, 1}, {-9, -9, 2}, {29, -9, 2}, {-9, 29, 2}}));

Node leaf(Kind kind, Index k, Index v = 0) {
    Node node;
    node.kind = kind;
    node.k = k;
    node.v = v;
    return node;
}
Node cut(const CutPoint& p, const CutPoint& q) {
    Node node;
    node.kind = Kind::cut;
    node.p = p, node.q = q;
    return node;
}

CertificateCheck check_tree(const Tree& tree, double proven = infinity) {
    return check_at_rest(flat, above, written(Proof{tree}, proven));
}

TEST(Certificate, OneTriangleNearAllCorners) {
    for (const Index k : {0, 1}) {
        const CertificateCheck check = check_tree({leaf(Kind::one, k)}, 1.0 + k + 1e-15);
        EXPECT_TRUE(check.accepted) << check.refusal;
        EXPECT_EQ(check.refusal, "");
        EXPECT_GE(check.found, 1.0 + k);
        EXPECT_LE(check.found, 1.0 + k + 1e-15);
        EXPECT_EQ(check.one, 1u);
        EXPECT_EQ(check.worst, 0);
        EXPECT_FALSE(check_tree({leaf(Kind::one, k)}, std::nextafter(1.0 + k, 0)).accepted);
    }
}

TEST(Certificate, APointAndARadius) {
    // The centroid (4/3, 4/3, 0) is sqrt(80)/3 from two corners and nearer to the third.
    EXPECT_NEAR(check_tree({leaf(Kind::centre, 0)}).found, 1 + std::sqrt(80.0) / 3, 1e-14);
    EXPECT_NEAR(check_tree({leaf(Kind::vertex, 0, 0)}).found, 1 + 4, 1e-14);
    EXPECT_NEAR(check_tree({leaf(Kind::vertex, 1, 2)}).found, 2 + std::sqrt(32.0), 1e-14);
}

// File readers reject NaN, but a caller of the library may pass one.
TEST(Certificate, ACoordinateThatIsNotANumberIsRefused) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Node& node : {leaf(Kind::one, 0), leaf(Kind::centre, 0), leaf(Kind::vertex, 0, 1)}) {
        for (int i = 0; i < 9; ++i) {
            for (const bool source : {true, false}) {
                TriangleMesh a = flat, b = above;
                (source ? a : b).vertices(i / 3, i % 3) = nan;
                const CertificateCheck check = check_at_rest(a, b, written(Proof{Tree{node}}, infinity));
                EXPECT_FALSE(check.accepted) << i << source;
                EXPECT_NE(check.refusal, "") << i << source;
            }
        }
    }
}

// Each leaf bounds only the part on its side of the cut; the larger bound counts.
TEST(Certificate, BothChildrenOfACut) {
    // In B, triangle 0 is a point above corner 1 of A, and triangle 1 is large, at height 2.
    const TriangleMesh corner = soup(rows({{4, 0, 1}, {4, 0, 1}, {4, 0, 1}, {-9, -9, 2}, {29, -9, 2}, {-9, 29, 2}}));
    const auto bound_of = [&](const Tree& tree) {
        const CertificateCheck check = check_at_rest(flat, corner, written(Proof{tree}, infinity));
        EXPECT_TRUE(check.accepted) << check.refusal;
        EXPECT_EQ(check.cuts + 1, check.leaves());
        return check.found;
    };
    // The cut goes from P = (3, 0, 0) to Q = (3, 1, 0). The first part, (P, corner 1, Q), is within sqrt(3) of triangle
    // 0.
    const Node at_corner_1 = cut(CutPoint::along(0, 0.75), CutPoint::back(1, 0.75));
    EXPECT_NEAR(bound_of({at_corner_1, leaf(Kind::one, 0), leaf(Kind::one, 1)}), 2, 1e-14);
    EXPECT_NEAR(bound_of({at_corner_1, leaf(Kind::one, 0), leaf(Kind::one, 0)}), std::sqrt(33.0), 1e-14);
    EXPECT_NEAR(bound_of({at_corner_1, leaf(Kind::one, 1), leaf(Kind::one, 0)}), std::sqrt(33.0), 1e-14);
    const Node turned = cut(at_corner_1.q, at_corner_1.p);
    EXPECT_NEAR(bound_of({turned, leaf(Kind::one, 1), leaf(Kind::one, 0)}), 2, 1e-14);
    EXPECT_NEAR(bound_of({turned, leaf(Kind::one, 0), leaf(Kind::one, 1)}), std::sqrt(33.0), 1e-14);
    // A cut that starts at a corner, and one between the ends of two edges (t = 0 and t = 1).
    const Node halved = cut(CutPoint::corner(2), CutPoint::along(0, 0.5));
    EXPECT_NEAR(bound_of({halved, leaf(Kind::one, 1), leaf(Kind::one, 1)}), 2, 1e-14);
    EXPECT_NEAR(bound_of({halved, leaf(Kind::one, 0), leaf(Kind::one, 1)}), std::sqrt(33.0),
                1e-14);  // the first child is (corner 2, corner 0, P)
    const Node ends = cut(CutPoint::along(0, 0), CutPoint::along(1, 1));
    EXPECT_NEAR(bound_of({ends, leaf(Kind::one, 1), leaf(Kind::one, 0)}), std::sqrt(33.0), 1e-14);
}

// The cut is so near a corner that 1 - t would be rounded.
TEST(Certificate, CutsNearACornerAreNotAtIt) {
    Points points(6, 3);
    points << flat.vertices, flat.vertices.row(1).replicate(3, 1);
    const Tree tree = {cut(CutPoint::back(0, 0x1.ffp-54), CutPoint::along(1, 0x1.ffp-54)), leaf(Kind::one, 1),
                       leaf(Kind::one, 0)};
    const CertificateCheck check = check_at_rest(flat, soup(points), written(Proof{tree}, infinity));
    EXPECT_TRUE(check.accepted);
    EXPECT_GE(check.found, 5.65 * 0x1.ffp-54);  // distance from Q to corner 1: sqrt(32) t
}

TEST(Certificate, RefusalsNameThePlace) {
    const auto refusal = [&](const Tree& tree) {
        const CertificateCheck check = check_tree(tree);
        EXPECT_FALSE(check.accepted);
        EXPECT_EQ(check.found, infinity);
        return check.refusal;
    };
    const Node fine = cut(CutPoint::corner(0), CutPoint::along(1, 0.5)), leaf_0 = leaf(Kind::one, 0);
    EXPECT_EQ(refusal({leaf(Kind::one, 2)}), "triangle 0, node 0: a leaf names triangle 2 of 2 in the target");
    EXPECT_EQ(refusal({leaf(Kind::vertex, 0, 3)}), "triangle 0, node 0: a leaf names vertex 3 of 3 in the source");
    EXPECT_EQ(refusal({fine, leaf_0}), "triangle 0, node 2: the certificate ends here");
    EXPECT_EQ(refusal({fine, leaf_0, leaf_0, leaf_0}), "triangle 1, node 0: there are bytes after the last triangle");
    for (const double t : {-0.0, 1.0000000000000002, std::nan(""), infinity}) {
        EXPECT_EQ(refusal({cut(CutPoint::corner(0), CutPoint::along(1, t)), leaf_0, leaf_0}),
                  "triangle 0, node 0: a cut is not between the ends of its edge")
            << t;
    }
    const auto at = [](std::size_t i) { return CutPoint::corner(i); };
    const auto on = [](std::size_t i) { return CutPoint::along(i, 0.5); };
    EXPECT_EQ(refusal({cut(at(3), on(0)), leaf_0, leaf_0}), "triangle 0, node 0: a cut names corner 3 of 3");
    EXPECT_EQ(refusal({cut(at(0), on(3)), leaf_0, leaf_0}), "triangle 0, node 0: a cut names edge 3 of 3");
    EXPECT_EQ(refusal({cut(on(1), on(1)), leaf_0, leaf_0}),
              "triangle 0, node 0: a cut begins and ends at one corner or edge");
    EXPECT_EQ(refusal({cut(at(1), at(1)), leaf_0, leaf_0}),
              "triangle 0, node 0: a cut begins and ends at one corner or edge");
    for (const auto& [p, q] : {std::pair(at(0), at(1)), std::pair(at(0), on(0)), std::pair(at(0), on(2))}) {
        EXPECT_EQ(refusal({cut(p, q), leaf_0, leaf_0}), "triangle 0, node 0: a cut runs along an edge");
        EXPECT_EQ(refusal({cut(q, p), leaf_0, leaf_0}), "triangle 0, node 0: a cut runs along an edge");
    }
    const CertificateCheck low = check_tree({leaf(Kind::vertex, 1, 0)}, 0.5);
    EXPECT_EQ(low.refusal, "triangle 0: its leaves show 6.0000000000000009, and the certificate claims 0.5");
    EXPECT_FALSE(check_tree({leaf_0}, std::nan("")).accepted);
}

TEST(Certificate, OtherFormatsAndBytesAreRefused) {
    const auto refusal = [](const std::string& bytes, const char* format = "hausbench cover 1") {
        return check_at_rest(flat, above, {format, {}, infinity, bytes}).refusal;
    };
    EXPECT_EQ(refusal({1}), "");
    EXPECT_NE(refusal({1}, "hausbench cover 2"), "");
    EXPECT_EQ(refusal(""), "triangle 0, node 0: the certificate ends here");
    EXPECT_EQ(refusal("\x81"), "triangle 0, node 0: the certificate ends here");
    EXPECT_EQ(refusal(std::string("\x81\0", 2)),
              "triangle 0, node 0: a number is not written in as few bytes as it takes");
    EXPECT_EQ(refusal(std::string(9, '\x81') + '\1'), "triangle 0, node 0: a number has more than 63 bits");
    EXPECT_NE(refusal(std::string(8, '\xfd') + '\x7f'), "");  // triangle 2^61 - 1 of B
    const std::string cut_of_corners = written(Proof{{cut(CutPoint::corner(0), CutPoint::corner(1))}}, 0).bytes;
    EXPECT_EQ(cut_of_corners.size(), 2u);
    EXPECT_NE(refusal(std::string("\x80\x80\x80\x01", 4)), "");  // a cut to corner or edge 128
    const Shape surface = AlgebraicSurface{"x", rows({{-1, -1, -1}, {1, 1, 1}})};
    EXPECT_NE(check_at_rest(surface, above, {"hausbench cover 1", {}, infinity, "\1"}).refusal, "");
}

// Many cuts must take neither much memory nor much allowance for rounding.
TEST(Certificate, ManyCuts) {
    // Each first part is a leaf at once, so polygons do not pile up.
    Tree chain;
    for (int i = 0; i < 20000; ++i) {
        chain.push_back(cut(CutPoint::back(1, 0.25), CutPoint::along(2, i % 2 ? 0.125 : 0.0625)));
        chain.push_back(leaf(Kind::one, 0));
        chain.push_back(cut(CutPoint::corner(1), CutPoint::corner(3)));
        chain.push_back(leaf(Kind::one, 0));
    }
    chain.push_back(leaf(Kind::one, 0));
    const CertificateCheck check = check_tree(chain, 1 + 1e-9);
    EXPECT_TRUE(check.accepted) << check.refusal;
    EXPECT_EQ(check.cuts, 40000u);
    EXPECT_LT(check.found, 1 + 1e-11);
    // Cuts the first part again and again; each cut leaves one more polygon waiting.
    std::string bytes;
    for (int i = 0; i < 5000; ++i)
        bytes += written(Proof{{cut(CutPoint::corner(0), CutPoint::along(1, 0.5))}}, 0).bytes;
    EXPECT_EQ(check_at_rest(flat, above, {"hausbench cover 1", {}, infinity, bytes}).refusal,
              "triangle 0, node 4096: more than 4096 polygons wait for their leaves");
    // Each cut adds one corner.
    Tree round;
    for (int i = 0; i < 62; ++i) {
        round.push_back(cut(CutPoint::along(0, 0.5), CutPoint::along(1, 0.5)));
        round.push_back(leaf(Kind::one, 0));
    }
    EXPECT_EQ(check_tree(round).refusal, "triangle 0, node 122: a polygon has more than 64 corners");
}

}  // namespace
}  // namespace hausbench
