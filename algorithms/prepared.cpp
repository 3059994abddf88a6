#include "prepared.h"

#include <chrono>
#include <stdexcept>

namespace hausbench {

std::string to_string(const Need& need) {
    constexpr const char* names[] = {"octree", "point octree",     "R-tree",    "point blocks",
                                     "BVH",    "swept sphere BVH", "point BVH", "adjacency"};
    return std::string(need.side == Side::source ? "source " : "target ") +
           names[static_cast<std::size_t>(need.structure)];
}

bool fits(Structure structure, ShapeKind kind) {
    const bool of_points = structure == Structure::point_octree || structure == Structure::rtree ||
                           structure == Structure::point_blocks || structure == Structure::point_bvh;
    return kind == ShapeKind::mesh || (kind == ShapeKind::points && of_points);
}

Prepared::Prepared(const Scene& scene, const Needs& needs) {
    for (const Need& need : needs) {
        if (has(need.structure, need.side)) continue;
        const auto side = static_cast<std::size_t>(need.side);
        const Shape& shape = need.side == Side::source ? scene.source : scene.target;
        if (!fits(need.structure, kind_of(shape))) {
            throw std::logic_error("a " + to_string(need) +
                                   " was declared, but the shape of that side is of another kind");
        }
        const auto begin = std::chrono::steady_clock::now();
        std::size_t bytes = 0;
        switch (need.structure) {
            case Structure::octree:
                bytes = octree_[side].emplace(std::get<TriangleMesh>(shape)).bytes();
                break;
            case Structure::point_octree:
                bytes = point_octree_[side].emplace(points_of(shape)).bytes();
                break;
            case Structure::rtree:
                bytes = rtree_[side].emplace(points_of(shape)).bytes();
                break;
            case Structure::bvh:
                bytes = bvh_[side].emplace(std::get<TriangleMesh>(shape)).bytes();
                break;
            case Structure::swept_bvh:
                bytes = swept_bvh_[side].emplace(std::get<TriangleMesh>(shape)).bytes();
                break;
            case Structure::point_bvh:
                bytes = point_bvh_[side].emplace(points_of(shape)).bytes();
                break;
            case Structure::adjacency:
                bytes = adjacency_[side].emplace(std::get<TriangleMesh>(shape)).bytes();
                break;
            case Structure::point_blocks:
                bytes = point_blocks_[side].emplace(points_of(shape)).bytes();
                break;
        }
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
        times_.push_back({to_string(need), elapsed.count(), bytes});
    }
}

bool Prepared::has(Structure structure, Side side) const {
    const auto at = static_cast<std::size_t>(side);
    switch (structure) {
        case Structure::octree:
            return octree_[at].has_value();
        case Structure::point_octree:
            return point_octree_[at].has_value();
        case Structure::rtree:
            return rtree_[at].has_value();
        case Structure::bvh:
            return bvh_[at].has_value();
        case Structure::swept_bvh:
            return swept_bvh_[at].has_value();
        case Structure::point_bvh:
            return point_bvh_[at].has_value();
        case Structure::adjacency:
            return adjacency_[at].has_value();
        case Structure::point_blocks:
            return point_blocks_[at].has_value();
    }
    return false;
}

template <class Kind>
const Kind& Prepared::get(const std::optional<Kind> (&built)[2], Structure structure, Side side) const {
    const Need need{structure, side};
    const auto& one = built[static_cast<std::size_t>(side)];
    if (!one) throw std::logic_error("the " + to_string(need) + " is used but was not declared in needs()");
    ++uses_[need];
    return *one;
}

const TriangleOctree& Prepared::octree(Side side) const { return get(octree_, Structure::octree, side); }
const TriangleBvh& Prepared::bvh(Side side) const { return get(bvh_, Structure::bvh, side); }
const SweptSphereBvh& Prepared::swept_bvh(Side side) const { return get(swept_bvh_, Structure::swept_bvh, side); }
const PointBvh& Prepared::point_bvh(Side side) const { return get(point_bvh_, Structure::point_bvh, side); }
const Adjacency& Prepared::adjacency(Side side) const { return get(adjacency_, Structure::adjacency, side); }
const PointOctree& Prepared::point_octree(Side side) const { return get(point_octree_, Structure::point_octree, side); }
const RTree& Prepared::rtree(Side side) const { return get(rtree_, Structure::rtree, side); }
const PointBlocks& Prepared::point_blocks(Side side) const { return get(point_blocks_, Structure::point_blocks, side); }

}  // namespace hausbench
