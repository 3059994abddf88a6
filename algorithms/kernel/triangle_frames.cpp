#include "algorithms/kernel/triangle_frames.h"

#include "algorithms/kernel/watched.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/kernel/triangle_frames.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include "algorithms/kernel/triangle_frames-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {
namespace {

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

// A Vec3 in each lane.
struct Vector {
    V x, y, z;
};
HWY_INLINE Vector minus(const Vector& a, const Vector& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vector times(V s, const Vector& a) { return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)}; }
HWY_INLINE V dot(const Vector& a, const Vector& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vector choose(hn::Mask<D> mask, const Vector& yes, const Vector& no) {
    return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}
// Returns 1 / length, or 1 in lanes whose length is 0.
HWY_INLINE V inverse_or_one(V length) {
    const V one = hn::Set(D(), 1.0);
    return hn::Div(one, hn::IfThenElse(hn::Gt(length, hn::Zero(D())), length, one));
}
HWY_INLINE Vector of_length_one(const Vector& a) { return times(inverse_or_one(hn::Sqrt(dot(a, a))), a); }

HWY_INLINE void store(V value, float* to) {
    const hn::Rebind<float, D> d;
    hn::StoreU(hn::DemoteTo(d, value), d, to);
}
HWY_INLINE void store(V value, double* to) { hn::StoreU(value, D(), to); }

// The corners of one triangle in each lane, rotated cyclically so that ab is the longest edge.
struct Corners {
    Vector a, b, c;
};
HWY_INLINE Corners longest_edge_first(const CornerRows& corners, std::size_t lane) {
    const D d;
    const auto corner = [&](std::size_t v) HWY_ATTR {
        return Vector{hn::Load(d, corners.row[3 * v] + lane), hn::Load(d, corners.row[3 * v + 1] + lane),
                      hn::Load(d, corners.row[3 * v + 2] + lane)};
    };
    const Vector p = corner(0), q = corner(1), r = corner(2);
    const auto squared_edge = [&](const Vector& from, const Vector& to) HWY_ATTR {
        const Vector edge = minus(to, from);
        return dot(edge, edge);
    };
    const V pq = squared_edge(p, q), qr = squared_edge(q, r), rp = squared_edge(r, p);
    const auto qr_longest = hn::And(hn::Gt(qr, pq), hn::Ge(qr, rp));
    const auto rp_longest = hn::AndNot(qr_longest, hn::Gt(rp, pq));
    return {choose(qr_longest, q, choose(rp_longest, r, p)), choose(qr_longest, r, choose(rp_longest, p, q)),
            choose(qr_longest, p, choose(rp_longest, q, r))};
}

// Returns the unit vector h that is orthogonal to e, the direction of the longest edge ab, in the plane of the
// triangle. `g` is c - a minus its component along e. Rounding may leave a component along e that is large compared
// with a short g, so g is scaled to length 1 and made orthogonal to e again. For a flat triangle, any direction
// orthogonal to e will do; it is made from a coordinate axis that is not near e.
HWY_INLINE Vector direction_across(const Vector& e, const Vector& g, hn::Mask<D> is_flat) {
    const D d;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const auto near_x = hn::Ge(hn::Abs(e.x), hn::Set(d, 0.6));
    const Vector axis{hn::IfThenZeroElse(near_x, one), hn::IfThenElseZero(near_x, one), zero};
    Vector h = of_length_one(choose(is_flat, axis, g));
    for (int step = 0; step < 2; ++step) h = of_length_one(minus(h, times(dot(h, e), e)));
    return h;
}
HWY_INLINE Vector cross(const Vector& e, const Vector& h) {
    return {hn::Sub(hn::Mul(e.y, h.z), hn::Mul(e.z, h.y)), hn::Sub(hn::Mul(e.z, h.x), hn::Mul(e.x, h.z)),
            hn::Sub(hn::Mul(e.x, h.y), hn::Mul(e.y, h.x))};
}

// Computes the frames of the triangles in one vector, beginning with lane `lane`.
template <class T> HWY_INLINE void frame(const CornerRows& corners, std::size_t lane, TriangleFrames<T>& frames) {
    const D d;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const auto [a, b, c] = longest_edge_first(corners, lane);
    const Vector ab = minus(b, a), w = minus(c, a);
    const V length = hn::Sqrt(dot(ab, ab));
    const double tiny = WATCHED_ELSE("triangle frames: lengths whose squares lose all digits", frame_point, 0x1p-535);
    const V least_edge =
        WATCHED_ELSE("triangle frames: no direction from an edge whose square underflows", hn::Set(d, tiny), zero);
    const V least_height =
        WATCHED_ELSE("triangle frames: no direction from a height whose square underflows", hn::Set(d, 2 * tiny), zero);
    const auto is_point = hn::Not(hn::Gt(length, least_edge));
    const Vector e = choose(is_point, {one, zero, zero}, times(inverse_or_one(length), ab));
    const V x_c = dot(w, e);
    const Vector g = minus(w, times(x_c, e));
    const V flat = hn::Max(hn::Mul(hn::Set(d, 8 * frame_roundoff<T>), length), least_height);
    const auto is_flat = hn::Not(hn::Gt(hn::Sqrt(dot(g, g)), flat));  // true for points, too
    const Vector h = direction_across(e, g, is_flat);

    const auto put = [&](std::size_t row, V value) HWY_ATTR { store(value, frames.row[row] + lane); };
    const Vector axes[3] = {e, h, cross(e, h)};
    for (std::size_t k = 0; k < 3; ++k) {
        put(3 * k, axes[k].x);
        put(3 * k + 1, axes[k].y);
        put(3 * k + 2, axes[k].z);
        put(frame_row::shift + k, hn::Neg(dot(a, axes[k])));
    }
    put(frame_row::length, length);
    const V y_c = hn::Max(dot(w, h), zero);
    // Stores the edge from corner a or b to c; (x, y_c) is c minus that corner. In a flat triangle, both edges are
    // stored as ab, in opposite directions, so that no point off the line counts as inside.
    const auto put_edge = [&](std::size_t direction, std::size_t edge_length, V x, V along_ab) HWY_ATTR {
        const V size = hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(y_c, y_c))), inverse = inverse_or_one(size);
        put(direction, hn::IfThenElse(is_flat, along_ab, hn::Mul(x, inverse)));
        put(direction + 1, hn::IfThenZeroElse(is_flat, hn::Mul(y_c, inverse)));
        put(edge_length, hn::IfThenElse(is_flat, length, size));
    };
    put_edge(frame_row::ac, frame_row::ac_length, x_c, one);
    put_edge(frame_row::bc, frame_row::bc_length, hn::Sub(x_c, length), hn::Neg(one));
}

