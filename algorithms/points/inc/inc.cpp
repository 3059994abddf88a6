// INC: searches an R-tree over A and an R-tree over B at the same time, from the roots down.
//
// Source: Nutanong, Jacox, Samet: An incremental Hausdorff distance calculation algorithm, PVLDB 4(8), 2011.
//
// The main queue has entries for nodes and points x of A. An entry has an upper bound on the distance to B of every
// point in x, and its own queue: the nodes and points of B that may contain the nearest neighbour of a point in x,
// nearest first. Each step takes the entry with the largest upper bound and looks at y, the first in its queue. If x
// and y are points, their distance is h. Otherwise the one with the larger box is split: the children of x become
// entries with copies of the queue, or the children of y replace y in the queue. Nodes and points of B that are farther
// from x than its upper bound are dropped.
//
// Bounds are squared, and each is rounded like the distance that it bounds (posed_box.h), so the answer has the same
// bits as with NAIVEHDD. The trees are built once; if A moves, the box of a node of A is replaced with a box around the
// moved box. The copied queues take O(|A| |B|) memory in the worst case (`queue_bytes` reports the peak). The unit of
// Query::budget is one entry taken from the main queue.
#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/posed_box.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/inc/rtree.h"
#include "algorithms/points/point_solver.h"

#include <algorithm>

namespace hausbench::inc {
namespace {

// Identifies a node or a point of an R-tree. A node has its index in RTree::nodes(). A point has the negative number
// ~i, where i is its position in RTree::order().
using Id = std::int32_t;
bool is_point(Id id) { return id < 0; }

// A node or point of B that may contain the nearest neighbour of a point of A. `squared_lower` is a lower bound on its
// squared distance to the node or point of A that has it in its queue.
struct Near {
    double squared_lower;
    Id id;

    bool operator<(const Near& other) const {  // puts the nearest on top of a heap
        return squared_lower != other.squared_lower ? squared_lower > other.squared_lower : id > other.id;
    }
};

// An entry of the main queue: a node or point of A, and the queue of nodes and points of B that may contain its nearest
// neighbours. The entry with the largest upper bound comes first.
struct Entry {
    double squared_upper;
    Id id;
    std::vector<Near> near;  // a heap

    bool operator<(const Entry& other) const {
        return squared_upper != other.squared_upper ? squared_upper < other.squared_upper : id < other.id;
    }
};

class Search {
public:
    Search(const RTree& source, const RTree& target, const Points& a, const Points& b, const Query& query, Trace& trace)
        : source_(source),
          target_(target),
          a_(a),
          b_(b),
          query_(query),
          trace_(trace),
          a_box_(query.source_pose.is_identity() ? Box{} : box_of(a)),
          deadline_(query.deadline()) {}

    Result run() {
        const auto root = [](const RTree& tree) { return static_cast<Id>(tree.nodes().size() - 1); };
        const Box x = source_box(root(source_)), y = target_box(root(target_));
        Entry first{squared_distance_at_most(x, y), root(source_), {}};
        add(first, {squared_distance_at_least(x, y), root(target_)});
        push(std::move(first));
        const bool traced = trace_.on() || trace_.watched();
        for (std::uint64_t taken = 0;; ++taken) {
            std::pop_heap(heap_.begin(), heap_.end());
            Entry head = std::move(heap_.back());
            heap_.pop_back();
            const Near near = head.near.front();
            if (traced) record(trace_, near.squared_lower, head.squared_upper);
            if (is_point(head.id) && is_point(near.id)) {
                return finish({near.squared_lower, source_.order()[row(head.id)], target_.order()[row(near.id)]}, -1,
                              Status::converged);
            }
            Status stopped = Status::converged;
            if (taken >= query_.budget) stopped = Status::budget;
            if (taken % 64 == 0 && deadline_.passed()) stopped = Status::time_limit;
            if (query_.floor > 0 && distance_at_most(head.squared_upper, true) <= query_.floor)
                stopped = Status::below_floor;
            if (stopped != Status::converged) return finish({}, head.squared_upper, stopped);

            const Box box = source_box(head.id), near_box = target_box(near.id);
            const double size = (box.high - box.low).squaredNorm(),
                         near_size = (near_box.high - near_box.low).squaredNorm();
            if (!is_point(head.id) && (is_point(near.id) || size >= near_size)) {
                split_source(head);
            } else {
                split_target(std::move(head), box);
            }
        }
    }

private:
    // Returns the position of a point in RTree::order().
    static std::size_t row(Id point) { return static_cast<std::size_t>(~point); }

    static Box point_box(const Vec3& p) { return {p, p}; }
    Box source_box(Id id) const {
        if (is_point(id)) return point_box(a_.row(source_.order()[row(id)]));
        return posed_box(source_.nodes()[static_cast<std::size_t>(id)].box, query_.source_pose, a_box_);
    }
    Box target_box(Id id) const {
        return is_point(id) ? point_box(target_.points().row(~id)) : target_.nodes()[static_cast<std::size_t>(id)].box;
    }

