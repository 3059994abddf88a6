// Threshold cover (ours). Shows that every triangle of A is within a threshold tau of B, where tau is slightly larger
// than the lower bound on h(A,B).
//
// 1. Lower bound l. Measure the distance to B from a vertex of each of a few groups of neighbouring triangles of A,
//    then of each quarter of a group, down to clusters of 16 triangles (meshes/cover/groups.h). l is the largest
//    distance so far, and tau = l + max(0.9 * tolerance, least_gap), where least_gap is more than rounding adds to any
//    bound. A group is *settled* (needs no further work) if the distance of its vertex, plus the distance from the
//    vertex to the farthest point of the group's box, is at most tau.
// 2. Cover the triangles of the remaining clusters, up to eight at a time. Start with the clusters that most likely
//    contain the farthest point, so that l is nearly final early. Gather the triangles of B near the eight in single
//    precision (structures/triangle_blocks.h), and compute the distances of all corners to them. If all corners of a
//    triangle are within tau of one triangle S of B, so is the whole triangle, because the set of points within tau of
//    S is convex. Otherwise several triangles of B may cover it together (meshes/cover/offset_cover.h).
// 3. At the end, when tau is nearly final, cover the remaining triangles in double precision. If a corner is not within
//    tau of any gathered triangle, measure its distance to all of B, which may raise l and tau. If l and tau differ by
//    less than the rounding errors around a piece, the upper bound of the piece exceeds tau by these errors.
//
// The search needs no queue: each triangle is covered once, most of them in step 2, without a query for a closest
// point.
//
// Upper bound: the largest bound of a settled group or piece. Lower bound and witness: as in guthe.cpp.
//
// Rounding: covers use local coordinates around a few triangles, so their errors depend on the size of these triangles,
// not on the size of the meshes (meshes/cover/offset_cover.h). Groups follow kernel/rounding.h, and so do triangles
// that are halved before they are covered.
//
// Rounds: the work is divided into parts, and threads share the parts of a round. All parts of a round start from the
// same l, and their results are merged in order, so the answer does not depend on the number of threads. Rounds grow
// from one part to 64, so that most parts start from a good l.
//
// Sequences of poses, and both directions of H (ours as well): a group is first bounded by a triangle of B that was
// near it at the previous pose, or in the search of the other direction. This often saves a query. The farthest point
// of the previous pose is measured first.
//
// Fields: as in guthe.cpp.
// Budget: cuts, including halvings. If a budget is given, a round is a single group, cluster or piece, because several
// could each spend the rest of the budget.
#include "algorithms/kernel/box.h"
#include "algorithms/kernel/parallel.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/cover/groups.h"
#include "algorithms/meshes/cover/work.h"
#include "algorithms/search/bounds.h"
#include "algorithms/search/element_bounds.h"
#include "algorithms/search/mesh_solver.h"
#include "algorithms/search/stages.h"
#include "algorithms/search/warm_start.h"
#include "algorithms/structures/triangle_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace hausbench::cover {
namespace {

constexpr std::size_t first_clusters = 32;  // the clusters most likely to have the farthest point, finished first
// The work is divided into parts of this many groups, clusters or pieces of A. Threads do up to most_parts_of_round
// parts; then their results are merged.
constexpr std::size_t groups_of_part = 16, clusters_of_part = 8, pieces_of_part = 4, most_parts_of_round = 64;

// Returns the least gap between the lower bound on h(A,B) and the threshold tau. This is more than rounding adds to an
// upper bound; Work::threshold() enlarges the gap if double precision needs more.
double least_gap_of(const MeshPair& pair) { return 64 * unit_roundoff * pair.magnitude; }

Index* partners_of(WarmStart* warm_start, const MeshPair& pair) {
    if (!warm_start) return nullptr;
    warm_start->partner.resize(static_cast<std::size_t>(pair.source.triangles.rows()), -1);
    return warm_start->partner.data();
}

class Search {
public:
    Search(const MeshPair& pair, const TriangleBlocks& blocks, const std::vector<Index>& order, const GroupBoxes& boxes,
           const Query& query, WarmStart* warm_start, Trace& trace)
        : pair_(pair),
          boxes_(boxes, pair.source.triangles, pair.points, order, query.source_pose),
          query_(query),
          warm_start_(warm_start),
          trace_(trace),
          elements_(query.wanted.fields ? std::make_optional<ElementBounds>(pair.source.triangles.rows())
                                        : std::nullopt),
          stages_(query.wanted.stages),
          bounds_(query, pair.target, {pair.magnitude, true}, counters_, trace, elements_ ? &*elements_ : nullptr),
          deadline_(query.deadline()),
          proofs_(query.wanted.certificate ? std::make_optional<Proofs>(pair.source.triangles.rows()) : std::nullopt),
          scene_{pair.source,
                 pair.points,
                 pair.target,
                 blocks,
                 order,
                 query,
                 pair.magnitude,
                 least_gap_of(pair),
                 elements_ ? &*elements_ : nullptr,
                 proofs_ ? &*proofs_ : nullptr,
                 partners_of(warm_start, pair)},
          threads_(elements_ || proofs_ ? 1 : query.threads) {
        works_.resize(static_cast<std::size_t>(threads_.most()));
    }

