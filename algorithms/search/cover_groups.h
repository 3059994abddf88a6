// Groups of neighbouring triangles of A, level by level, for threshold cover (meshes/cover.cpp): which of them one measured point
// settles, and what is left as clusters.
#pragma once

#include "kernel/box.h"
#include "target.h"

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace hausbench {

// A point that was measured, near some triangles.
struct Landmark {
    Vec3 at = Vec3::Zero();
    double distance = 0;  // to B, as computed
    Index near = -1;      // triangle of B, nearest to it; -1: nothing was measured
    Index vertex = -1;    // of A that it is, or -1
};

// An upper bound of the distance of some triangles to B, and why: by the distance of this vertex of A to triangle `near` of B and the
// way there; with no vertex, -1, by the distances of all corners to that triangle.
struct KnownUpper {
    double value = std::numeric_limits<double>::infinity();
    Index near = -1, vertex = -1;

    void improve(const KnownUpper& other) {
        if (other.value < value) *this = other;
    }
};

// Triangles of A that follow one another in the order.
struct Cluster {
    std::size_t begin = 0, count = 0;
    KnownUpper upper;
    Landmark landmark;
};

inline constexpr std::size_t cluster_triangles = 16;  // of the smallest groups

// The boxes of all groups, before A is posed. Level 0 has those of clusters, each further level a quarter as many, down to 64 or fewer.
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

// Those of A posed, each made when it is asked for. That of a cluster is as tight as can be; that of a larger group holds its box before,
// turned (kernel/posed_box.h). So where most groups are settled at once, nothing is done for each triangle.
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

// The most promising first, `first` of them; the others in the order of A, so that neighbours follow one another.
void order_clusters(std::vector<Cluster>& clusters, std::size_t first);

}  // namespace hausbench
