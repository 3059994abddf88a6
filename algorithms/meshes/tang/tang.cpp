// Cross-culling and Voronoi subdivision: Tang, Lee, Kim: Interactive Hausdorff distance computation for general
// polygonal models, ACM Transactions on Graphics 28(3), 2009.
//
// The search has three steps:
// 1. Culling on A (source_culling.h) skips the nodes of a BVH of A that cannot contain the farthest point.
// 2. Culling on B (target_culling.h) sends each remaining triangle T of A through a BVH of B. This gives an upper bound
//    on h(T, B), and the list of the triangles of B that may be the nearest ones to some point of T.
// 3. Subdivision (listed_subdivision.h, voronoi_cut.h) cuts T into pieces, the piece with the largest upper bound
//    first. The list of T replaces B for its pieces. A piece is settled, and not cut again, when its upper bound shows
//    that it cannot change the answer.
//
// From the paper: these steps, swept sphere volumes, group traversal (the three corners go through B together), Voronoi
// subdivision, and the rule that a piece is not cut if its corners share a nearest triangle S. The rule needs no code:
// the upper bound h(T, S) is then the largest distance of a corner, which the lower bound has reached, so the piece is
// settled. If a corner has several nearest triangles, the rule still works, because the list contains all of them.
//
// Not in the paper: the changes named in the headers of these files, and leaves of up to eight triangles instead of
// four, which suit the vector kernels and are shared with all solvers. Lemma 4, the paper's option for closed B, is the
// parameter `lemma4`: corrected and certified (enclosed_move.h), and off by default. Penetration depth (section 7.3) is
// a separate solver.
//
// Certified: upper bounds are widened as kernel/rounding.h derives, and volumes as volumes.cpp derives. The lower bound
// is computed as search/bounds.h says. If A moves, the volumes of its BVH move with it.
//
// Hints (search/warm_start.h): for H(A,B) (section 6), the first direction notes for each triangle of A that is culled on B the triangle of
// B that gave the least bound, and the second direction tries these pairs first. In a chain of nearby poses (not in the
// paper, only if the caller passes a State), the previous pose provides such pairs, a triangle of B near each node of
// A, and the farthest point.
//
// Fields: as in guthe.cpp. A triangle of A that was culled with a node has the upper bound of the node. Reports:
// "culled on A" is the share of A's triangles that needed no culling on B. "culled on B" is the share of B's triangles
// whose distances to the other triangles of A were not computed, on average. "depth" is the largest number of cuts that
// led to one piece.
//
// Budget: subdivisions. Time: O(n log n + m log m) to prepare, with n triangles of A and m of B. Memory: O(n + m), and
// for each piece in the queue 184 bytes plus 4 bytes for each triangle in its list.
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/tang/enclosed_move.h"
#include "algorithms/meshes/tang/listed_subdivision.h"
#include "algorithms/meshes/tang/source_culling.h"
#include "algorithms/meshes/tang/target_culling.h"
#include "algorithms/search/bounds.h"
#include "algorithms/search/element_bounds.h"
#include "algorithms/search/mesh_solver.h"
#include "algorithms/search/stages.h"
#include "algorithms/search/warm_start.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace hausbench::tang {
namespace {

// The values of the solver's parameters; see tang::solver().
struct Choices {
    Cutting cutting = Cutting::voronoi;
    bool group = true;
    double least_part = 0.05;
    bool lemma4 = false;
};

// The search of one query.
template <class Tree> class Search {
public:
    Search(const MeshPair& pair, const Tree& a_tree, const Tree& b_tree, const Query& query, WarmStart* warm_start,
           Trace& trace, const Choices& choices, bool closed)
        : a_(pair.source),
          points_(pair.points),
          target_(pair.target),
          warm_start_(warm_start),
          by_groups_(choices.group),
          elements_(query.wanted.fields ? std::make_optional<ElementBounds>(a_.triangles.rows()) : std::nullopt),
          stages_(query.wanted.stages),
          bounds_(query, target_, {pair.magnitude}, counters_, trace, elements_ ? &*elements_ : nullptr),
          on_a_(a_tree, query.source_pose, target_, pair.magnitude, bounds_, counters_,
                warm_start ? &warm_start->near_node : nullptr),
          on_b_(b_tree, target_, pair.magnitude, bounds_, counters_),
          move_(b_tree, target_, pair.magnitude, counters_),
          pieces_(on_b_, {target_, pair.magnitude, choices.cutting, choices.least_part}, bounds_, counters_,
                  closed ? &move_ : nullptr),
          vertices_(static_cast<std::size_t>(points_.rows())) {}

    Result run() {
        Result result = search();
        if (warm_start_ && bounds_.farthest().source >= 0)
            warm_start_->remember(bounds_.farthest(), posed_triangle(bounds_.farthest().source));
        if (elements_) {
            on_a_.settle_elements();
            pieces_.settle_elements();
            result.fields = bounds_.fields();
        }
        report(result);
        return result;
    }

private:
    Result search();
    void report(Result& result) const;
    void begin_warm();
    std::optional<Status> cull_on_a();
    void bound_or_queue(Index i);
    ListedPiece whole(Index i) const;
    // Returns the triangle of B to try first for triangle i of A, or -1 if none is known.
    Index partner(Index i) const { return warm_start_ ? warm_start_->partner[static_cast<std::size_t>(i)] : -1; }
    Triangle posed_triangle(Index i) const {
        const auto v = a_.triangles.row(i);
        return {points_.row(v[0]), points_.row(v[1]), points_.row(v[2])};
    }

    const TriangleMesh& a_;
    const Points& points_;
    const Target& target_;
    WarmStart* warm_start_;
    bool by_groups_;
    Counters counters_;
    std::optional<ElementBounds> elements_;  // set only if fields are wanted
    Stages stages_;
    SearchBounds bounds_;
    SourceCulling<Tree> on_a_;
    TargetCulling<Tree> on_b_;
    EnclosedMove<Tree> move_;
    ListedSubdivision<Tree> pieces_;
    std::vector<MeasuredPoint> vertices_;  // the vertices of A; `point` is set once the distance to B is known
    Index last_ = -1;  // the triangle of B with the least bound for the previous triangle of A; -1: none yet
    std::uint64_t culled_on_b_ = 0;  // number of triangles of A that were left for culling on B
};

template <class Tree> void Search<Tree>::report(Result& result) const {
    result.reported = stages_.seconds();
    const auto n = static_cast<double>(a_.triangles.rows()), m = static_cast<double>(target_.mesh().triangles.rows()),
               left = static_cast<double>(culled_on_b_);
    result.reported["culled on A"] = 1 - left / n;
    if (culled_on_b_ > 0) result.reported["culled on B"] = 1 - static_cast<double>(on_b_.measured()) / (m * left);
    result.reported["depth"] = static_cast<double>(pieces_.deepest());
}

// Computes an upper bound for every triangle of A, and queues the triangles that are not culled on A or on B. Returns a
// status if the search ends before all triangles have a bound.
template <class Tree> std::optional<Status> Search<Tree>::cull_on_a() {
    on_a_.begin(points_);
    while (!on_a_.done()) {
        if (bounds_.out_of_time()) return Status::time_limit;
        if (bounds_.answered(std::max(on_a_.upper(), pieces_.upper())) == Status::above_cutoff)
            return Status::above_cutoff;
        const std::span<const Index> left = on_a_.step();
        if (left.empty()) continue;
        stages_.end("cull on A");
        for (const Index i : left) bound_or_queue(i);
        stages_.end("cull on B");
    }
    return std::nullopt;
}

// Returns triangle i of A as an uncut piece, with the corner distances that were computed for earlier triangles.
template <class Tree> ListedPiece Search<Tree>::whole(Index i) const {
    ListedPiece piece;
    piece.source = i;
    for (std::size_t k = 0; k < 3; ++k) {
        const Index v = a_.triangles(i, static_cast<int>(k));
        piece.corners[k] = vertices_[static_cast<std::size_t>(v)];
        piece.corners[k].point = points_.row(v);
    }
    return piece;
}

// Bounds triangle i of A, and queues it unless it is settled. Tries the triangles of B that are probably near first: if
// one of them settles i, culling on B is not needed.
template <class Tree> void Search<Tree>::bound_or_queue(Index i) {
    ListedPiece piece = whole(i);
    if (const Index near = partner(i); near >= 0) on_b_.bound_by(piece, near);
    if (last_ >= 0) on_b_.bound_by(piece, last_);
    for (const MeasuredPoint& corner : piece.corners) {
        if (corner.triangle < 0) continue;           // no earlier triangle measured this corner
        if (elements_) bounds_.offer(corner, i, 0);  // it was offered for that triangle only
        if (corner.triangle != piece.best) on_b_.bound_by(piece, corner.triangle);
    }
    if (piece.best >= 0 && pieces_.settle(piece)) return;
    ++culled_on_b_;
    if (by_groups_)
        on_b_.cull(piece);
    else
        on_b_.measure_corners(piece, last_);
    for (int k = 0; k < 3; ++k)
        vertices_[static_cast<std::size_t>(a_.triangles(i, k))] = piece.corners[static_cast<std::size_t>(k)];
    last_ = piece.best;
    if (warm_start_) warm_start_->partner[static_cast<std::size_t>(i)] = piece.best;
    if (pieces_.settle(piece)) return;
    if (by_groups_) on_b_.list(piece);
    pieces_.push(piece);
}

// Starts with the farthest point of the previous pose. It is probably far from B again, so the lower bound starts high.
template <class Tree> void Search<Tree>::begin_warm() {
    warm_start_->partner.resize(static_cast<std::size_t>(a_.triangles.rows()), -1);
    const WarmStart& last = *warm_start_;
    if (last.source < 0) return;
    const Triangle triangle = posed_triangle(last.source);
    if (last.corner < 0) {
        bounds_.measure(last.point_in(triangle), last.target, last.source,
                        WATCHED("tang: a warm point is widened", level_of_closest_point));
    } else {
        const Index v = a_.triangles(last.source, last.corner);
        vertices_[static_cast<std::size_t>(v)] = bounds_.measure(points_.row(v), last.target, last.source, 0);
    }
}

template <class Tree> Result Search<Tree>::search() {
    if (warm_start_) begin_warm();
    const std::optional<Status> stopped = cull_on_a();
    stages_.end("cull on A");
    if (stopped)
        return bounds_.result(
            *stopped, std::max(WATCHED("tang: what is left of A's tree counts", on_a_.upper()), pieces_.upper()));
    const Status status = pieces_.run();
    stages_.end("subdivide");
    return bounds_.result(status, pieces_.upper());
}

template <class Tree> class Tang final : public MeshSolver<Tree> {
public:
    explicit Tang(const Choices& choices) : choices_(choices) {}

    // Requires both trees even for small shapes, unlike other mesh solvers, because culling works on tree nodes.
    Needs needs(const Scene&, const QuerySet&) const override {
        return {need<Tree>(Side::source), need<Tree>(Side::target)};
    }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        MeshSolver<Tree>::prepare(scene, prepared);
        a_tree_ = &prepared.get<Tree>(Side::source);
        closed_ = choices_.lemma4 &&
                  WATCHED_ELSE("lemma 4: B must be closed", is_closed(prepared.triangles(Side::target)), true);
    }