    Result run();

private:
    void measure_previous();
    void measure_groups();
    void cover_clusters(std::size_t begin, std::size_t end);
    void decide_all(std::size_t clusters_left);
    template <class Item, class UpperOfRest>
    void in_rounds(std::size_t count, std::size_t of_part, const Item& item, const UpperOfRest& upper_of_rest);
    void merge(Outcome outcome);
    bool asks() const { return query_.floor > 0 || query_.cutoff < std::numeric_limits<double>::infinity(); }
    template <class List> static double upper_of(const List& list, std::size_t from) {
        double most = 0;
        for (std::size_t i = from; i < list.size(); ++i) most = std::max(most, list[i].upper.value);
        return most;
    }

    const MeshPair& pair_;
    PosedGroupBoxes boxes_;
    const Query& query_;
    WarmStart* warm_start_;
    Trace& trace_;
    Counters counters_;
    std::optional<ElementBounds> elements_;
    Stages stages_;
    SearchBounds bounds_;
    Deadline deadline_;
    std::optional<Proofs> proofs_;
    Input scene_;
    Threads threads_;
    std::vector<std::unique_ptr<Work>> works_;  // one per thread; null until the thread gets its first part
    std::vector<Cluster> clusters_;
    std::vector<Piece> undecided_;
    std::optional<Status> stop_;
};

// Calls item(work, i) for each i < count, `of_part` items at a time, on several threads (see "Rounds" at the top of
// this file). upper_of_rest(i) returns the largest upper bound of the work left after items 0 to i - 1. It is called
// after each round if the query has a trace, a floor or a cutoff.
template <class Item, class UpperOfRest>
void Search::in_rounds(std::size_t count, std::size_t of_part, const Item& item, const UpperOfRest& upper_of_rest) {
    const bool one_by_one = query_.budget < std::numeric_limits<std::uint64_t>::max();
    if (one_by_one) of_part = 1;
    std::size_t parts = 1;
    for (std::size_t begin = 0; begin < count; begin += parts * of_part) {
        if (begin > 0 && !one_by_one) parts = std::min(2 * parts, most_parts_of_round);
        const std::size_t end = std::min(count, begin + parts * of_part);
        const Farthest farthest = bounds_.farthest();
        const double settled = bounds_.settled();
        const std::uint64_t left = query_.budget - std::min(query_.budget, counters_.subdivisions);
        const bool stopped = stop_.has_value();
        std::vector<Outcome> outcomes((end - begin + of_part - 1) / of_part);
        std::vector<std::optional<Status>> stops(outcomes.size());
        threads_.for_each(outcomes.size(), [&](std::size_t part, int number) {
            std::unique_ptr<Work>& made = works_[static_cast<std::size_t>(number)];
            if (!made) made = std::make_unique<Work>(scene_);
            Work& work = *made;
            work.begin(farthest, settled, left, stopped, deadline_);
            const std::size_t first = begin + part * of_part;
            for (std::size_t i = first; i < std::min(end, first + of_part); ++i) item(work, i);
            stops[part] = work.stopped();
            outcomes[part] = work.finish();
        });
        for (Outcome& outcome : outcomes) merge(std::move(outcome));
        for (const std::optional<Status>& stop : stops)
            if (!stop_) stop_ = stop;
        if (stop_) continue;
        if (trace_.on() || asks())
            stop_ = bounds_.answered(upper_of_rest(end));
        else if (trace_.due())
            bounds_.show(upper_of_rest(end));
    }
}

void Search::merge(Outcome outcome) {
    for (const CounterField& field : counter_fields) counters_.*field.member += outcome.counters.*field.member;
    if (outcome.farthest.source >= 0)
        bounds_.offer(outcome.farthest.point, outcome.farthest.source, outcome.farthest.level);
    if (WATCHED("cover: what the parts settled", true)) bounds_.keep(outcome.settled);
    std::move(outcome.groups.begin(), outcome.groups.end(), std::back_inserter(clusters_));
    std::move(outcome.undecided.begin(), outcome.undecided.end(), std::back_inserter(undecided_));
}

// Measures the distance to B of the previous pose's farthest point, which is likely to be farthest again.
void Search::measure_previous() {
    if (!warm_start_ || warm_start_->source < 0) return;
    const auto v = pair_.source.triangles.row(warm_start_->source);
    const Triangle t{pair_.points.row(v[0]), pair_.points.row(v[1]), pair_.points.row(v[2])};
    const int corner = warm_start_->corner;
    if (corner >= 0)
        bounds_.measure(corner == 0 ? t.a : corner == 1 ? t.b : t.c, warm_start_->target, warm_start_->source, 0);
    else
        bounds_.measure(warm_start_->point_in(t), warm_start_->target, warm_start_->source, level_of_closest_point);
}

// Computes upper bounds on the distance to B for groups of triangles of A, from large groups down to clusters of 16
// triangles. The few large groups come first, so that the lower bound is nearly final before the many small groups are
// measured.
void Search::measure_groups() {
    clusters_.assign(1, Cluster());
    clusters_[0].count = scene_.order.size();
    for (std::size_t level = boxes_.levels(); level-- > 0;) {
        std::vector<Cluster> groups;
        groups.swap(clusters_);
        const std::size_t size = GroupBoxes::triangles_of_group(level);
        const auto item = [&](Work& work, std::size_t i) {
            const Cluster& group = groups[i];
            for (std::size_t begin = group.begin; begin < group.begin + group.count; begin += size) {
                Cluster part = group;
                part.begin = begin;
                part.count = std::min(size, group.begin + group.count - begin);
                work.narrow(part, boxes_.box(level, begin / size));
            }
        };
        in_rounds(groups.size(), groups_of_part, item,
                  [&](std::size_t i) { return std::max(upper_of(clusters_, 0), upper_of(groups, i)); });
        if (stop_ == Status::time_limit) return;
    }
}

void Search::cover_clusters(std::size_t begin, std::size_t end) {
    in_rounds(
        end - begin, clusters_of_part, [&](Work& work, std::size_t i) { work.cover(clusters_[begin + i]); },
        [&](std::size_t i) { return std::max(upper_of(clusters_, begin + i), upper_of(undecided_, 0)); });
}

// Finishes, in double precision, the pieces of A for which single precision was not enough. Starts with the pieces that
// have the largest upper bounds, because measuring them may raise the lower bound. Clusters from `clusters_left` on
// have not been covered yet.
void Search::decide_all(std::size_t clusters_left) {
    std::vector<Piece> pieces;
    pieces.swap(undecided_);
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const Piece& x, const Piece& y) { return x.upper.value > y.upper.value; });
    in_rounds(
        pieces.size(), pieces_of_part, [&](Work& work, std::size_t i) { work.decide(pieces[i]); },
        [&](std::size_t i) { return std::max(upper_of(pieces, i), upper_of(clusters_, clusters_left)); });
}

