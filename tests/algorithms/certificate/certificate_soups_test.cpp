// Certificates of random scenes: valid ones are accepted, with bounds that are exact up to rounding. A changed one is
// refused unless its claim is still true.
#include "harness/check/certificate_check.h"

#include "tests/support/certificates.h"
#include "tests/support/scenes.h"
#include "tests/support/searches.h"

#include <gtest/gtest.h>

#include <bit>

namespace hausbench {
namespace {

using namespace certificates;
using Kind = Node::Kind;

constexpr double u = 0x1p-53;
constexpr Real root_loss = 0x1p-58L;  // relative error of exact::root()

double diagonal_of_both(const Points& a, const Points& b) {
    Points both(a.rows() + b.rows(), 3);
    both << a, b;
    return diagonal(both);
}

struct Case {
    Scene scene;  // at rest
    Real low, high;
    double size;  // diagonal of the box of both shapes
    Proof proof;
    double proven;
};

TriangleMesh random_soup(Random& random, Index triangles) {
    Points points = cloud(random, 3 * triangles);
    for (Index i = 0; i < triangles; ++i) {
        const double kind = random.unit(), thin = std::pow(2.0, -random.real(1, 50));
        if (kind < 0.1) points.row(3 * i + 1) = points.row(3 * i);                                  // a segment
        if (kind < 0.05) points.row(3 * i + 2) = points.row(3 * i);                                 // a point
        if (kind > 0.8) points.row(3 * i + 2) = points.row(3 * i) + thin * points.row(3 * i + 2);   // a needle
        if (kind > 0.95) points.row(3 * i + 1) = points.row(3 * i) + thin * points.row(3 * i + 1);  // a small one
        if (kind > 0.7 && kind < 0.75 && i > 0)
            points.middleRows(3 * i, 3) = points.middleRows(3 * i - 3, 3);  // a duplicate
    }
    return soup(points);
}

// Cuts each triangle into three and moves their corners a little, so that no single triangle of the result is near a
// whole triangle of `whole`.
TriangleMesh split(const TriangleMesh& whole, Random& random) {
    Points points(9 * whole.triangles.rows(), 3);
    const double noise = std::pow(2.0, -random.real(3, 30)) * diagonal(whole.vertices);
    for (Index i = 0; i < whole.triangles.rows(); ++i) {
        const auto corner = [&](Index k) { return Vec3(whole.vertices.row(whole.triangles(i, k % 3))); };
        const double x = random.unit(), y = (1 - x) * random.unit();
        const Vec3 middle = x * corner(0) + y * corner(1) + (1 - x - y) * corner(2);
        for (Index k = 0; k < 3; ++k) {
            points.row(9 * i + 3 * k) = corner(k) + random.vector(noise);
            points.row(9 * i + 3 * k + 1) = corner(k + 1) + random.vector(noise);
            points.row(9 * i + 3 * k + 2) = middle + random.vector(noise);
        }
    }
    return soup(points);
}

// Returns nothing if a certificate would take too many cuts.
std::optional<Case> random_case(Random& random, Index most_triangles) {
    Shape a = random_soup(random, 1 + random.below(most_triangles));
    transform(a, std::pow(2.0, random.real(-3, 3)), random.vector(random.unit() < 0.2 ? 100 : 0));
    Shape b = random.unit() < 0.5 ? split(mesh_of(a), random) : random_soup(random, 1 + random.below(most_triangles));
    if (random.unit() < 0.1) a = PointSet{points_of(a)};
    if (random.unit() < 0.1) b = PointSet{points_of(b)};
    Case c{{a, b}, 0, 0, diagonal_of_both(points_of(a), points_of(b)), {}, 0};
    const TriangleMesh mesh = triangles_of(a);
    const MeshReference reference(triangles_of(b));
    const Real gap = 1e-3L * c.size;
    std::tie(c.low, c.high) = reference.hausdorff(mesh.vertices, mesh.triangles, gap);
    c.low -= 0x1p-58L * std::max(magnitude(points_of(a)), magnitude(points_of(b)));  // rounding in the reference itself
    const Real tau = c.high + static_cast<Real>(std::pow(2.0, -random.real(1, 6))) * c.size;
    const auto proof = Writer(a, b, tau, random).run();
    if (!proof) return std::nullopt;
    c.proof = *proof;
    c.proven = static_cast<double>(tau) * (1 + 4 * u) + 1e-13 * c.size;
    return c;
}

CertificateCheck check(const Case& c, const Certificate& certificate) {
    return check_certificate(c.scene.source, Pose{}, c.scene.target, Pose{}, certificate);
}

// Checks that the checker's bound is not below the true distance, and that it accepts exactly the claims at or above
// its bound.
void expect_true(const Case& c, const Certificate& certificate, const char* what) {
    const CertificateCheck result = check(c, certificate);
    EXPECT_GE(result.found, c.low) << what;
    EXPECT_EQ(result.accepted, std::isfinite(result.found) && result.found <= certificate.proven) << what;
    EXPECT_EQ(result.accepted, result.refusal.empty()) << what;
}

void expect_refused(const Case& c, const Certificate& certificate, const char* what) {
    EXPECT_FALSE(check(c, certificate).accepted) << what;
    expect_true(c, certificate, what);
}

Node& any_node(Proof& proof, Random& random, bool cut) {
    for (;;) {
        Tree& tree = proof[std::size_t(random.below(Index(proof.size())))];
        Node& node = tree[std::size_t(random.below(Index(tree.size())))];
        if ((node.kind == Kind::cut) == cut) return node;
    }
}

void change_nodes(const Case& c, Random& random) {
    const Index targets = triangles_of(c.scene.target).triangles.rows(), vertices = points_of(c.scene.source).rows();
    const auto changed = [&](bool cut, const char* what, const auto& change) {
        Proof proof = c.proof;
        change(any_node(proof, random, cut));
        expect_true(c, written(proof, c.proven), what);
    };
    std::size_t cuts = 0;
    for (const Tree& tree : c.proof) cuts += tree.size() / 2;
    if (cuts > 0) {
        changed(true, "t moved", [&](Node& n) { (n.p.t >= 0 ? n.p : n.q).t = random.unit(); });
        changed(true, "another place", [&](Node& n) { n.q.place = std::size_t(random.below(6)); });
        changed(true, "P and Q swapped", [&](Node& n) { std::swap(n.p, n.q); });
        changed(true, "measured from the other end", [&](Node& n) { n.p.backward = n.p.t >= 0 && !n.p.backward; });
        changed(true, "a cut becomes a leaf", [&](Node& n) { n.kind = Kind::one; });
    }
    changed(false, "another triangle", [&](Node& n) { n.k = random.below(targets); });
    changed(false, "another vertex", [&](Node& n) { n.v = random.below(vertices); });
    changed(false, "another kind", [&](Node& n) { n.kind = Kind(1 + random.below(3)); });
    Proof proof = c.proof;
    any_node(proof, random, false).k = targets;
    expect_refused(c, written(proof, infinity), "no such triangle");
    proof = c.proof;
    std::swap(proof.front(), proof.back());
    expect_true(c, written(proof, c.proven), "two triangles swapped");
    proof = c.proof;
    Tree& tree = proof[std::size_t(random.below(Index(proof.size())))];
    tree.erase(tree.begin() + random.below(Index(tree.size())));
    if (tree.empty()) tree.push_back({Kind::cut});  // the writer cannot leave a triangle out
    expect_refused(c, written(proof, infinity), "a node dropped");
}

void change_bytes(const Case& c, const Certificate& good, Random& random) {
    Certificate bad = good;
    if (c.low > 0) {
        bad.proven = std::nextafter(double(c.low), 0);
        if (bad.proven < c.low) expect_refused(c, bad, "below the distance");
    }
    bad = good;
    bad.proven = infinity;
    bad.bytes.resize(std::size_t(random.below(Index(good.bytes.size()))));
    expect_refused(c, bad, "truncated");
    bad.bytes = good.bytes + char(random.below(256));
    expect_refused(c, bad, "trailing bytes");
    for (int i = 0; i < 3; ++i) {
        bad = good;
        for (int flips = 1 + random.below(2); flips > 0; --flips)
            bad.bytes[std::size_t(random.below(Index(bad.bytes.size())))] ^= char(1 << random.below(8));
        expect_true(c, bad, "bits flipped");
    }
    for (char& byte : bad.bytes) byte = char(random.below(256));
    expect_true(c, bad, "noise");
}

TEST(CertificateSoups, GoodOnesAreAcceptedAndChangedOnesAreTrueOrRefused) {
    Random random(71);
    int written_ones = 0, cuts = 0;
    const int soups = tries(5000);
    for (int i = 0; i < soups; ++i) {
        const auto c = random_case(random, 3);
        if (!c) continue;
        ++written_ones;
        const Certificate good = written(c->proof, c->proven);
        const CertificateCheck result = check(*c, good);
        ASSERT_TRUE(result.accepted) << i << ": " << result.refusal;
        ASSERT_GE(result.found, c->low) << i;
        cuts += int(result.cuts);
        std::size_t nodes = 0;
        for (const Tree& tree : c->proof) nodes += tree.size();
        EXPECT_EQ(result.cuts + result.leaves(), nodes);
        change_nodes(*c, random);
        change_bytes(*c, good, random);
        if (HasFailure()) FAIL() << "soup " << i;
    }
    EXPECT_GE(written_ones, soups * 98 / 100);
    EXPECT_GT(cuts, soups);
}

// The checker's bound is never below the exact bound of the same leaves, and hardly above it.
TEST(CertificateSoups, TheBoundIsExactButForRounding) {
    Random random(72);
    int ones = 0;
    for (int i = 0; i < 400; ++i) {
        auto c = random_case(random, 3);
        if (!c) continue;
        if (i % 2 == 0) {
            for (Tree& tree : c->proof) {
                for (Node& node : tree)
                    if (node.kind != Kind::cut) node.kind = Kind::one;
            }
        }
        const CertificateCheck result = check(*c, written(c->proof, infinity));
        ASSERT_TRUE(result.accepted) << result.refusal;
        const ExactValue exact = exact_value(c->scene.source, c->scene.target, c->proof);
        const exact::Rational bound = result.found;
        EXPECT_TRUE(bound * bound >= exact.squared) << i;
        EXPECT_GE(result.found, exact.length * (1 - root_loss) - (result.centre ? 1e-15L * c->size : 0)) << i;
        EXPECT_LE(result.found, exact.length * (1 + root_loss) + (14 * exact.depth + 100) * u * c->size) << i;
        if (exact.squared > 0 && exact.length == exact::root(exact.squared)) ++ones;
    }
    EXPECT_GT(ones, 150);
}

// A certificate contains no lengths, so scaling the shapes by a power of two scales the bound exactly. Other scales and
// poses round the shapes, not the certificate.
TEST(CertificateSoups, ScalesAndPoses) {
    Random random(73);
    for (int i = 0; i < 200; ++i) {
        const auto c = random_case(random, 2);
        if (!c) continue;
        const Certificate good = written(c->proof, c->proven);
        const double bound = check(*c, good).found;
        for (const int exponent : {-531, -200, 90, 498}) {
            Scene scene = c->scene;
            transform(scene.source, std::ldexp(1.0, exponent), Vec3::Zero());
            transform(scene.target, std::ldexp(1.0, exponent), Vec3::Zero());
            const CertificateCheck scaled = check_certificate(scene.source, Pose{}, scene.target, Pose{}, good);
            EXPECT_EQ(scaled.found, std::ldexp(bound, exponent)) << exponent;
        }
        // Moves both shapes alike. The certificate is about the moved vertices, to the last bit.
        const Pose pose = turned(0.6, 0.8, random.vector(10));
        const CertificateCheck moved = check_certificate(c->scene.source, pose, c->scene.target, pose, good);
        EXPECT_NEAR(moved.found, bound, 1e-13);
        Scene posed = c->scene;
        for (SharedShape* shape : {&posed.source, &posed.target}) {
            Shape copy = *shape;
            points_of(copy) = hausbench::posed(points_of(copy), pose);
            *shape = std::move(copy);
        }
        EXPECT_EQ(check_certificate(posed.source, Pose{}, posed.target, Pose{}, good).found, moved.found);
        // For h(B,A), the shapes change places.
        Certificate backward = good;
        backward.direction = Witness::Direction::target_to_source;
        EXPECT_EQ(check_certificate(c->scene.target, Pose{}, c->scene.source, pose, backward).found,
                  check_certificate(c->scene.source, pose, c->scene.target, Pose{}, good).found);
    }
}

TEST(CertificateSoups, TheEndsOfTheRangeOfDoubles) {
    const auto bound_of = [](Points a, Points b) {
        const Certificate certificate = written(Proof(std::size_t(a.rows()), Tree{{Kind::one}}), infinity);
        return check_certificate(PointSet{std::move(a)}, Pose{}, PointSet{std::move(b)}, Pose{}, certificate).found;
    };
    EXPECT_NEAR(bound_of(rows({{1, 0, 0}}), rows({{1, 3e-200, 4e-200}})), 5e-200, 1e-215);  // squares underflow
    EXPECT_EQ(bound_of(rows({{0x1p1000, 0x1p-1000, 0}}), rows({{0x1p1000, 0, 0}})),
              0x1p-72);  // scaling loses a coordinate
    EXPECT_EQ(bound_of(rows({{5e-324, 0, 0}}), rows({{0, 0, 0}})), 5e-324);
    EXPECT_EQ(bound_of(rows({{5e-324, 5e-324, 0}}), rows({{0, 0, 0}})), 1e-323);  // the root of 2, rounded up
    EXPECT_EQ(bound_of(rows({{1.7e308, 0, 0}}), rows({{-1.7e308, 0, 0}})), infinity);
    EXPECT_EQ(bound_of(rows({{0x1p1023, 0, 0}}), rows({{0x1p1022, 0, 0}})), 0x1p1022);
    Pose far;
    far.translation = Vec3::Constant(1.7e308);
    const Shape a = PointSet{rows({{1e308, 0, 0}})};
    const CertificateCheck check = check_certificate(a, far, a, Pose{}, written(Proof{{{Kind::one}}}, infinity));
    EXPECT_EQ(check.refusal, "a pose moves a point beyond the largest double");
}

}  // namespace
}  // namespace hausbench
