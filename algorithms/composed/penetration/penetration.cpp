// The penetration depth of two solids, measured on their common volume.
//
// Source: Tang et al. 2009, section 7.3. The boundary of the common volume comes partly from A and partly from B; the
// depth is H between these two parts, computed by any solver (parameter `solver`; the paper uses `tang`). If the volume
// has several parts, the depth is the largest over them, and the witness is the deepest pair of points.
//
// The paper leaves some cases open. If a part of the volume has no boundary from B, because A lies inside B there, H to
// this empty side would be infinite. The depth is then h from the boundary of the part to the whole mesh of B; the same
// holds with A and B exchanged. Solids that only touch, or are apart, have depth 0. Meshes that are open or cross
// themselves have no inside; they are refused, with the reason, if their boxes overlap.
//
// Never certified: the points where triangles cross are rounded (composed/penetration/common_volume.h). Reports `parts`
// (the number of parts of the volume) and the number of measured triangles. With `each_part` it also reports the bounds
// and the witness of each part; otherwise it stops early at a part that cannot be the deepest. Stages: "cut",
// "measure". Budget: passed to the inner solver for each part. Time: corefinement, O(n log n) plus crossings, then the
// inner solver. Cutting ignores the time limit.
#include "algorithms/composed/penetration/common_volume.h"
#include "algorithms/kernel/posed_box.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/registry.h"
#include "algorithms/session/adapter.h"
#include "algorithms/session/session.h"
#include "algorithms/session/symmetric.h"

#include <fmt/format.h>

#include <optional>

namespace hausbench::penetration {
namespace {

class Penetration final : public Solver {
public:
    explicit Penetration(const Options& options)
        : inner_(find_solver(options.text("solver"))), each_part_(options.flag("each_part")) {}

    void prepare(const Scene& scene, const Prepared&) override {
        source_.emplace(mesh_of(scene.source));
        target_.emplace(mesh_of(scene.target));
        scene_ = &scene;
    }

    std::size_t prepared_bytes() const override { return source_->bytes() + target_->bytes(); }

    Result solve(const Query& query, State*, Trace&) const override {
        const WallClock clock;
        Result result;
        result.bounds = {0, 0};
        if (!boxes_overlap(query)) return ended(query, result);
        if (const std::string why = flaw(); !why.empty()) return refused(why);
        const CommonVolume common = common_volume(*source_, query.source_pose, *target_, query.target_pose);
        if (!common.failure.empty()) return refused(common.failure);
        const double cut = clock.elapsed();
        std::size_t measured = 0;
        for (std::size_t i = 0; i < common.parts.size(); ++i) {
            Query part_query = query;
            part_query.time_limit = clock.left(query.time_limit);
            if (!each_part_) part_query.floor = std::max(query.floor, result.bounds.lower);
            // floor == cutoff turns the query into a yes/no question, so the floor stays just below the cutoff.
            if (query.floor < query.cutoff && part_query.floor >= query.cutoff)
                part_query.floor = next_down(query.cutoff);
            const Result part = measure(common.parts[i], part_query);
            if (each_part_) describe(part, i + 1, result.reported);
            measured +=
                std::size_t(common.parts[i].of_source.triangles.rows() + common.parts[i].of_target.triangles.rows());
            keep_larger(result, part);
        }
        result.reported["parts"] = double(common.parts.size());
        result.reported["triangles measured"] = double(measured);
        if (query.wanted.stages) {
            result.reported[std::string(stage_prefix) + "cut"] = cut;
            result.reported[std::string(stage_prefix) + "measure"] = clock.elapsed() - cut;
        }
        return ended(query, result);
    }

private:
    bool boxes_overlap(const Query& query) const {
        const Box a = box_of(source_->posed(query.source_pose)), b = box_of(target_->posed(query.target_pose));
        for (int k = 0; k < 3; ++k)
            if (a.high[k] < b.low[k] || b.high[k] < a.low[k]) return false;
        return true;
    }