    template <class F> static void for_each_child(const RTree& tree, Id id, F&& f) {
        const RTree::Node& node = tree.nodes()[static_cast<std::size_t>(id)];
        for (std::int32_t k = node.first; k < node.first + node.count; ++k) f(node.leaf ? ~k : k);
    }

    static void add(Entry& entry, const Near& near) {
        entry.near.push_back(near);
        std::push_heap(entry.near.begin(), entry.near.end());
    }

    void push(Entry entry) {
        bytes_ += held(entry);
        most_bytes_ = std::max(most_bytes_, bytes_ + heap_.capacity() * sizeof(Entry));
        ++counters_.queue_pushes;
        heap_.push_back(std::move(entry));
        std::push_heap(heap_.begin(), heap_.end());
    }
    static std::size_t held(const Entry& entry) { return entry.near.capacity() * sizeof(Near); }

    // Sets `lower` and `upper` to bounds on the squared distance between any point in the box x and any point in
    // `near`, a node or point of B. The bounds are equal if both are single points.
    void bound(const Box& x, Id near, double& lower, double& upper) {
        const Box y = target_box(near);
        ++(is_point(near) ? counters_.bound_tests : counters_.node_visits);
        lower = squared_distance_at_least(x, y);
        upper = squared_distance_at_most(x, y);
    }

    // Splits a node of A: pushes an entry for each of its children.
    void split_source(const Entry& parent) {
        ++counters_.subdivisions;
        for_each_child(source_, parent.id, [&](Id child) {
            const Box x = source_box(child);
            if (is_point(child)) ++counters_.closest_point_queries;
            Entry entry{parent.squared_upper, child, {}};
            std::vector<Near> all;
            all.reserve(parent.near.size());
            for (const Near& near : parent.near) {
                double lower = 0, upper = 0;
                bound(x, near.id, lower, upper);
                if (is_point(child) && is_point(near.id)) ++counters_.point_distances;
                entry.squared_upper = std::min(entry.squared_upper, upper);
                if (lower <= entry.squared_upper) all.push_back({lower, near.id});
            }
            keep(entry, all);
            push(std::move(entry));
        });
        bytes_ -= held(parent);
    }

    // Splits the first node of B in the queue of an entry: replaces it with its children. `x` is the box of the node or
    // point of A.
    void split_target(Entry entry, const Box& x) {
        bytes_ -= held(entry);
        const Id node = entry.near.front().id;
        std::pop_heap(entry.near.begin(), entry.near.end());
        entry.near.pop_back();
        for_each_child(target_, node, [&](Id child) {
            double lower = 0, upper = 0;
            bound(x, child, lower, upper);
            if (is_point(entry.id) && is_point(child)) ++counters_.point_distances;
            entry.squared_upper = std::min(entry.squared_upper, upper);
            if (lower <= entry.squared_upper) add(entry, {lower, child});
        });
        push(std::move(entry));
    }

    // Sets the queue of an entry to the items in `all` that are not farther than the upper bound of the entry, which
    // must be final. Allocates no spare capacity, because these queues take most of the memory.
    static void keep(Entry& entry, const std::vector<Near>& all) {
        const auto kept = [&](const Near& near) { return near.squared_lower <= entry.squared_upper; };
        entry.near.reserve(static_cast<std::size_t>(std::count_if(all.begin(), all.end(), kept)));
        std::copy_if(all.begin(), all.end(), std::back_inserter(entry.near), kept);
        std::make_heap(entry.near.begin(), entry.near.end());
    }

    Result finish(const FarthestPoint& farthest, double rest, Status stopped) {
        Result result = exact_result(query_, a_, b_, farthest, counters_, rest, stopped);
        result.reported["queue_bytes"] = static_cast<double>(most_bytes_);
        return result;
    }

    const RTree &source_, &target_;
    const Points &a_, &b_;
    const Query& query_;
    Trace& trace_;
    Box a_box_;  // the box of A, moved by its pose; left empty for the identity
    Deadline deadline_;
    Counters counters_;
    std::vector<Entry> heap_;
    std::size_t bytes_ = 0, most_bytes_ = 0;  // memory of all queues over B now; peak memory with the main queue
};

class Inc final : public Solver {
public:
    explicit Inc(const Options&) {}

    Needs needs(const Scene&, const QuerySet&) const override {
        return {need<RTree>(Side::source), need<RTree>(Side::target)};
    }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        scene_ = &scene;
        source_ = &prepared.get<RTree>(Side::source);
        target_ = &prepared.get<RTree>(Side::target);
    }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        const Points& b = points_of(scene_->target);
        if (out_of_range(a, b)) return {};
        return Search(*source_, *target_, a, b, query, trace).run();
    }

private:
    const Scene* scene_ = nullptr;
    const RTree *source_ = nullptr, *target_ = nullptr;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info = point_solver_info("inc", "INC", "nutanong2011");
    info.certified = true;
    info.may_need = {need<RTree>(Side::source), need<RTree>(Side::target)};
    return {info, make_solver<Inc>};
}

}  // namespace hausbench::inc
