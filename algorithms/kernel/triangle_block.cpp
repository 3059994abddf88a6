#include "algorithms/kernel/triangle_block.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/kernel/triangle_block.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h:
#include "algorithms/kernel/point_triangle-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {

void point_to_block(const Vec3& point, const TriangleBlock& block, BlockFeet& feet) {
    const V3 p = set(point);
    for (std::size_t lane = 0; lane < block_width; lane += hn::Lanes(Doubles())) {
        const V3 a = load(block.corner[0], lane), b = load(block.corner[1], lane), c = load(block.corner[2], lane);
        const VFoot foot = closest_point(p, a, b, c, box_of(a, b, c));
        hn::Store(foot.squared, Doubles(), feet.squared_distance + lane);
        store(foot.point, feet.point, lane);
    }
}

// `count` is a constant, so that the loop is unrolled.
template <std::size_t count>
void points_to_triangle(const PointBlock& points, const Triangle& triangle, BlockFeet& feet) {
    const V3 a = set(triangle.a), b = set(triangle.b), c = set(triangle.c);
    const VBox box = box_of(a, b, c);
    for (std::size_t lane = 0; lane < count; lane += hn::Lanes(Doubles())) {
        const VFoot foot = closest_point(load(points.coordinate, lane), a, b, c, box);
        hn::Store(foot.squared, Doubles(), feet.squared_distance + lane);
        store(foot.point, feet.point, lane);
    }
}

void block_to_triangle(const PointBlock& points, const Triangle& triangle, BlockFeet& feet) {
    points_to_triangle<block_width>(points, triangle, feet);
}

void half_block_to_triangle(const PointBlock& points, const Triangle& triangle, BlockFeet& feet) {
    points_to_triangle<block_width / 2>(points, triangle, feet);
}

}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench {

HWY_EXPORT(point_to_block);
HWY_EXPORT(block_to_triangle);
HWY_EXPORT(half_block_to_triangle);

void closest_points(const Vec3& point, const TriangleBlock& block, BlockFeet& feet) {
    HWY_DYNAMIC_DISPATCH(point_to_block)(point, block, feet);
}

void closest_points(const PointBlock& points, const Triangle& triangle, BlockFeet& feet) {
    HWY_DYNAMIC_DISPATCH(block_to_triangle)(points, longest_edge_first(triangle), feet);
}

void closest_points_of_half(const PointBlock& points, const Triangle& triangle, BlockFeet& feet) {
    HWY_DYNAMIC_DISPATCH(half_block_to_triangle)(points, longest_edge_first(triangle), feet);
}

}  // namespace hausbench
#endif
