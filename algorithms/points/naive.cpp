// NAIVEHDD: measures every point of A against every point of B.
//
// Source: Zhang et al.: An efficient approach to directly compute the exact Hausdorff distance for 3D point sets, 2017,
// Algorithm 1 (whose line 3 must read cmin <- infinity). O(|A| |B|) time, O(|A|) memory. Budget: points of A.
#include "algorithms/kernel/deadline.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/point_solver.h"

namespace hausbench {
namespace {

// Finds the nearest point of B in [begin, end). A separate function, so that the loop has all registers.
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
    explicit Naive(const Options&) {}

    void prepare(const Scene& scene, const Prepared&) override { scene_ = &scene; }

    Result solve(const Query& query, State*, Trace& trace) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        const Points& b = points_of(scene_->target);
        if (out_of_range(a, b)) return {};

        const Deadline deadline(query.time_limit);
        constexpr Index block = 4096;  // points of B between two checks of the clock
        Counters counters;
        FarthestPoint farthest;
        for (Index i = 0; i < a.rows(); ++i) {
            const double* point = a.row(i).data();
            double nearest = std::numeric_limits<double>::infinity();
            Index at = -1;
            std::optional<Status> stopped;
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

SolverEntry naive_solver() {
    SolverInfo info = point_solver_info("naive", "NAIVEHDD", "zhang2017");
    info.certified = true;
    return {info, make_solver<Naive>};
}

}  // namespace hausbench
