#include "algorithms/meshes/cover/groups.h"

#include "algorithms/kernel/pages.h"
#include "algorithms/kernel/posed_box.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <utility>

namespace hausbench::cover {

namespace {

constexpr std::size_t most_first_groups = 64, group_parts = 4;

Box box_of_cluster(const Triangles& triangles, const Points& points, const std::vector<Index>& order,
                   std::size_t cluster) {
    Box box;
    const std::size_t begin = cluster * cluster_triangles, end = std::min(order.size(), begin + cluster_triangles);
    for (std::size_t i = begin; i < end; ++i)
        for (const Index v : triangles.row(order[i])) box.add(Vec3(points.row(v)));
    return box;
}

}  // namespace

GroupBoxes::GroupBoxes(const Triangles& triangles, const Points& points, const std::vector<Index>& order,
                       const Threads& threads)
    : boxes_(1) {
    std::vector<Box>& clusters = boxes_[0];
    clusters = filled<Box>((order.size() + cluster_triangles - 1) / cluster_triangles);
    const std::size_t blocks = blocks_of(clusters.size(), 256);
    threads.for_each(blocks, [&](std::size_t block) {
        const Part mine = part(clusters.size(), block, blocks);
        for (std::size_t i = mine.begin; i < mine.end; ++i) clusters[i] = box_of_cluster(triangles, points, order, i);
    });
    while (boxes_.back().size() > most_first_groups) {
        const std::vector<Box>& below = boxes_.back();
        std::vector<Box> level((below.size() + group_parts - 1) / group_parts);
        for (std::size_t i = 0; i < below.size(); ++i)
            if (WATCHED_ELSE("cover: the last part of a group is in its box", true, i % group_parts != 3))
                level[i / group_parts].add(below[i]);
        boxes_.push_back(std::move(level));
    }
}

std::size_t GroupBoxes::bytes() const {
    std::size_t sum = 0;
    for (const std::vector<Box>& level : boxes_) sum += level.capacity() * sizeof(Box);
    return sum;
}

PosedGroupBoxes::PosedGroupBoxes(const GroupBoxes& boxes, const Triangles& triangles, const Points& points,
                                 const std::vector<Index>& order, const Pose& pose)
    : boxes_(boxes), triangles_(triangles), points_(points), order_(order), pose_(pose) {
    if (!pose.is_identity()) within_ = box_of(points);
}

Box PosedGroupBoxes::box(std::size_t level, std::size_t group) const {
    if (pose_.is_identity()) return boxes_.box(level, group);
    if (level == 0) return box_of_cluster(triangles_, points_, order_, group);
    return WATCHED_ELSE("cover: boxes of groups are moved with A", posed_box(boxes_.box(level, group), pose_, within_),
                        boxes_.box(level, group));
}

}  // namespace hausbench::cover
