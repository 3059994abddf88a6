#include "prepared.h"

#include <chrono>
#include <stdexcept>

namespace hausbench {

std::string to_string(const Need& need) {
    return std::string(need.side == Side::source ? "source" : "target") + " octree";
}

Prepared::Prepared(const Scene& scene, const Needs& needs) {
    for (const Need& need : needs) {
        const auto side = static_cast<std::size_t>(need.side);
        if (octree_[side]) continue;
        const auto* mesh = std::get_if<TriangleMesh>(need.side == Side::source ? &scene.source : &scene.target);
        if (!mesh) throw std::logic_error("a " + to_string(need) + " was asked for, but that side is not a mesh");
        const auto begin = std::chrono::steady_clock::now();
        octree_[side].emplace(*mesh);
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
        times_.push_back({to_string(need), elapsed.count(), octree_[side]->bytes()});
    }
}

bool Prepared::has(Structure structure, Side side) const {
    return structure == Structure::octree && octree_[static_cast<std::size_t>(side)].has_value();
}

const TriangleOctree& Prepared::octree(Side side) const {
    const Need need{Structure::octree, side};
    const auto& octree = octree_[static_cast<std::size_t>(side)];
    if (!octree) throw std::logic_error("the " + to_string(need) + " is used but was not declared in needs()");
    ++uses_[need];
    return *octree;
}

}  // namespace hausbench
