// Branch and bound with midpoint subdivision, after Guthe, Borodin, Klein: Fast and accurate Hausdorff distance
// calculation between meshes, WSCG 2005. The paper was not at hand, so this follows the descriptions in Tang, Lee, Kim
// 2009 and Zhang et al. 2017: an octree finds closest points, triangles are subdivided at the midpoints of their edges,
// each triangle has an upper bound, triangles that cannot contain the farthest point are purged, and a triangle is not
// subdivided if one triangle of B is nearest to all its vertices.
//
// A *piece* is a triangle of A or a part of one. The upper bound of a piece T with vertices v is
//     min over some triangles S of B of (max over v of d(v, S)).
// It holds for every S, because the distance to the convex set S is convex and so is largest at a vertex of T. It is
// exact if one S is nearest to all three vertices, even if the queries returned other triangles that are equally near
// (the case of a shared nearest triangle in Tang et al., section 4). It is not known which S Guthe tries. We try the
// triangles nearest to the vertices of the piece and of the other pieces of the same split, and the S that was best for
// the piece that was split. The bound d(v, B) + (the longest edge at v) is not used, because it is never less than the
// bound of the S nearest to v.
// The piece with the largest upper bound is split first. The lower bound is the largest distance of a vertex so far.
//
// Regions: the boxes of an octree over A give upper bounds for groups of triangles. A group whose bound is small enough
// is *settled*: it needs no further work (search/source_regions.h). If regions are off, every vertex of A is measured.
//
// Split: `midpoint`, as published, makes four pieces of the same shape, so the pieces of a thin triangle are thin, too.
// `longest_edge` (ours) halves the longest edge, which soon cuts a thin triangle into compact pieces.
//
// Certified: upper bounds are widened for rounding as in kernel/rounding.h. The lower bound that purges pieces is not
// certified, which is safe: the upper bound of the result also covers purged pieces. Only the farthest point at the end
// is certified, by support planes (kernel/point_triangle.h). For comparison only, certify = false widens and certifies
// nothing, and kernel = textbook computes distances as in textbooks; their bounds may be wrong.
//
// Warm start (ours, if the caller gives a State; search/warm_start.h): the farthest point of the previous pose is
// measured first. The query for a vertex starts at the triangle of B that was nearest then. A triangle of A is settled
// without a query if it is close enough to a triangle of B that was nearest to one of its corners then.
//
// Fields: for each triangle of A, "lower" and "upper" bounds of the largest distance of its points to B, and the
// "level" of its smallest piece: the number of splits that made it. The bounds are only as tight as the search
// needed; triangles that cannot contain the farthest point are not split further.
//
// Certificate: the pieces of the search, each with the triangle S of its bound (search/piece_proofs.h). If a whole
// group was bounded by the distance from its box to one point of S, S also serves for each triangle of the group,
// because the distances from the corners to S are not larger than that bound.
//
// Budget: subdivisions. Time: O(n log m) for the vertices and O(log m) per subdivision on well-behaved data, for n
// triangles of A and m of B. Memory: O(n + m), and 168 bytes per piece in the queue.
#include "algorithms/kernel/watched.h"
#include "algorithms/search/bounds.h"
#include "algorithms/search/element_bounds.h"
#include "algorithms/search/mesh_solver.h"
#include "algorithms/search/piece_proofs.h"
#include "algorithms/search/source_vertices.h"
#include "algorithms/search/split_until_done.h"
#include "algorithms/search/stages.h"
#include "algorithms/search/warm_start.h"
#include "algorithms/structures/octree.h"

#include <algorithm>
#include <array>
#include <optional>

namespace hausbench::guthe {
namespace {

struct GuthePiece {
    std::array<MeasuredPoint, 3> corners;
    double upper;
    Index source;            // triangle of A
    Index best;              // the triangle of B that gives the least bound
    int level;               // number of splits that made the piece
    PieceProofs::Node node;  // the node of the piece, if a certificate is wanted
};

struct GutheChoices {
    bool textbook = false, certify = true;
    Split split = Split::midpoint;
};

// The search of one query.
class GutheSearch {
public:
    GutheSearch(const MeshPair& pair, const Query& query, WarmStart* warm_start, Trace& trace,
                const GutheChoices& choices)
        : a_(pair.source),
          target_(pair.target),
          points_(pair.points),
          split_(choices.split),
          elements_(query.wanted.fields ? std::make_optional<ElementBounds>(a_.triangles.rows()) : std::nullopt),
          stages_(query.wanted.stages),
          proofs_(query.wanted.certificate && choices.certify && !choices.textbook
                      ? std::make_optional<PieceProofs>(pair, choices.split)
                      : std::nullopt),
          bounds_(query, target_, {pair.magnitude, choices.certify}, counters_, trace,
                  elements_ ? &*elements_ : nullptr),
          vertices_(a_, points_, target_, warm_start, most_levels(split_), bounds_, counters_) {
        if (pair.source_tree) vertices_.use_regions(*pair.source_tree, query.source_pose);
        if (proofs_) vertices_.use_proofs(*proofs_);
    }

