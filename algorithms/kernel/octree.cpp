#include "tree_builder.h"

#include <algorithm>

namespace hausbench {
namespace {

using namespace builder;

constexpr int most_levels = 48;  // of cells

// A cell is known by its lower corner; its side is 2 (of the root, in twice the local frame: 4) halved `level` times.
class OctreeSplit {
public:
    explicit OctreeSplit(Builder& builder) : builder_(builder), scratch_(builder.elements.size()) {}

    int operator()(const Range& whole, int, std::array<Range, tree_width>& parts) {
        // The smallest cell of the octree that holds all centres is found anew: cells with one child are passed over.
        Float4 corner = Float4{} - 2;
        float side = 4;
        for (int level = 0; level < most_levels; ++level) {
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

    int split_at(Float4 middle, const Range& whole, std::array<Range, tree_width>& parts) {
        std::array<Range, 8> octants;
        FloatBox* elements = builder_.elements.data();
        std::copy(elements + whole.begin, elements + whole.end, scratch_.begin());
        for (std::int32_t i = 0; i < whole.size(); ++i) {
            ++octants[static_cast<std::size_t>(octant(centre_of(scratch_[static_cast<std::size_t>(i)]), middle))].end;
        }
        int count = 0;
        std::int32_t begin = whole.begin;
        for (Range& part : octants) {
            part.begin = begin;
            begin += std::exchange(part.end, begin);
        }
        for (std::int32_t i = 0; i < whole.size(); ++i) {
            const FloatBox& element = scratch_[static_cast<std::size_t>(i)];
            Range& part = octants[static_cast<std::size_t>(octant(centre_of(element), middle))];
            part.box.add(element);
            part.centres.add(centre_of(element));
            elements[part.end++] = element;
        }
        for (const Range& part : octants) {
            if (part.size() > 0) parts[static_cast<std::size_t>(count++)] = part;
        }
        return count;
    }

    Builder& builder_;
    std::vector<FloatBox> scratch_;
};

}  // namespace

WideTree build_octree(LocalBoxes&& boxes) {
    Builder builder(std::move(boxes));
    return builder.build(OctreeSplit(builder));
}

}  // namespace hausbench