    std::unique_ptr<State> begin() const override { return std::make_unique<WarmStart>(); }

private:
    Result search(const MeshPair& pair, const Query& query, State* state, Trace& trace) const override {
        return Search<Tree>(pair, *a_tree_, *this->tree(), query, static_cast<WarmStart*>(state), trace, choices_,
                            closed_)
            .run();
    }

    Choices choices_;
    const Tree* a_tree_ = nullptr;
    bool closed_ = false;  // whether B is closed, if lemma4 is on
};

std::unique_ptr<Solver> make(const Options& options) {
    const Choices choices{cutting_of(options), options.flag("group"), options.real("least_part"),
                          options.flag("lemma4")};
    if (options.text("volumes") == "boxes") return std::make_unique<Tang<TriangleBvh>>(choices);
    return std::make_unique<Tang<SweptSphereBvh>>(choices);
}

}  // namespace

SolverEntry solver() {
    SolverInfo info = mesh_solver_info<SweptSphereBvh>("tang", "Tang 2009", "tang2009");
    info.abilities.insert({Ability::warm, Ability::shared_pairs});
    info.may_need = {need<SweptSphereBvh>(Side::source), need<SweptSphereBvh>(Side::target),
                     need<TriangleBvh>(Side::source), need<TriangleBvh>(Side::target)};
    info.parameters = {
        {.name = "volumes",
         .default_value = std::string("swept_spheres"),
         .paper_value = "swept_spheres",
         .description = "bounding volumes of both BVHs",
         .choices = {"swept_spheres", "boxes"}},
        {.name = "group",
         .default_value = true,
         .paper_value = "true",
         .description = "the three corners of a triangle of A go through the BVH of B together; off: each by itself"},
        {.name = "lemma4",
         .default_value = false,
         .paper_value = "true, for closed models",
         .description = "if B is closed: bound a piece by moving it through B (lemma 4)"},
    };
    for (ParameterSpec& parameter : cutting_parameters()) info.parameters.push_back(std::move(parameter));
    return {info, make};
}

}  // namespace hausbench::tang