    Result run() {
        Result result = search();
        if (WATCHED("guthe: the state is kept up to date", true)) vertices_.remember();
        if (elements_) {
            queue_.for_each([&](const GuthePiece& piece) {
                if (WATCHED("fields: what is left in the queue counts", true))
                    elements_->settle(piece.upper, piece.source);
            });
            result.fields = bounds_.fields();
        }
        result.reported = stages_.seconds();
        if (proofs_) proofs_->finish(result);
        return result;
    }

private:
    Result search();
    void push_triangles();
    double squared_to_farthest(const GuthePiece& piece, Index triangle);
    bool settle(const GuthePiece& piece) {
        return bounds_.settle(piece.upper, piece.source, piece.level, most_levels(split_));
    }
    void push(const GuthePiece& piece);
    void split(const GuthePiece& piece);

    const TriangleMesh& a_;
    const Target& target_;
    const Points& points_;
    Split split_;
    Counters counters_;
    std::optional<ElementBounds> elements_;  // set only if fields are wanted
    Stages stages_;
    std::optional<PieceProofs> proofs_;  // set only if a certificate is wanted
    SearchBounds bounds_;
    SourceVertices vertices_;
    PieceQueue<GuthePiece> queue_;
};

void GutheSearch::push(const GuthePiece& piece) {
    if (settle(piece)) return;
    ++counters_.queue_pushes;
    queue_.push(piece);
}

// Queues the triangles of A. For the upper bound of each, tries the triangles of B nearest to its corners and takes the
// best.
void GutheSearch::push_triangles() {
    for (Index i = 0; i < a_.triangles.rows(); ++i) {
        if (vertices_.settled(i)) continue;
        GuthePiece piece{vertices_.corners(i), 0, i, 0, 0, static_cast<PieceProofs::Node>(i)};
        double least = std::numeric_limits<double>::infinity();
        for (const MeasuredPoint& corner : piece.corners) {
            const double most = squared_to_farthest(piece, corner.triangle);
            if (most < least) {
                least = most;
                piece.best = corner.triangle;
            }
        }
        piece.upper = WATCHED_ELSE("guthe: a triangle's bound is widened", bounds_.at_most(least, 0), std::sqrt(least));
        if (proofs_) proofs_->prove(piece.node, piece.upper, piece.best);
        push(piece);
    }
}

// Returns the largest squared distance from a corner of the piece to a triangle of B. Reuses the known distance of a
// corner to which this triangle is nearest.
double GutheSearch::squared_to_farthest(const GuthePiece& piece, Index triangle) {
    const Triangle near = target_.triangle(triangle);
    double most = 0;
    for (const MeasuredPoint& corner : piece.corners) {
        if (corner.triangle == triangle) {
            most = std::max(most, corner.squared);
        } else {
            ++counters_.point_triangle_distances;
            most = std::max(most, target_.squared_distance(corner.point, near));
        }
    }
    ++counters_.bound_tests;
    return most;
}

// Returns the vertices of a cut triangle as a block of eight points; unused lanes repeat the last vertex.
PointBlock block_of(const Cut<MeasuredPoint>& cut) {
    PointBlock block;
    for (std::size_t lane = 0; lane < block_width; ++lane) {
        const Vec3& point = cut.vertices[std::min(lane, cut.vertex_count - 1)].point;
        for (int k = 0; k < 3; ++k) block.coordinate[k][lane] = point[k];
    }
    return block;
}

// Splits a piece and queues the parts. For the upper bound of each part, tries the triangles of B nearest to the old
// and new vertices and the triangle that was best for the piece, and takes the best.
void GutheSearch::split(const GuthePiece& piece) {
    ++counters_.subdivisions;
    const int level = piece.level + 1;
    if (elements_)
        elements_->subdivided(piece.source,
                              WATCHED_ELSE("fields: the level is that of the pieces", level, piece.level));
    const auto cut = cut_triangle(piece.corners, split_, [&](const Vec3& point, const MeasuredPoint& near) {
        return bounds_.measure(point, near.triangle, piece.source, level);
    });
    const PieceProofs::Node first = proofs_ ? proofs_->cut(piece.node, cut.pieces[0][0]) : 0;
    const PointBlock block = block_of(cut);
    std::array<Index, 7> near{piece.best};
    for (std::size_t v = 0; v < cut.vertex_count; ++v) near[v + 1] = cut.vertices[v].triangle;
    std::array<double, 4> least;
    std::array<Index, 4> best{};
    least.fill(std::numeric_limits<double>::infinity());
    for (std::size_t s = 0; s <= cut.vertex_count; ++s) {
        if (std::find(near.begin(), near.begin() + s, near[s]) != near.begin() + s) continue;
        BlockFeet feet;
        target_.squared_distances(block, cut.vertex_count, target_.triangle(near[s]), feet);
        const double* squared = feet.squared_distance;
        counters_.point_triangle_distances += cut.vertex_count;
        for (std::size_t c = 0; c < cut.piece_count; ++c) {
            ++counters_.bound_tests;
            const auto& corners = cut.pieces[c];
            const double most = std::max({squared[corners[0]], squared[corners[1]], squared[corners[2]]});
            if (most < least[c]) {
                least[c] = most;
                best[c] = near[s];
            }
        }
    }
    for (std::size_t c = 0; c < cut.piece_count; ++c) {
        const double bound =
            WATCHED_ELSE("guthe: a piece's bound is widened",
                         bounds_.at_most(least[c], WATCHED("guthe: a piece's bound is widened by its level", level)),
                         std::sqrt(least[c]));
        const PieceProofs::Node node = first + static_cast<PieceProofs::Node>(c);
        if (proofs_) proofs_->prove(node, bound, best[c]);
        push({cut.corners(c), std::min(piece.upper, bound), piece.source, best[c], level, node});
    }
}

Result GutheSearch::search() {
    const bool measured = vertices_.measure();
    stages_.end("measure vertices");
    if (!measured) {
        if (proofs_) proofs_->one_for_all(0);
        return bounds_.result_without_bounds(a_.triangles, points_);
    }
    push_triangles();
    stages_.end("first bounds");
    const Status status = split_until_done(
        queue_, bounds_, counters_, [&](const GuthePiece& piece) { return settle(piece); },
        [&](const GuthePiece& piece) { split(piece); });
    stages_.end("subdivide");
    return bounds_.result(status, queue_.upper());
}

class Guthe final : public MeshSolver<TriangleOctree> {
public:
    explicit Guthe(const Options& options) : Guthe(options.text("kernel") == "textbook", options) {}

