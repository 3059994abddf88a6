#include "algorithms/surfaces/interval_subdivision/voxels.h"

#include "algorithms/error.h"

namespace hausbench::interval_subdivision {
namespace {

std::string problem(const AlgebraicSurface& surface, const char* what) {
    return "surface '" + surface.polynomial + "': " + what;
}

Voxels::Grid grid_of(const AlgebraicSurface& surface, int voxels) {
    Voxels::Grid grid;
    for (int k = 0; k < 3; ++k) {
        auto& lines = grid[std::size_t(k)];
        const double low = surface.box(0, k), high = surface.box(1, k);
        for (int i = 0; i <= voxels; ++i) lines.push_back(i == voxels ? high : low + (high - low) * i / voxels);
        for (int i = 0; i < voxels; ++i) {
            if (!(lines[std::size_t(i)] < lines[std::size_t(i) + 1]))
                throw InputError(problem(surface, "its box is too small for so many voxels: give a smaller depth"));
        }
    }
    return grid;
}

class Subdivision {
public:
    Subdivision(const AlgebraicSurface& surface, Voxels& voxels, Form form)
        : form_(form), evaluator_(Polynomial(surface.polynomial)), voxels_(voxels) {}

    // Builds the octree and the list of voxels. Both stay empty if interval arithmetic proves that the surface has no
    // point in its box.
    void run(int voxels) {
        const UpwardRounding upward;
        if (!keep({0, 0, 0}, voxels)) return;
        voxels_.nodes.push_back({{0, 0, 0}, voxels});
        split(0);
    }

private:
    // Returns whether the polynomial may be 0 in this cell, according to interval arithmetic.
    bool keep(const std::array<int, 3>& at, int size) {
        ++voxels_.evaluations;
        const Interval value = evaluator_.range(form_, voxels_.box_of(at, size));
        return value.inf() <= 0 && value.sup() >= 0;
    }

    // Splits a cell down to voxels. Drops children in which the polynomial cannot be 0, and stores the others next to
    // each other in `nodes`. A cell without children stays in the octree, with count = 0.
    void split(std::uint32_t of) {
        const Voxels::Node node = voxels_.nodes[of];
        if (node.size == 1) {
            voxels_.leaves.push_back(of);
            return;
        }
        const int half = node.size / 2;
        const auto first = static_cast<std::uint32_t>(voxels_.nodes.size());
        for (int c = 0; c < 8; ++c) {
            const std::array<int, 3> at{node.at[0] + (c & 1) * half, node.at[1] + (c >> 1 & 1) * half,
                                        node.at[2] + (c >> 2) * half};
            if (keep(at, half)) voxels_.nodes.push_back({at, half});
        }
        const auto count = static_cast<std::uint32_t>(voxels_.nodes.size()) - first;
        voxels_.nodes[of].first = first;
        voxels_.nodes[of].count = count;
        for (std::uint32_t i = 0; i < count; ++i) split(first + i);
    }

    Form form_;
    FormEvaluator evaluator_;
    Voxels& voxels_;
};

}  // namespace

Voxels voxels_of(const AlgebraicSurface& surface, int depth, Form form) {
    const int n = 1 << depth;
    Voxels voxels;
    voxels.grid = grid_of(surface, n);
    Subdivision(surface, voxels, form).run(n);
    if (voxels.leaves.empty())
        throw InputError(problem(surface, "has no point in its box: give another box or polynomial"));
    for (const std::uint32_t leaf : voxels.leaves) {
        const Box box = voxels.box_of(voxels.nodes[leaf]);
        for (std::size_t k = 0; k < 3; ++k) {
            voxels.low[k].push_back(box.low[Eigen::Index(k)]);
            voxels.high[k].push_back(box.high[Eigen::Index(k)]);
        }
    }
    return voxels;
}

}  // namespace hausbench::interval_subdivision
