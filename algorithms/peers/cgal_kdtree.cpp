// CGAL's k-d tree over B, called as its users do: finds the nearest point of B for each point of A and returns the
// largest distance.
//
// Source: CGAL 5.5, package Spatial_searching, as in its example of points with an index: Kd_tree with the default
// splitter and 10 points per leaf, and Orthogonal_k_neighbor_search with K = 1. Searches do not stop early, and the
// points of A keep their order; the solver `kdtree` does better in both.
//
// Certified although CGAL gives no guarantee. Each search returns some point of B, and its distance is computed again
// here, so the largest distance is an upper bound on h. checked_result.h explains the lower bound. Time: O(|A| log |B|
// + |B|) on typical data. Memory: O(|A| + |B|). The unit of Query::budget is one point of A.
//
// If n points of B coincide, CGAL builds a chain of n nodes. This takes O(n^2) time, and the recursion may overflow the
// stack and crash the process. A stack of 8 MB is enough for n = 20,000 but not for 50,000.
#include "algorithms/kernel/deadline.h"
#include "algorithms/peers/checked_result.h"
#include "algorithms/points/point_solver.h"

#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

namespace hausbench::cgal_kdtree {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Entry = std::pair<Kernel::Point_3, Index>;  // a point and its row in B, which the witness needs
using Traits =
    CGAL::Search_traits_adapter<Entry, CGAL::First_of_pair_property_map<Entry>, CGAL::Search_traits_3<Kernel>>;
using Search = CGAL::Orthogonal_k_neighbor_search<Traits>;
using Tree = Search::Tree;

Kernel::Point_3 point_of(const Points& points, Index i) { return {points(i, 0), points(i, 1), points(i, 2)}; }

class CgalKdTree final : public Solver {
public:
    explicit CgalKdTree(const Options&) {}

    // Calls build() explicitly. Otherwise the first search would build the tree, and its time would count in solve().
    void prepare(const Scene& scene, const Prepared&) override {
        scene_ = &scene;
        const Points& b = points_of(scene.target);
        tree_.reserve(static_cast<std::size_t>(b.rows()));
        for (Index j = 0; j < b.rows(); ++j) tree_.insert({point_of(b, j), j});
        tree_.build();
    }

    // Returns the memory of the tree: the points, one pointer for each point, and the nodes. num_nodes() of CGAL 5.5
    // counts only the leaves; a binary tree has one inner node fewer. Unused capacity, a few percent, is not counted.
    std::size_t prepared_bytes() const override {
        const std::size_t leaves = tree_.root()->num_nodes();
        return tree_.size() * (sizeof(Entry) + sizeof(const Entry*)) + leaves * sizeof(Tree::Leaf_node) +
               (leaves - 1) * sizeof(Tree::Internal_node);
    }

    Result solve(const Query& query, State*, Trace&) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        const Points& b = points_of(scene_->target);
        if (out_of_range(a, b)) return {};

        const Deadline deadline = query.deadline();
        Counters counters;
        FarthestPoint farthest;
        for (Index i = 0; i < a.rows(); ++i) {
            Status stopped = Status::converged;
            if (static_cast<std::uint64_t>(i) >= query.budget) stopped = Status::budget;
            if (i % 256 == 0 && deadline.passed()) stopped = Status::time_limit;
            if (stopped != Status::converged) {
                const double rest = squared_distances_at_most(a, b, nullptr, i);
                return checked_result(query, a, b, farthest, counters, rest, stopped);
            }
            const Search search(tree_, point_of(a, i), 1);
            const Index nearest = search.begin()->first.second;
            const double squared = squared_distance(a.row(i).data(), b.row(nearest).data());
            if (squared > farthest.squared) farthest = {squared, i, nearest};
            ++counters.closest_point_queries;
            ++counters.point_distances;
        }
        return checked_result(query, a, b, farthest, counters);
    }

private:
    const Scene* scene_ = nullptr;
    Tree tree_;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info = point_solver_info("cgal_kdtree", "k-d tree (CGAL)", "cgal_searching");
    info.certified = true;
    info.abilities.erase(Ability::traces);  // no lower bound is proven before checked_result(), at the end
    return {info, make_solver<CgalKdTree>};
}

}  // namespace hausbench::cgal_kdtree