    std::string flaw() const {
        for (const auto& [name, solid] : {std::pair{"A", &source_}, std::pair{"B", &target_}})
            if (!(*solid)->flaw().empty())
                return fmt::format("{} bounds no volume, so nothing can lie in it: {}", name, (*solid)->flaw());
        return {};
    }

    static Result refused(const std::string& why) {
        Result result;
        result.note = why;
        return result;
    }

    // Computes the depth of one part: H between its boundary from A and its boundary from B. If one of them is empty,
    // computes h from the other to the whole mesh instead (see the top of this file).
    Result measure(const CommonPart& part, Query query) const {
        const bool in_target = part.of_target.triangles.rows() == 0, in_source = part.of_source.triangles.rows() == 0;
        const auto whole = [](const TriangleMesh& mesh, const Pose& pose) {
            return TriangleMesh{
                posed(mesh.vertices, WATCHED_ELSE("penetration: the whole of the enclosing mesh where its pose puts it",
                                                  pose, Pose{})),
                mesh.triangles};
        };
        Scene scene{in_source ? part.of_target : part.of_source,
                    in_target   ? whole(mesh_of(scene_->target), query.target_pose)
                    : in_source ? whole(mesh_of(scene_->source), query.source_pose)
                                : part.of_target};
        query.quantity = WATCHED("penetration: a part that one mesh encloses alone", in_target || in_source)
                             ? Quantity::directed
                             : Quantity::symmetric;
        query.source_pose = query.target_pose = {};
        query.wanted = {};
        QuerySet queries;
        queries.symmetric = query.quantity == Quantity::symmetric;
        queries.threads = query.threads;
        queries.finest_tolerance = query.tolerance.of == Tolerance::Of::absolute ? query.tolerance.value : 0;
        const Session session(inner_, Options(inner_.info.name, inner_.info.parameters, {}), scene, queries);
        Trace untraced;
        Result result = session.solve(query, untraced);
        if (in_source) {
            if (WATCHED("penetration: the witness of a part of B alone", true))
                std::swap(result.witness.source_point, result.witness.target_point);
            result.witness.direction = Witness::Direction::target_to_source;
        }
        result.witness.source_element = result.witness.target_element = -1;  // they refer to the cut meshes
        return result;
    }

    static void describe(const Result& part, std::size_t number, Reported& reported) {
        const auto name = [&](const char* what) { return fmt::format("{}part {}, {}", length_prefix, number, what); };
        reported[name("lower")] = part.bounds.lower;
        reported[name("upper")] = part.bounds.upper;
        for (int k = 0; k < 3; ++k) {
            const char axis = "xyz"[k];
            reported[name("A ") + axis] = part.witness.source_point[k];
            reported[name("B ") + axis] = part.witness.target_point[k];
        }
    }

    static Result ended(const Query& query, Result result) {
        if (const auto answer = query.answer(result.bounds.lower, result.bounds.upper)) {
            result.status = *answer;
            result.note.clear();
        }
        return result;
    }

    SolverEntry inner_;  // a copy, because entries may move when a plug-in makes the registry grow
    bool each_part_;
    std::optional<Solid> source_, target_;
    const Scene* scene_ = nullptr;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info;
    info.name = "penetration";
    info.title = "Tang 2009, penetration depth";
    info.paper = "tang2009";
    info.source.mesh = info.target.mesh = true;
    info.quantities = {Quantity::penetration};
    info.abilities = {Ability::moving_target, Ability::threads};
    info.parameters = {
        {.name = "solver",
         .default_value = std::string("cover"),
         .paper_value = "tang",
         .description = "solver that measures H between the two sides of each part of the common volume",
         .choices = {"cover", "tang", "guthe", "kang", "zheng", "sacht"}},
        {.name = "each_part",
         .default_value = false,
         .description = "measure every part to the full tolerance and report its bounds and witness"},
    };
    return {info, make_solver<Penetration>};
}

}  // namespace hausbench::penetration
