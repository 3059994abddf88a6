// The framework of Zhang et al.: for each query, chooses NOHD, EARLYBREAK or OHD, depending on how much the bounding
// boxes of A and B overlap.
//
// Source: Zhang et al. 2017, Algorithm 8. The choice is NOHD if the boxes are disjoint, EARLYBREAK if their overlap
// alpha is at most theta, and OHD otherwise. The paper says only that alpha is 0 if the boxes touch and 1 at full
// overlap. Here it is
//     alpha = volume(boxA intersected with boxB) / min(volume(boxA), volume(boxB)).
// An axis along which a box is flat is left out of all three volumes. If one box contains the other, alpha is 1 however
// large h is; therefore the volume of the intersection divided by the volume of the union (`iou`) is reported too.
//
// Reports `chosen` (the name of the solver), `alpha` (-1 if the boxes are disjoint) and `iou`. Time, memory and the
// unit of Query::budget are as for the chosen solver, plus O(|A|) time for the box of A. If A does not move, only the
// structures of the chosen solver are built.
#include "algorithms/kernel/posed_box.h"
#include "algorithms/points/exact.h"
#include "algorithms/points/point_solver.h"
#include "algorithms/points/zhang2017/point_octree.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace hausbench::earlybreak {
SolverEntry solver();
}
namespace hausbench::nohd {
SolverEntry solver();
}
namespace hausbench::ohd {
SolverEntry solver();
}

namespace hausbench::zhang2017 {

namespace {

enum Choice : std::size_t { nohd = 0, earlybreak = 1, ohd = 2 };
constexpr const char* names[] = {"nohd", "earlybreak", "ohd"};
// Parameters that this solver passes on to the solvers among which it chooses.
constexpr std::array<std::string_view, 3> handed_on = {"depth", "lambda", "seed"};

struct Overlap {
    bool meet = true;  // they have a point in common
    double alpha = -1, iou = 0;
};

// Multiplies ratios of lengths along the axes instead of dividing volumes, because volumes could overflow or underflow.
Overlap overlap_of(const Box& a, const Box& b) {
    double of_a = 1, of_b = 1;  // the intersection as a fraction of each box
    for (int k = 0; k < 3; ++k) {
        const double common = std::min(a.high[k], b.high[k]) - std::max(a.low[k], b.low[k]);
        if (common < 0) return {.meet = false};
        const double length_a = a.high[k] - a.low[k], length_b = b.high[k] - b.low[k];
        if (length_a == 0 || length_b == 0) continue;
        of_a *= common / length_a;
        of_b *= common / length_b;
    }
    const double iou = of_a > 0 && of_b > 0 ? 1 / (1 / of_a + 1 / of_b - 1) : 0;
    return {true, std::max(of_a, of_b), iou};
}

class Adaptive final : public Solver {
public:
    explicit Adaptive(const Options& options) : theta_(options.real("theta")) {
        const auto make = [](const SolverEntry& entry, const ParameterMap& given) {
            return entry.make(Options(entry.info.name, entry.info.parameters, given));
        };
        solvers_[nohd] = make(nohd::solver(), {{"depth", options.integer("depth")}});
        solvers_[earlybreak] = make(earlybreak::solver(), {{"seed", options.integer("seed")}});
        solvers_[ohd] = make(ohd::solver(), {{"lambda", options.real("lambda")}, {"seed", options.integer("seed")}});
    }

    Needs needs(const Scene& scene, const QuerySet& queries) const override {
        const Overlap overlap = overlap_of(box_of(points_of(scene.source)), box_of(points_of(scene.target)));
        Needs needs;
        for (std::size_t i = 0; i < solvers_.size(); ++i) {
            if (!queries.moves && i != choose(overlap)) continue;
            for (const Need& need : solvers_[i]->needs(scene, queries)) needs.push_back(need);
        }
        return needs;
    }

    // Prepares the solvers that queries may choose. If A moves, both octrees exist, and queries may choose any solver.
    // Otherwise needs() has chosen one: NOHD if only the octree of A exists, OHD if only the octree of B exists,
    // EARLYBREAK if neither exists.
    void prepare(const Scene& scene, const Prepared& prepared) override {
        scene_ = &scene;
        target_box_ = box_of(points_of(scene.target));
        const bool source = prepared.has<PointOctree>(Side::source);
        const bool target = prepared.has<PointOctree>(Side::target);
        ready_ = {source, source == target, target};
        for (std::size_t i = 0; i < solvers_.size(); ++i) {
            if (ready_[i]) solvers_[i]->prepare(scene, prepared);
        }
    }

    std::size_t prepared_bytes() const override {
        std::size_t sum = 0;
        for (std::size_t i = 0; i < solvers_.size(); ++i) sum += ready_[i] ? solvers_[i]->prepared_bytes() : 0;
        return sum;
    }

    Result solve(const Query& query, State* state, Trace& trace) const override {
        const Points a = posed(points_of(scene_->source), query.source_pose);
        if (out_of_range(a, points_of(scene_->target))) return {};
        const Overlap overlap = overlap_of(box_of(a), target_box_);
        std::size_t chosen = choose(overlap);
        // Takes another solver if the chosen one is not prepared. This happens only if the query moves A although
        // QuerySet::moves was false. Any solver will do, because all are exact.
        while (!ready_[chosen]) chosen = (chosen + 1) % solvers_.size();
        Result result = solvers_[chosen]->solve(query, state, trace);
        result.reported["chosen"] = names[chosen];
        result.reported["alpha"] = overlap.alpha;
        result.reported["iou"] = overlap.iou;
        return result;
    }

private:
    std::size_t choose(const Overlap& overlap) const {
        if (!overlap.meet) return nohd;
        return overlap.alpha <= theta_ ? earlybreak : ohd;
    }

    double theta_;
    std::array<std::unique_ptr<Solver>, 3> solvers_;
    std::array<bool, 3> ready_{};  // whether prepare() of the solver was called
    const Scene* scene_ = nullptr;
    Box target_box_;
};

}  // namespace

}  // namespace hausbench::zhang2017

namespace hausbench::adaptive {

using namespace zhang2017;

SolverEntry solver() {
    SolverInfo info = point_solver_info("adaptive", "NOHD/OHD framework", "zhang2017");
    info.certified = true;
    info.may_need = {need<PointOctree>(Side::source), need<PointOctree>(Side::target)};
    info.parameters = {{.name = "theta",
                        .default_value = 0.33,
                        .unit = "fraction of the smaller box",
                        .paper_value = "0.33",
                        .description = "largest overlap of the boxes for which EARLYBREAK is chosen",
                        .least = 0,
                        .most = 1}};
    for (const SolverEntry& entry : {nohd::solver(), ohd::solver()}) {
        for (const ParameterSpec& spec : entry.info.parameters) {
            if (std::find(handed_on.begin(), handed_on.end(), spec.name) != handed_on.end())
                info.parameters.push_back(spec);
        }
    }
    return {info, make_solver<Adaptive>};
}

}  // namespace hausbench::adaptive
