#include "wide_tree.h"

#include <algorithm>
#include <cmath>

namespace hausbench {

LocalFrame LocalFrame::of(const Box& box) {
    LocalFrame frame;
    for (int k = 0; k < 3; ++k) frame.centre[k] = 0.5 * (box.low[k] + box.high[k]);
    const double half = (box.high - box.low).maxCoeff();
    if (half > 0) frame.scale = std::ldexp(1.0, std::clamp(-std::ilogb(half), -1000, 440));
    return frame;
}

LocalBoxes local_boxes(const Points& points) {
    Box box;
    for (Eigen::Index i = 0; i < points.rows(); ++i) box.add(Vec3(points.row(i)));
    LocalBoxes result{LocalFrame::of(box), {}};
    result.boxes.reserve(static_cast<std::size_t>(points.rows()));
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        float low[3], high[3];
        for (int k = 0; k < 3; ++k) result.frame.interval(points.row(i), k, low[k], high[k]);
        result.boxes.push_back({Float4{low[0], low[1], low[2], 0}, Float4{high[0], high[1], high[2], 0}});
    }
    return result;
}

// The box of a triangle's intervals is the union of its vertices'.
LocalBoxes local_boxes(const TriangleMesh& mesh) {
    const LocalBoxes vertices = local_boxes(mesh.vertices);
    LocalBoxes result{vertices.frame, {}};
    result.boxes.reserve(static_cast<std::size_t>(mesh.triangles.rows()));
    for (Index i = 0; i < mesh.triangles.rows(); ++i) {
        FloatBox box = vertices.boxes[static_cast<std::size_t>(mesh.triangles(i, 0))];
        box.add(vertices.boxes[static_cast<std::size_t>(mesh.triangles(i, 1))]);
        box.add(vertices.boxes[static_cast<std::size_t>(mesh.triangles(i, 2))]);
        result.boxes.push_back(box);
    }
    return result;
}

void refit(WideTree& tree, const LocalBoxes& boxes) {
    tree.frame = boxes.frame;
    // Children come after their parents.
    for (std::size_t n = tree.nodes.size(); n-- > 0;) {
        WideNode& node = tree.nodes[n];
        for (int c = 0; c < tree_width; ++c) {
            FloatBox box;
            const std::int32_t child = node.child[c < node.count ? c : 0];
            if (child >= 0) {
                const WideNode& below = tree.nodes[static_cast<std::size_t>(child)];
                for (int i = 0; i < below.count; ++i) {
                    box.add(FloatBox{Float4{below.low[0][i], below.low[1][i], below.low[2][i], 0},
                                     Float4{below.high[0][i], below.high[1][i], below.high[2][i], 0}});
                }
            } else {
                for (const Index element : tree.leaf(static_cast<std::size_t>(~child))) {
                    box.add(boxes.boxes[static_cast<std::size_t>(element)]);
                }
            }
            for (int k = 0; k < 3; ++k) {
                node.low[k][c] = box.low[k];
                node.high[k][c] = box.high[k];
            }
        }
    }
}

}  // namespace hausbench
