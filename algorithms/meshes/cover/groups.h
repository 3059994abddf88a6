// Hierarchical groups of neighbouring triangles of A for threshold cover (meshes/cover/cover.cpp).
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/scene.h"

#include <cstddef>
#include <vector>

namespace hausbench {

inline constexpr std::size_t cluster_triangles = 16;  // of a cluster, the smallest group

// The boxes of all groups of A in its own pose. Level 0 contains the boxes of clusters. Each further level has a
// quarter as many, down to at most 64.
class GroupBoxes {
public:
    GroupBoxes() = default;
    // O(n).
    GroupBoxes(const Triangles& triangles, const Points& points, const std::vector<Index>& order);

    std::size_t levels() const { return boxes_.size(); }
    std::size_t bytes() const;
    const Box& box(std::size_t level, std::size_t group) const { return boxes_[level][group]; }
    static std::size_t triangles_of_group(std::size_t level) { return cluster_triangles << (2 * level); }

private:
    std::vector<std::vector<Box>> boxes_;
};

// The boxes of the groups of A posed, each computed on request. A cluster gets its tightest box; a larger group gets
// the rotated box of the unposed group (kernel/posed_box.h). So if most groups are settled at once, single triangles
// cost nothing.
class PosedGroupBoxes {
public:
    // Keeps references. `points` are the vertices of A, posed; computing their box takes O(n).
    PosedGroupBoxes(const GroupBoxes& boxes, const Triangles& triangles, const Points& points,
                    const std::vector<Index>& order, const Pose& pose);

    std::size_t levels() const { return boxes_.levels(); }
    Box box(std::size_t level, std::size_t group) const;

private:
    const GroupBoxes& boxes_;
    const Triangles& triangles_;
    const Points& points_;
    const std::vector<Index>& order_;
    const Pose& pose_;
    Box within_;  // the box of A posed
};

}  // namespace hausbench