Result Search::run() {
    measure_previous();
    measure_groups();
    if (stop_ == Status::time_limit) {
        Result result = bounds_.result_without_bounds(pair_.source.triangles, pair_.points);
        result.why_no_certificate = "the time ended before any part of A was proven; allow more time";
        return result;
    }
    stages_.end("measure groups");
    const std::size_t first = std::min(first_clusters, clusters_.size());
    order_clusters(clusters_, first);
    cover_clusters(0, first);
    decide_all(first);
    stages_.end("cover the first clusters");
    cover_clusters(first, clusters_.size());
    stages_.end("cover in single precision");
    decide_all(clusters_.size());
    stages_.end("cover in double precision");
    if (!stop_) stop_ = bounds_.answered(0);
    Result result = bounds_.result(stop_.value_or(Status::precision_floor), 0);
    if (warm_start_ && result.witness.source_element >= 0) {
        const auto v = pair_.source.triangles.row(result.witness.source_element);
        warm_start_->remember(bounds_.farthest(),
                              {pair_.points.row(v[0]), pair_.points.row(v[1]), pair_.points.row(v[2])});
    }
    if (elements_) result.fields = bounds_.fields();
    if (proofs_) {
        // Claims a little more than the upper bound, because the checker of the certificate rounds, too: by up to (14 *
        // cuts + 100) * u * diagonal for a polygon made by that many nested cuts (certificate/cover_certificate.h; u =
        // 2^-53). The 4096u are enough for 280 nested cuts.
        const auto proof = proofs_->finish(result.bounds.upper + 4096 * unit_roundoff * diagonal_of(pair_));
        if (proof)
            result.certificates = {*proof};
        else
            result.why_no_certificate =
                "the solver ended before it had covered all of A; allow more time or a larger tolerance";
    }
    result.reported = stages_.seconds();
    return result;
}

