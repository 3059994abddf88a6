#include "algorithms/kernel/pages.h"
#include "algorithms/structures/tree_builder.h"

#include <algorithm>

namespace hausbench {
namespace {

using namespace builder;

constexpr int most_bins = 16;
constexpr int most_levels_by_area = 40;            // from this depth on, ranges are divided into parts of equal size
constexpr std::int32_t three_axes_at_most = 1024;  // larger ranges are cut only along their longest axis

// A slice of an axis: the number of elements whose centres lie in it, and the box around these elements.
struct Bin {
    FloatBox box;
    std::int32_t count = 0;
};

// A cut of a range between two bins of an axis. No cut if `axis` is -1.
struct Cut {
    int axis = -1;
    int bin = 0;  // the first bin of the right side
    float cost = std::numeric_limits<float>::infinity();
};

// Returns the number of leaves that `count` elements fill. The cost of one side of a cut is its area times this
// number.
float blocks(std::int32_t count) {
    const std::int32_t filled = (count + leaf_capacity - 1) / leaf_capacity;
    return static_cast<float>(filled);
}

// Maps the centre of an element to its bin along each axis. The factor is slightly below bins / extent, so that the
// largest centre falls into the last bin. Along an axis where the centres (almost) coincide, the factor is 0.
struct Binning {
    Float4 least, factor;
    int bins;

    using Int4 [[gnu::vector_size(16)]] = std::int32_t;

    Binning(const Range& range, int count) : least(range.centres.low), bins(count) {
        for (int k = 0; k < 4; ++k) {
            const float extent = range.centres.high[k] - range.centres.low[k];
            factor[k] = k < 3 && extent > 0x1p-100F ? static_cast<float>(count) * (1 - 0x1p-20F) / extent : 0;
        }
    }
    Int4 operator()(const FloatBox& element) const {
        return __builtin_convertvector((centre_of(element) - least) * factor, Int4);
    }
};

// Divides the elements of a node among its children: cuts the part with the largest surface area in two, repeatedly,
// until there are eight parts or none can be cut.
class BvhSplit {
public:
    explicit BvhSplit(Builder& builder) : builder_(builder), scratch_(filled<FloatBox>(builder.elements.size())) {}

    int operator()(const Range& whole, int depth, std::array<Range, tree_width>& parts) {
        if (depth >= most_levels_by_area) return split_evenly(builder_, whole, parts);
        int count = 1;
        while (count < tree_width) {
            int widest = -1;
            float most_area = -1;
            for (int i = 0; i < count; ++i) {
                const Range& part = parts[static_cast<std::size_t>(i)];
                if (part.size() <= leaf_capacity) continue;
                if (part.spread() < finest_part * whole.spread()) continue;
                if (const float a = area(part.box); a > most_area) most_area = a, widest = i;
            }
            if (widest < 0) break;
            auto& part = parts[static_cast<std::size_t>(widest)];
            std::tie(part, parts[static_cast<std::size_t>(count)]) = halves(part);
            ++count;
        }
        return count;
    }

private:
    std::pair<Range, Range> halves(const Range& range) {
        const Binning binning(range, std::clamp(range.size() / 2, 4, most_bins));
        const Cut cut = best_cut(range, binning);
        if (cut.axis < 0) return halves_by_number(range);
        // Write each element to both sides, but advance only on the side where it belongs. This avoids an unpredictable
        // branch.
        FloatBox* const elements = builder_.elements.data();
        std::int32_t left = range.begin, right = 0;
        for (std::int32_t i = range.begin; i < range.end; ++i) {
            const FloatBox element = elements[i];
            const bool is_left = binning(element)[cut.axis] < cut.bin;
            elements[left] = element;
            scratch_[static_cast<std::size_t>(right)] = element;
            left += is_left ? 1 : 0;
            right += is_left ? 0 : 1;
        }
        std::copy_n(scratch_.begin(), right, elements + left);
        return {builder_.range(range.begin, left), builder_.range(left, range.end)};
    }

    // Cuts a range at its middle index, for ranges that no plane divides, for example because all centres coincide.
    std::pair<Range, Range> halves_by_number(const Range& range) const {
        const std::int32_t middle = range.begin + (range.size() + 1) / 2;
        return {builder_.range(range.begin, middle), builder_.range(middle, range.end)};
    }

    // Sorts the elements of a range into the bins of the axes from `first` to `last`.
    template <int first, int last> void fill_bins(const Range& range, const Binning& binning) {
        for (int k = first; k <= last; ++k) {
            for (int b = 0; b < binning.bins; ++b) bins_[static_cast<std::size_t>(k)][static_cast<std::size_t>(b)] = {};
        }
        for (std::int32_t i = range.begin; i < range.end; ++i) {
            const FloatBox& element = builder_.elements[static_cast<std::size_t>(i)];
            const auto at = binning(element);
            for (int k = first; k <= last; ++k) {
                Bin& bin = bins_[static_cast<std::size_t>(k)][static_cast<std::size_t>(at[k])];
                bin.box.add(element);
                ++bin.count;
            }
        }
    }

    Cut best_cut(const Range& range, const Binning& binning) {
        int first = 0, last = 2;
        if (range.size() <= three_axes_at_most) {
            fill_bins<0, 2>(range, binning);
        } else {
            const Float4 extent = range.centres.high - range.centres.low;
            for (int k = 1; k < 3; ++k) first = extent[k] > extent[first] ? k : first;
            last = first;
            if (first == 0) fill_bins<0, 0>(range, binning);
            if (first == 1) fill_bins<1, 1>(range, binning);
            if (first == 2) fill_bins<2, 2>(range, binning);
        }
        Cut best;
        for (int k = first; k <= last; ++k) {
            if (!(binning.factor[k] > 0)) continue;
            const auto& bins = bins_[static_cast<std::size_t>(k)];
            std::array<float, most_bins> right_cost{};
            FloatBox box;
            std::int32_t count = 0;
            for (int b = binning.bins - 1; b > 0; --b) {
                box.add(bins[static_cast<std::size_t>(b)].box);
                count += bins[static_cast<std::size_t>(b)].count;
                right_cost[static_cast<std::size_t>(b)] = count > 0 ? area(box) * blocks(count) : -1;
            }
            box = {};
            count = 0;
            for (int b = 1; b < binning.bins; ++b) {
                box.add(bins[static_cast<std::size_t>(b - 1)].box);
                count += bins[static_cast<std::size_t>(b - 1)].count;
                const float right = right_cost[static_cast<std::size_t>(b)];
                if (count == 0 || right < 0) continue;
                const float cost = area(box) * blocks(count) + right;
                if (cost < best.cost) best = {k, b, cost};
            }
        }
        return best;
    }

    Builder& builder_;
    std::vector<FloatBox> scratch_;
    std::array<std::array<Bin, most_bins>, 3> bins_;
};

}  // namespace

WideTree build_bvh(const TriangleMesh& mesh) {
    Builder builder(mesh);
    return builder.build(BvhSplit(builder));
}

}  // namespace hausbench