template <class T> void make(const CornerRows& corners, TriangleFrames<T>& frames) {
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(D())) frame(corners, lane, frames);
}
void make_float(const CornerRows& corners, TriangleFrames<float>& frames) { make(corners, frames); }
void make_double(const CornerRows& corners, TriangleFrames<double>& frames) { make(corners, frames); }

template <class T> void measure(const TriangleFrames<T>& frames, const T (&point)[3], T (&squared)[frames_width]) {
    const FrameLanes<T> d;
    for (std::size_t lane = 0; lane < frames_width; lane += hn::Lanes(d)) {
        const auto row = [&](std::size_t i) HWY_ATTR { return hn::Load(d, frames.row[i] + lane); };
        hn::StoreU(squared_in_frames<T>(row, hn::Set(d, point[0]), hn::Set(d, point[1]), hn::Set(d, point[2])), d,
                   squared + lane);
    }
}
void measure_float(const TriangleFrames<float>& frames, const float (&point)[3], float (&squared)[frames_width]) {
    measure(frames, point, squared);
}
void measure_double(const TriangleFrames<double>& frames, const double (&point)[3], double (&squared)[frames_width]) {
    measure(frames, point, squared);
}

}  // namespace
}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench {

HWY_EXPORT(make_float);
HWY_EXPORT(make_double);
HWY_EXPORT(measure_float);
HWY_EXPORT(measure_double);

void make_frames(const CornerRows& corners, TriangleFrames<float>& frames) {
    HWY_DYNAMIC_DISPATCH(make_float)(corners, frames);
}
void make_frames(const CornerRows& corners, TriangleFrames<double>& frames) {
    HWY_DYNAMIC_DISPATCH(make_double)(corners, frames);
}
void squared_distances(const TriangleFrames<float>& frames, const float (&point)[3], float (&squared)[frames_width]) {
    HWY_DYNAMIC_DISPATCH(measure_float)(frames, point, squared);
}
void squared_distances(const TriangleFrames<double>& frames, const double (&point)[3],
                       double (&squared)[frames_width]) {
    HWY_DYNAMIC_DISPATCH(measure_double)(frames, point, squared);
}

}  // namespace hausbench
#endif
