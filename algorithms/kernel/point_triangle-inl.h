// A vectorised closest_point() (point_triangle.h) for several points and triangles at a time, one pair in each lane.
// Compiled once for each instruction set, which Highway calls a target: include this file after hwy/foreach_target.h.
//
// Every target gives the same bits as the scalar function, because it performs the same operations in the same order,
// without fused multiply-add and without approximate reciprocals.
#include "algorithms/kernel/triangle_block.h"
#include "algorithms/kernel/watched.h"

#include <hwy/highway.h>

#if defined(HAUSBENCH_POINT_TRIANGLE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef HAUSBENCH_POINT_TRIANGLE_INL
#undef HAUSBENCH_POINT_TRIANGLE_INL
#else
#define HAUSBENCH_POINT_TRIANGLE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most four lanes. A leaf of a search tree has eight triangles, but usually only a few are near enough to need their
// distances, so eight lanes would mostly be wasted.
using Doubles = hn::CappedTag<double, 4>;
using V = hn::Vec<Doubles>;

// A Vec3 in each lane.
struct V3 {
    V x, y, z;
};

HWY_INLINE V3 operator-(const V3& a, const V3& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
HWY_INLINE V3 operator+(const V3& a, const V3& b) { return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)}; }
HWY_INLINE V3 operator*(V s, const V3& a) { return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)}; }
HWY_INLINE V dot(const V3& a, const V3& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE V3 min(const V3& a, const V3& b) { return {hn::Min(a.x, b.x), hn::Min(a.y, b.y), hn::Min(a.z, b.z)}; }
HWY_INLINE V3 max(const V3& a, const V3& b) { return {hn::Max(a.x, b.x), hn::Max(a.y, b.y), hn::Max(a.z, b.z)}; }
HWY_INLINE V3 set(const Vec3& a) {
    const Doubles d;
    return {hn::Set(d, a[0]), hn::Set(d, a[1]), hn::Set(d, a[2])};
}
// Loads the x, y and z of neighbouring lanes, beginning with `lane`, from the three rows of a block.
HWY_INLINE V3 load(const double (&rows)[3][block_width], std::size_t lane) {
    const Doubles d;
    return {hn::Load(d, rows[0] + lane), hn::Load(d, rows[1] + lane), hn::Load(d, rows[2] + lane)};
}
HWY_INLINE void store(const V3& a, double (&rows)[3][block_width], std::size_t lane) {
    const Doubles d;
    hn::Store(a.x, d, rows[0] + lane);
    hn::Store(a.y, d, rows[1] + lane);
    hn::Store(a.z, d, rows[2] + lane);
}

struct VBox {
    V3 low, high;
};

HWY_INLINE VBox box_of(const V3& a, const V3& b, const V3& c) { return {min(min(a, b), c), max(max(a, b), c)}; }

HWY_INLINE V squared_distance_to_box(const V3& p, const VBox& box) {
    const V zero = hn::Zero(Doubles());
    const V3 d = max(max(box.low - p, p - box.high), {zero, zero, zero});
    return dot(d, d);
}

// Returns the point of an edge that is closest to a query point p, in each lane. `along` is (to - from).(p - from),
// `length` the squared length of the edge, and `inverse` is 1 / length.
HWY_INLINE V3 closest_on_edge(const V3& from, const V3& to, V along, V length, V inverse) {
    const Doubles d;
    const V one = hn::Set(d, 1.0);
    V t = hn::IfThenElse(hn::Lt(along, length), hn::Min(hn::Mul(along, inverse), one), one);
    t = hn::IfThenElseZero(hn::Gt(along, hn::Zero(d)), t);
    return hn::Sub(one, t) * from + t * to;
}

// The point of a triangle that is closest to a query point, in each lane.
struct VFoot {
    V squared;  // squared distance from the query point
    V3 point;
};

// Replaces `best` with q in the lanes in which q is nearer to p.
HWY_INLINE void offer(const V3& p, const V3& q, VFoot& best) {
    const V3 r = p - q;
    const V squared = dot(r, r);
    const auto nearer = hn::Lt(squared, best.squared);
    best.squared = hn::IfThenElse(nearer, squared, best.squared);
    best.point = {hn::IfThenElse(nearer, q.x, best.point.x), hn::IfThenElse(nearer, q.y, best.point.y),
                  hn::IfThenElse(nearer, q.z, best.point.z)};
}

// Returns the point of triangle abc closest to p, in each lane. ab must be the longest edge, and `box` the bounding
// box.
HWY_INLINE VFoot closest_point(const V3& p, const V3& a, const V3& b, const V3& c, const VBox& box) {
    const Doubles d;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const V3 e = b - a, f = c - a, g = c - b, ap = p - a, bp = p - b;
    const V ee = dot(e, e), ff = dot(f, f), gg = dot(g, g);
    const V along_e = dot(e, ap), along_f = dot(f, ap), along_g = dot(g, bp);
    const V inverse_e = hn::Div(one, ee);

    VFoot best;
    best.point = closest_on_edge(a, b, along_e, ee, inverse_e);
    const V3 r = p - best.point;
    best.squared = dot(r, r);
    offer(p, closest_on_edge(a, c, along_f, ff, hn::Div(one, ff)), best);
    offer(p, closest_on_edge(b, c, along_g, gg, hn::Div(one, gg)), best);

    const V x_c = hn::Mul(dot(f, e), inverse_e);
    V3 h = f - x_c * e;
    if (WATCHED("closest_point: the height is made orthogonal to the longest edge twice", true))
        h = h - hn::Mul(dot(h, e), inverse_e) * e;
    const V y = hn::Div(dot(h, ap), dot(h, h));
    const V x = hn::Sub(hn::Mul(along_e, inverse_e), hn::Mul(y, x_c));
    const V3 q = (hn::Max(hn::Sub(hn::Sub(one, x), y), zero) * a + x * b) + y * c;
    const auto inside = hn::And(hn::And(hn::Ge(x, zero), hn::Ge(y, zero)), hn::Le(hn::Add(x, y), one));
    const V3 rq = p - q;
    const V squared = dot(rq, rq);
    const auto nearer = hn::And(inside, hn::Lt(squared, best.squared));
    best.point = {hn::IfThenElse(nearer, q.x, best.point.x), hn::IfThenElse(nearer, q.y, best.point.y),
                  hn::IfThenElse(nearer, q.z, best.point.z)};

    best.point = min(max(best.point, box.low), box.high) + V3{zero, zero, zero};  // -0 becomes 0
    const V3 rest = p - best.point;
    best.squared = dot(rest, rest);
    return best;
}

}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
