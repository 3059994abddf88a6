// Groups of neighbouring triangles of A, level by level, for threshold cover (meshes/cover/cover.cpp).
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/scene.h"

#include <cstddef>
#include <vector>

namespace hausbench {

inline constexpr std::size_t cluster_triangles = 16;  // of the smallest groups

// The boxes of all groups, before A is posed. Level 0 has the boxes of clusters, each further level a quarter as
// many, down to 64 or fewer.
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

// The boxes of groups of A posed, each made on demand. The box of a cluster is as tight as possible; the box of a
// larger group contains its unposed box, turned (kernel/posed_box.h). So if most groups are settled at once, no work
// is done for single triangles.
class PosedGroupBoxes {
public:
    // References are kept. `points`: the vertices of A, posed. O(n), for their box.
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
    Box within_;  // of all of A
};

}  // namespace hausbench
