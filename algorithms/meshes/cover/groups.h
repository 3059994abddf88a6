// Bounding boxes of groups of neighbouring triangles of A. Threshold cover (meshes/cover/cover.cpp) bounds the distance
// to B of whole groups before single triangles.
#pragma once

#include "algorithms/kernel/box.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/scene.h"

#include <cstddef>
#include <vector>

namespace hausbench::cover {

inline constexpr std::size_t cluster_triangles = 16;  // in a cluster, the smallest kind of group

// The bounding boxes of all groups of triangles of A, before A is moved by a pose. Level 0 has the boxes of clusters of
// 16 triangles. Each box of a higher level contains four boxes of the level below; the last level has at most 64 boxes.
class GroupBoxes {
public:
    GroupBoxes() = default;
    // `order` lists all triangles such that neighbours follow each other; consecutive triangles form a group. Takes
    // O(n). The result is the same for any number of threads.
    GroupBoxes(const Triangles& triangles, const Points& points, const std::vector<Index>& order,
               const Threads& threads = Threads());

    std::size_t levels() const { return boxes_.size(); }
    std::size_t bytes() const;
    const Box& box(std::size_t level, std::size_t group) const { return boxes_[level][group]; }
    static std::size_t triangles_of_group(std::size_t level) { return cluster_triangles << (2 * level); }

private:
    std::vector<std::vector<Box>> boxes_;
};

// The bounding boxes of the groups after A was moved by a pose, each computed on request. A cluster gets the tightest
// box around its moved vertices. A larger group gets the box around its moved box (kernel/posed_box.h), which is looser
// but takes constant time.
class PosedGroupBoxes {
public:
    // Keeps references. `points` are the vertices of A, moved by `pose`.
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
    Box within_;  // the box of all moved vertices, to which the boxes of larger groups are clipped
};

}  // namespace hausbench::cover
