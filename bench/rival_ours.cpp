#include "bench/closest_rival.h"

#include "algorithms/structures/bvh.h"
#include "algorithms/structures/octree.h"
#include "algorithms/structures/triangle_blocks.h"

#include <cmath>
#include <optional>

namespace hausbench {
namespace {

// A structure of this project. If `warm`, each query first tests the closest triangle of the previous query.
template <class Tree> class Ours final : public ClosestRival {
public:
    Ours(std::string name, bool warm) : name_(std::move(name)), warm_(warm) {}

    std::string name() const override { return name_; }
    void take(const TriangleMesh& mesh) override { mesh_ = &mesh; }
    void build() override { tree_.emplace(*mesh_); }
    void forget() override { tree_.reset(); }
    std::size_t bytes() const override { return tree_->bytes(); }

    void distances(const Points& points, std::vector<double>& distances) override {
        Counters counters;
        ClosestHints hints;
        for (Index i = 0; i < points.rows(); ++i) {
            const ClosestPoint nearest = tree_->closest(points.row(i), hints, counters);
            distances[static_cast<std::size_t>(i)] = std::sqrt(nearest.squared_distance);
            if (warm_) hints.warm_triangle = nearest.triangle;
        }
    }

private:
    std::string name_;
    bool warm_;
    const TriangleMesh* mesh_ = nullptr;
    std::optional<Tree> tree_;
};

}  // namespace

std::unique_ptr<ClosestRival> bvh_rival() { return std::make_unique<Ours<TriangleBvh>>("BVH", false); }
std::unique_ptr<ClosestRival> bvh_warm_rival() { return std::make_unique<Ours<TriangleBvh>>("BVH (warm start)", true); }
std::unique_ptr<ClosestRival> octree_rival() { return std::make_unique<Ours<TriangleOctree>>("octree", false); }
std::unique_ptr<ClosestRival> blocks_rival() {
    return std::make_unique<Ours<TriangleBlocks>>("triangle blocks", false);
}

}  // namespace hausbench
