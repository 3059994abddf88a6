// Checks arbitrary bytes as a certificate of a small fixed scene. The bound that the checker finds must
// not be below the exact distance of any corner or centroid of A. First byte: the scene; the next two:
// `proven`. If the first byte is 255, a certificate file follows. If it is 254, the second byte chooses
// the scene, and a file without its seal (the hash in its last line) follows.
#include "algorithms/kernel/triangle.h"
#include "datasets/shape_file.h"
#include "harness/check/certificate_check.h"
#include "harness/check/certificate_file.h"
#include "tests/fuzz/exact_distance.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/target.h"
#include "tests/support/exact.h"
#include "tests/support/scenes.h"
#include "tests/support/seal.h"

#include <cmath>

namespace hausbench::fuzz {
namespace {

using exact::Rational;

struct Known {
    Scene scene;
    Rational squared;  // of the farthest corner or centroid of A; at most h(A,B)^2
};

std::vector<exact::RVec3> samples(const Shape& shape) {
    std::vector<exact::RVec3> all;
    if (kind_of(shape) == ShapeKind::points) {
        for (Index i = 0; i < points_of(shape).rows(); ++i) all.push_back(exact::vector(points_of(shape).row(i)));
        return all;
    }
    for (Index t = 0; t < mesh_of(shape).triangles.rows(); ++t) {
        const Triangle v = triangle_of(mesh_of(shape), t);
        const exact::RVec3 a = exact::vector(v.a), b = exact::vector(v.b), c = exact::vector(v.c);
        const auto mean = [](const exact::RVec3& x, const exact::RVec3& y, const exact::RVec3& z) {
            return exact::RVec3{(x[0] + y[0] + z[0]) / 3, (x[1] + y[1] + z[1]) / 3, (x[2] + y[2] + z[2]) / 3};
        };
        all.insert(all.end(), {a, b, c, mean(a, b, c), mean(a, a, b), mean(b, b, c), mean(c, c, a)});
    }
    return all;
}

Known measured(Shape a, Shape b) {
    Rational most = 0;
    for (const exact::RVec3& p : samples(a)) most = std::max(most, squared_to(p, b));
    return {{std::move(a), std::move(b)}, most};
}

const std::vector<Known>& scenes() {
    static const std::vector<Known> all = [] {
        std::vector<Known> list;
        const TriangleMesh one = soup(rows({{0, 0, 0}, {2, 0, 0}, {0, 1, 0}}));
        const TriangleMesh two =
            soup(rows({{0, 0, 0.5}, {1, 1, 0.5}, {0.5, 0.5 + 1e-13, 0.5}, {0, 0, 0}, {2, 0, 0.25}, {1, 1e-9, 0}}));
        list.push_back(measured(one, two));
        list.push_back(measured(two, one));
        list.push_back(measured(sheet(2, 0.125, 0.25), cube(0.75)));
        list.push_back(measured(PointSet{lattice(2, 0.5)}, two));
        return list;
    }();
    return all;
}

// Checks that text has no control characters, which could change a terminal. U+0080 to U+009F take two bytes.
void expect_plain(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        const bool second = c == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0;
        expect((c >= 0x20 && c != 0x7f && !second) || c == '\n', "a control character is printed");
    }
}

// If a file is accepted, its bounds must hold. Its printed description must be plain text in any case.
void verify_file(CertificateFile content, const Known& reference) {
    content.source.sha256 = content_hash(reference.scene.source);  // otherwise every file is refused
    content.target.sha256 = content_hash(reference.scene.target);
    const CertificateVerdict verdict = verify_certificate(content, reference.scene.source, reference.scene.target);
    expect(verdict.accepted == verdict.refusal.empty(), "neither accepted nor refused");
    expect_plain(describe(content, verdict));
    // A pose rounds the points, so the exact distance is known only without poses.
    if (!verdict.accepted || !content.source.pose.is_identity() || !content.target.pose.is_identity()) return;
    const Rational proven = verdict.proven;
    expect(proven * proven >= reference.squared, "accepted, although the bound does not hold");
    expect(content.bounds.lower <= verdict.proven, "accepted, although the lower bound does not hold");
    expect(verdict.proven <= content.bounds.upper, "accepted, although the upper bound is not proven");
}

void certificates(std::string_view bytes) {
    Bytes in(bytes);
    const std::uint32_t choice = in.byte();
    if (choice >= 254) {
        try {
            if (choice == 255) {
                read_certificate(MemoryFile(in.rest()).path());
            } else {
                const Known& reference = scenes()[in.byte() % scenes().size()];
                verify_file(read_certificate(MemoryFile(sealed(in.rest())).path()), reference);
            }
        } catch (const InputError& error) {
            expect_one_line(error);
        }
        return;
    }
    const Known& reference = scenes()[choice % scenes().size()];
    const double mantissa = 1 + in.byte() / 64.0;
    const double proven = std::ldexp(mantissa, static_cast<int>(in.below(16)) - 12);
    const Certificate certificate{"hausbench cover 1", Witness::Direction::source_to_target, proven,
                                  std::string(in.rest())};
    const CertificateCheck check =
        check_certificate(reference.scene.source, {}, reference.scene.target, {}, certificate);
    expect(check.accepted == check.refusal.empty(), "neither accepted nor refused");
    expect(check.found >= 0, "a bound that is no distance");
    if (check.accepted) expect(check.found <= proven, "accepted, although less is proven");
    if (std::isfinite(check.found)) {
        const Rational bound = check.found;
        expect(bound * bound >= reference.squared, "a bound that does not hold");
    }
}

}  // namespace
}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(certificates)
