// Bytes as a certificate of small fixed scenes. Whatever they are, the bound that the checker finds must hold: it is held against the exact
// distances of points of A. The first byte chooses the scene, the next two `proven`.
#include "check/certificate_check.h"
#include "check/certificate_file.h"
#include "exact.h"
#include "exact_distance.h"
#include "kernel/triangle.h"
#include "memory_file.h"
#include "scenes.h"
#include "target.h"

#include <cmath>

namespace hausbench::fuzz {
namespace {

using exact::Rational;

struct Known {
    Scene scene;
    Rational squared;  // the largest at the corners and middles of A's triangles: h(A,B) is no smaller
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

Known known(Shape a, Shape b) {
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
        list.push_back(known(one, two));
        list.push_back(known(two, one));
        list.push_back(known(sheet(2, 0.125, 0.25), cube(0.75)));
        list.push_back(known(PointSet{lattice(2, 0.5)}, two));
        return list;
    }();
    return all;
}

void certificates(std::string_view bytes) {
    Bytes in(bytes);
    const std::uint32_t choice = in.byte();
    if (choice == 255) {  // a file
        try {
            read_certificate(MemoryFile(in.rest()).path());
        } catch (const InputError& error) {
            expect_one_line(error);
        }
        return;
    }
    const Known& one = scenes()[choice % scenes().size()];
    const double mantissa = 1 + in.byte() / 64.0;
    const double proven = std::ldexp(mantissa, static_cast<int>(in.below(16)) - 12);
    const Certificate certificate{"hausbench cover 1", Witness::Direction::source_to_target, proven,
                                  std::string(in.rest())};
    const CertificateCheck check = check_certificate(one.scene.source, {}, one.scene.target, {}, certificate);
    expect(check.accepted == check.refusal.empty(), "neither accepted nor refused");
    expect(check.found >= 0, "a bound that is no distance");
    if (check.accepted) expect(check.found <= proven, "accepted, although less is proven");
    if (std::isfinite(check.found)) {
        const Rational bound = check.found;
        expect(bound * bound >= one.squared, "a bound that does not hold");
    }
}

}  // namespace
}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(certificates)