class Cover final : public MeshSolver<TriangleBlocks> {
public:
    Needs needs(const Scene&, const QuerySet&) const override {
        return {need<TriangleBlocks>(Side::target), need<TriangleOrder>(Side::source)};
    }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        MeshSolver::prepare(scene, prepared);
        order_ = &prepared.get<TriangleOrder>(Side::source);
        boxes_ = GroupBoxes(source().triangles, source().vertices, order_->order, prepared.threads());
    }
    std::size_t prepared_bytes() const override { return boxes_.bytes(); }

    std::unique_ptr<State> begin() const override { return std::make_unique<WarmStart>(); }

private:
    Result search(const MeshPair& pair, const Query& query, State* state, Trace& trace) const override {
        return Search(pair, *tree(), order_->order, boxes_, query, static_cast<WarmStart*>(state), trace).run();
    }

    const TriangleOrder* order_ = nullptr;
    GroupBoxes boxes_;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info = mesh_solver_info<TriangleBlocks>("cover", "cover (ours)", "");
    info.abilities.insert({Ability::warm, Ability::shared_pairs, Ability::threads, Ability::certificates});
    info.abilities.erase(Ability::coarser_answers);  // tau, which steers the search, depends on the tolerance
    info.may_need.push_back(need<TriangleOrder>(Side::source));
    return {info, [](const Options&) -> std::unique_ptr<Solver> { return std::make_unique<Cover>(); }};
}

}  // namespace hausbench::cover
