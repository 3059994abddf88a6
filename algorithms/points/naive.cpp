// NAIVEHDD: compares every point of A with every point of B. This is the shortest solver and an example for new ones.
//
// A small solver is one .cpp file: a comment such as this one, which names the source, the time and memory, and the
// unit of Query::budget; a class derived from Solver, in an unnamed namespace; and a function that returns its
// SolverEntry. The line hausbench_solver(naive naive.cpp) in CMakeLists.txt compiles the file and registers
// naive::solver(). algorithms/solver.h has the full contract.
//
// Source: Zhang et al.: An efficient approach to directly compute the exact Hausdorff distance for 3D point sets, 2017,
// Algorithm 1, with a correction: line 3 must read cmin <- infinity, where cmin is the smallest distance found for
// the current point of A. O(|A| |B|) time, O(|A|) memory. The unit of Query::budget is one point of A.
#include "algorithms/kernel/deadline.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/point_solver.h"

namespace hausbench::naive {
namespace {

// Compares one point of A with the rows [begin, end) of B. `nearest` is the smallest squared distance so far and `at`
// its row; updates both if one of these rows is nearer. Not inlined, so that the compiler can use all registers for the
// loop.
[[gnu::noinline]] void compare(const double* point, const Points& b, Index begin, Index end, double& nearest,
                               Index& at) {
    double least = nearest;
    Index its = at;
    for (Index j = begin; j < end; ++j) {
        const double squared = squared_distance(point, b.row(j).data());
        if (squared < least) {
            least = squared;
            its = j;
        }
    }
    nearest = least;
    at = its;
}

class Naive final : public Solver {
public:
    explicit Naive(const Options&) {}  // a solver with parameters reads them here

    // Builds nothing: keeps only the scene, which outlives every call of solve().
    void prepare(const Scene& scene, const Prepared&) override { scene_ = &scene; }

    // Examines the points of A in order. If it must stop at point i, squared_distances_at_most() bounds the points from
    // i on in O(|A|) time, so the upper bound of the result is valid.
    Result solve(const Query& query, State*, Trace& trace) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        const Points& b = points_of(scene_->target);
        if (out_of_range(a, b)) return {};  // status `stalled`, bounds [0, infinity]

        const Deadline deadline = query.deadline();
        constexpr Index block = 4096;  // points of B between two checks of the clock
        Counters counters;
        FarthestPoint farthest;
        for (Index i = 0; i < a.rows(); ++i) {
            const double* point = a.row(i).data();
            double nearest = std::numeric_limits<double>::infinity();  // squared, as all distances here
            Index at = -1;                                             // the row of B at this distance
            std::optional<Status> stopped;                             // the reason to stop, if there is one
            if (static_cast<std::uint64_t>(i) >= query.budget) stopped = Status::budget;
            for (Index begin = 0; begin < b.rows() && !stopped; begin += block) {
                if (deadline.passed()) stopped = Status::time_limit;
                const Index end = std::min<Index>(begin + block, static_cast<Index>(b.rows()));
                compare(point, b, begin, end, nearest, at);
                counters.point_distances += static_cast<std::uint64_t>(end - begin);
            }
            if (!stopped && nearest > farthest.squared) {
                farthest = {nearest, i, at};
                record(trace, farthest.squared);
            }
            if (!stopped && distance_at_least(farthest.squared, true) > query.cutoff) stopped = Status::above_cutoff;
            if (stopped) {
                const double rest = squared_distances_at_most(a, b, nullptr, i);
                return exact_result(query, a, b, farthest, counters, rest, *stopped);
            }
        }
        return exact_result(query, a, b, farthest, counters);
    }

private:
    const Scene* scene_ = nullptr;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info = point_solver_info("naive", "NAIVEHDD", "zhang2017");
    info.certified = true;  // because exact_result() widens the bounds by the rounding errors that rounding.h derives
    return {info, make_solver<Naive>};
}

}  // namespace hausbench::naive
