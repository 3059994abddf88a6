// Finds the closest of several triangles to a point, with as many triangles at a time as a vector of doubles has lanes.
// Compiled once for each instruction set: include this file after hwy/foreach_target.h.
#include "algorithms/kernel/closest.h"
#include "algorithms/kernel/point_triangle-inl.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#if defined(HAUSBENCH_NEAREST_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HAUSBENCH_NEAREST_INL
#undef HAUSBENCH_NEAREST_INL
#else
#define HAUSBENCH_NEAREST_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {

// Loads the same corner of several triangles, one triangle per lane. place[k] points to the three coordinates of the
// corner for lane k.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE V3 gather(const double* const (&place)[4]) {
    const Doubles d;
    return {hn::Set(d, place[0][0]), hn::Set(d, place[0][1]), hn::Set(d, place[0][2])};
}
#else
HWY_INLINE V3 gather(const double* const (&place)[4]) {
    const hn::FixedTag<double, 2> pair;
#if HWY_CAP_GE256
    const Doubles d;
    const hn::FixedTag<double, 1> single;
    const auto xy = [&](int lower, int upper) HWY_ATTR {
        return hn::Combine(d, hn::LoadU(pair, place[upper]), hn::LoadU(pair, place[lower]));
    };
    const auto z = [&](int lower, int upper) HWY_ATTR {
        return hn::Combine(pair, hn::LoadU(single, place[upper] + 2), hn::LoadU(single, place[lower] + 2));
    };
    const V even = xy(0, 2), odd = xy(1, 3);
    return {hn::InterleaveLower(d, even, odd), hn::InterleaveUpper(d, even, odd), hn::Combine(d, z(2, 3), z(0, 1))};
#else
    const V first = hn::LoadU(pair, place[0]), second = hn::LoadU(pair, place[1]);
    return {hn::InterleaveLower(pair, first, second), hn::InterleaveUpper(pair, first, second),
            hn::InterleaveUpper(pair, hn::LoadU(pair, place[0] + 1), hn::LoadU(pair, place[1] + 1))};
#endif
}
#endif

// Updates `best` with the nearest triangle among the lanes set in the mask `lanes`; triangle[k] is the index of the
// triangle in lane k. Visits only the lanes at the smallest distance. Ties are rare, so this is mostly one lane, and
// the branches are predictable.
HWY_INLINE void offer_nearest(const VFoot& foot, unsigned lanes, const Index* triangle, ClosestPoint& best) {
    const Doubles d;
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(lanes)};
    const V squares = hn::IfThenElse(hn::LoadMaskBits(d, bytes), foot.squared, hn::Inf(d));
    const V least = hn::MinOfLanes(d, squares);
    if (hn::GetLane(least) > best.squared_distance) return;
    alignas(64) double feet[3][block_width];
    store(foot.point, feet, 0);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Eq(squares, least), bits);
    for (unsigned offered = bits[0] & lanes; offered != 0; offered &= offered - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(offered));
        offer(best, {hn::GetLane(least), {feet[0][k], feet[1][k], feet[2][k]}}, triangle[k]);
    }
}

// Computes the distances to `count` triangles of a mesh, given by their indices, and updates `best`. Not inlined, so
// that the code exists only once.
inline HWY_NOINLINE void offer_triangles(const Vec3& point, const TriangleMesh& mesh, const Index* triangle,
                                         std::size_t count, ClosestPoint& best) {
    const Doubles d;
    const V3 p = set(point);
    const double* const vertices = mesh.vertices.data();
    for (std::size_t begin = 0; begin < count; begin += hn::Lanes(d)) {
        const std::size_t used = std::min(hn::Lanes(d), count - begin);
        const double* place[3][4];
        for (std::size_t k = 0; k < used; ++k) {
            const Index* const corners = mesh.triangles.row(triangle[begin + k]).data();
            const double* at[3];
            for (int v = 0; v < 3; ++v) at[v] = vertices + 3 * static_cast<std::ptrdiff_t>(corners[v]);
            const auto squared_edge = [&](int from, int to) {
                const double x = at[to][0] - at[from][0], y = at[to][1] - at[from][1], z = at[to][2] - at[from][2];
                return (x * x + y * y) + z * z;
            };
            // Find the longest edge like longest_edge() (triangle.h), but without an unpredictable branch.
            const double ab = squared_edge(0, 1), bc = squared_edge(1, 2), ca = squared_edge(2, 0);
            const unsigned is_bc = static_cast<unsigned>(bc > ab) & static_cast<unsigned>(bc >= ca);
            const unsigned first = is_bc | (static_cast<unsigned>(ca > ab) & (is_bc ^ 1)) << 1;
            const double* const turned[5] = {at[0], at[1], at[2], at[0], at[1]};
            for (unsigned v = 0; v < 3; ++v) place[v][k] = turned[v + first];
        }
        for (std::size_t k = used; k < hn::Lanes(d); ++k)
            for (auto& corner : place) corner[k] = corner[0];
        const V3 a = gather(place[0]), b = gather(place[1]), c = gather(place[2]);
        offer_nearest(closest_point(p, a, b, c, box_of(a, b, c)), (1U << used) - 1, triangle + begin, best);
    }
}

}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
