// The squared distances from points to triangles that are given by their frames (triangle_frames.h), several at a time.
// Compiled once for every target (instruction set): include it after hwy/foreach_target.h.
//
// The results have the same bits on every target, because each lane takes the same operations, without fused
// multiply-add.
#include "algorithms/kernel/triangle_frames.h"

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

// Vectors of up to sixteen floats or eight doubles. With fewer than sixteen lanes, sixteen triangles take several
// steps.
template <class T> using FrameLanes = hn::CappedTag<T, sizeof(T) == 4 ? 16 : 8>;

// Returns the squared distance between one point and one triangle in each lane. row(i) returns row i (frame_row) of the
// frames as a vector; px, py and pz are the coordinates of the points. For one point and several triangles, px, py and
// pz have the same number in all lanes. For several points and one triangle, row(i) has the same number in all lanes.
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
    // Lowers `squared` to the squared distance from one edge, and `inner` to the distance from its line, which is
    // negative on the outer side. The edge starts at the corner with y = 0 whose x is smaller by from_x than the x of
    // the point. `t` is the coordinate along the edge, and `across` the signed distance from its line, positive on the
    // right. `right` says on which side of the edge the triangle is.
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
    const auto inside = hn::And(hn::Ge(inner, zero), hn::Eq(beyond, zero));
    return hn::Add(hn::IfThenZeroElse(inside, squared), hn::Mul(z, z));
}

template <class T, class Rows>
HWY_INLINE hn::Vec<FrameLanes<T>> squared_in_frames(const Rows& row, hn::Vec<FrameLanes<T>> px,
                                                    hn::Vec<FrameLanes<T>> py, hn::Vec<FrameLanes<T>> pz) {
    return squared_in_lanes(FrameLanes<T>(), row, px, py, pz);
}

// Returns a mask of up to sixteen lanes as a number: bit i is lane i.
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
