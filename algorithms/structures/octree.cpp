#include "algorithms/structures/tree_builder.h"

#include <algorithm>

namespace hausbench {
namespace {

using namespace builder;

constexpr int most_depth = 48;   // from this depth of the tree on, ranges are divided into parts of equal size
constexpr int most_levels = 24;  // how often a cell is halved; single precision resolves no smaller cells

// Divides the elements of a node among the octants of the smallest cell that contains all their centres. A cell is
// given by its lower corner and its side. The root cell is [-2, 2]^3, because centres are doubled (centre_of), and each
// level halves the side.
class OctreeSplit {
public:
    explicit OctreeSplit(Builder& builder) : builder_(builder), scratch_(builder.elements.size()) {}

    int operator()(const Range& whole, int depth, std::array<Range, tree_width>& parts) {
        if (whole.size() <= tree_width * leaf_capacity) return split_into_leaves(whole, parts);
        // Find the smallest cell that contains all centres, starting at the root. This skips the cells that have
        // centres in only one octant.
        Float4 corner = Float4{} - 2;
        float side = 4;
        for (int level = 0; level < most_levels && depth < most_depth; ++level) {
            side *= 0.5F;
            const Float4 middle = corner + side;
            const int low = octant(whole.centres.low, middle), high = octant(whole.centres.high, middle);
            if (low != high) return split_at(middle, whole, parts);
            for (int k = 0; k < 3; ++k) corner[k] = (low >> k & 1) != 0 ? middle[k] : corner[k];
        }
        return split_evenly(builder_, whole, parts);
    }

private:
    static int octant(Float4 centre, Float4 middle) {
        return (centre[0] >= middle[0] ? 1 : 0) | (centre[1] >= middle[1] ? 2 : 0) | (centre[2] >= middle[2] ? 4 : 0);
    }

    // Divides a range of at most 64 elements into as few leaves as can hold them, by repeated cuts across the longest
    // axis. A part far smaller than the whole range (finest_part) becomes a node of its own, which is divided later.
    int split_into_leaves(const Range& whole, std::array<Range, tree_width>& parts) {
        int count = 1;
        for (int i = 0; i < count;) {
            Range& part = parts[static_cast<std::size_t>(i)];
            if (part.size() <= leaf_capacity || part.spread() < finest_part * whole.spread()) {
                ++i;
                continue;
            }
            const std::int32_t leaves = (part.size() + leaf_capacity - 1) / leaf_capacity;
            const std::int32_t middle = part.begin + part.size() * (leaves / 2) / leaves;
            builder_.put_in_order(part, middle);
            parts[static_cast<std::size_t>(count++)] = builder_.range(middle, part.end);
            part = builder_.range(part.begin, middle);
        }
        return count;
    }

    // Makes one part for each octant that has elements; the octants meet at the point `middle`. Small octants share a
    // part of up to eight elements, which becomes one leaf.
    int split_at(Float4 middle, const Range& whole, std::array<Range, tree_width>& parts) {
        std::array<std::int32_t, 8> sizes{};
        FloatBox* elements = builder_.elements.data();
        std::copy(elements + whole.begin, elements + whole.end, scratch_.begin());
        for (std::int32_t i = 0; i < whole.size(); ++i) {
            ++sizes[static_cast<std::size_t>(octant(centre_of(scratch_[static_cast<std::size_t>(i)]), middle))];
        }
        std::array<std::size_t, 8> part_of{};
        std::size_t count = 0;
        for (std::size_t i = 0; i < 8; ++i) {
            if (sizes[i] == 0) continue;
            while (part_of[i] < count && parts[part_of[i]].end + sizes[i] > leaf_capacity) ++part_of[i];
            if (part_of[i] == count) parts[count++] = {};
            parts[part_of[i]].end += sizes[i];
        }
        std::int32_t begin = whole.begin;
        for (std::size_t i = 0; i < count; ++i) {
            parts[i].begin = begin;
            begin += std::exchange(parts[i].end, begin);
        }
        for (std::int32_t i = 0; i < whole.size(); ++i) {
            const FloatBox& element = scratch_[static_cast<std::size_t>(i)];
            Range& part = parts[part_of[static_cast<std::size_t>(octant(centre_of(element), middle))]];
            part.box.add(element);
            part.centres.add(centre_of(element));
            elements[part.end++] = element;
        }
        return static_cast<int>(count);
    }

    Builder& builder_;
    std::vector<FloatBox> scratch_;
};

}  // namespace

WideTree build_octree(const TriangleMesh& mesh) {
    Builder builder(mesh);
    return builder.build(OctreeSplit(builder));
}

}  // namespace hausbench