    bool certified() const override { return choices_.certify && !choices_.textbook; }

    std::unique_ptr<State> begin() const override { return std::make_unique<WarmStart>(); }

private:
    Guthe(bool textbook, const Options& options)
        : MeshSolver(textbook, options.flag("regions")),
          choices_{textbook, options.flag("certify"), split_of(options)} {}

    Result search(const MeshPair& pair, const Query& query, State* state, Trace& trace) const override {
        Result result = GutheSearch(pair, query, WATCHED("guthe: the state is used", static_cast<WarmStart*>(state)),
                                    trace, choices_)
                            .run();
        if (query.wanted.certificate && !certified())
            result.why_no_certificate =
                "with kernel = textbook or certify = false its bounds account for no rounding, so there is nothing to "
                "prove";
        return result;
    }

    GutheChoices choices_;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info = mesh_solver_info<TriangleOctree>("guthe", "Guthe 2005", "guthe2005");
    info.abilities.insert({Ability::warm, Ability::certificates});
    info.parameters = {
        {.name = "kernel",
         .default_value = std::string("robust"),
         .description = "the distance of a point to a triangle; textbook: not certified, to show how it fails",
         .choices = {"robust", "textbook"}},
        {.name = "certify",
         .default_value = true,
         .description = "account for rounding; off: bounds hold in exact arithmetic only, to measure the cost"},
        split_parameter(),
        regions_parameter(true, "as described: only regions that can attain the maximum"),
    };
    info.may_need.push_back(need<TriangleOctree>(Side::source));
    return {info, make_solver<Guthe>};
}

}  // namespace hausbench::guthe
