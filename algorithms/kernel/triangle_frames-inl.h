// Computes squared distances from points to triangles, several at a time. Each triangle is stored in its own coordinate
// system, its frame (triangle_frames.h). Compiled once for each instruction set, which Highway calls a target: include
// this file after hwy/foreach_target.h.
//
// Results have the same bits on every target, because each performs the same operations, without fused multiply-add.
#include "algorithms/kernel/triangle_frames.h"
#include "algorithms/kernel/watched.h"

#include <hwy/highway.h>

#if defined(HAUSBENCH_TRIANGLE_FRAMES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HAUSBENCH_TRIANGLE_FRAMES_INL
#undef HAUSBENCH_TRIANGLE_FRAMES_INL
#else
#define HAUSBENCH_TRIANGLE_FRAMES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Vectors of up to sixteen floats or eight doubles. If a vector has fewer than sixteen lanes, sixteen triangles take
// several vectors.
template <class T> using FrameLanes = hn::CappedTag<T, sizeof(T) == 4 ? 16 : 8>;

// Returns the squared distance between one point and one triangle in each lane. px, py and pz are the coordinates of
// the points; row(i) returns row i of the frames (see frame_row). To combine one point with several triangles, repeat
// its coordinates in all lanes. To combine one triangle with several points, repeat its rows.
template <class D, class Rows>
HWY_INLINE hn::Vec<D> squared_in_lanes(D d, const Rows& row, hn::Vec<D> px, hn::Vec<D> py, hn::Vec<D> pz) {
    using Numbers = hn::Vec<D>;
    const Numbers zero = hn::Zero(d);
    const auto coordinate = [&](std::size_t axis) HWY_ATTR {
        const Numbers xy = hn::Add(hn::Mul(row(3 * axis), px), hn::Mul(row(3 * axis + 1), py));
        return hn::Add(hn::Add(xy, hn::Mul(row(3 * axis + 2), pz)), row(frame_row::shift + axis));
    };
    const Numbers x = coordinate(0), y = coordinate(1), z = coordinate(2);
    const Numbers length = row(frame_row::length);
    const Numbers beyond = hn::Sub(x, hn::Min(hn::Max(x, zero), length));
    Numbers squared = hn::Add(hn::Mul(beyond, beyond), hn::Mul(y, y));
    Numbers inner = y;
    // Updates two minima for one edge of the triangle: `squared`, the squared distance from the edges, and `inner`, the
    // signed distance from their lines, which is negative outside. The edge starts at y = 0, and from_x is the x of the
    // point minus the x of this start. `right`: the triangle is on the right of the edge. `t` is the point's coordinate
    // along the edge, and `across` its signed distance from the line, positive on the right.
    const auto edge = [&](std::size_t direction, std::size_t edge_length, Numbers from_x, bool right) HWY_ATTR {
        const Numbers ux = row(direction), uy = row(direction + 1);
        const Numbers t = hn::Add(hn::Mul(from_x, ux), hn::Mul(y, uy));
        const Numbers across = hn::Sub(hn::Mul(from_x, uy), hn::Mul(y, ux));
        const Numbers off = hn::Sub(t, hn::Min(hn::Max(t, zero), row(edge_length)));
        squared = hn::Min(squared, hn::Add(hn::Mul(off, off), hn::Mul(across, across)));
        inner = hn::Min(inner, right ? across : hn::Neg(across));
    };
    edge(frame_row::ac, frame_row::ac_length, x, true);
    edge(frame_row::bc, frame_row::bc_length, hn::Sub(x, length), false);
    const auto inside = WATCHED_ELSE("triangle frames: a point beyond the ends of the longest edge is outside",
                                     hn::And(hn::Ge(inner, zero), hn::Eq(beyond, zero)), hn::Ge(inner, zero));
    return hn::Add(hn::IfThenZeroElse(inside, squared), hn::Mul(z, z));
}

template <class T, class Rows>
HWY_INLINE hn::Vec<FrameLanes<T>> squared_in_frames(const Rows& row, hn::Vec<FrameLanes<T>> px,
                                                    hn::Vec<FrameLanes<T>> py, hn::Vec<FrameLanes<T>> pz) {
    return squared_in_lanes(FrameLanes<T>(), row, px, py, pz);
}

// Converts a mask of up to sixteen lanes to an integer whose bit i is lane i.
template <class D> HWY_INLINE unsigned lane_bits(D d, hn::Mask<D> mask) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    return (bits[0] | static_cast<unsigned>(bits[1]) << 8) & ((1U << hn::Lanes(d)) - 1);
}
template <class T> HWY_INLINE unsigned mask_bits(hn::Mask<FrameLanes<T>> mask) {
    return lane_bits(FrameLanes<T>(), mask);
}

}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
