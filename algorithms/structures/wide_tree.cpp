#include "algorithms/structures/wide_tree.h"

#include <array>

namespace hausbench {

void WideTree::fit(std::span<const Box> leaf_boxes) {
    std::vector<Box> node_boxes(nodes.size());
    // Parents come before their children, so in reverse order the boxes of the children are known first.
    for (std::size_t n = nodes.size(); n-- > 0;) {
        WideNode& node = nodes[n];
        std::array<Box, tree_width> boxes;
        const auto count = static_cast<std::size_t>(node.count);
        for (std::size_t c = 0; c < count; ++c) {
            const std::int32_t child = node.child[c];
            boxes[c] =
                child >= 0 ? node_boxes[static_cast<std::size_t>(child)] : leaf_boxes[static_cast<std::size_t>(~child)];
        }
        node_boxes[n] = node.boxes.set(std::span(boxes).first(count));
    }
}

}  // namespace hausbench
