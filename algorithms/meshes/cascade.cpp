#include "algorithms/meshes/cascade.h"

#include "algorithms/kernel/watched.h"
#include "algorithms/search/bounds.h"
#include "algorithms/search/element_bounds.h"
#include "algorithms/search/mesh_solver.h"
#include "algorithms/search/piece_bounds.h"
#include "algorithms/search/piece_proofs.h"
#include "algorithms/search/source_vertices.h"
#include "algorithms/search/split_until_done.h"
#include "algorithms/search/stages.h"
#include "algorithms/search/warm_start.h"
#include "algorithms/structures/bvh.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hausbench {
namespace {

struct CascadePiece {
    PieceCorners corners;
    double upper;
    Index source;  // triangle of A
    int level;
    PieceProofs::Node node;  // the node of the piece, if a certificate is wanted
};

// Returns the number of splits that max_factor allows: triangles of A and pieces together may be max_factor times the
// triangles of A. A split makes four pieces, or two if it halves the longest edge.
std::uint64_t subdivisions_of(const Cascade& cascade, Index triangles) {
    const double pieces = (cascade.max_factor - WATCHED("cascade: max_factor counts the triangles of A", 1)) *
                          static_cast<double>(triangles);
    const double most = std::floor(pieces / (cascade.split == Split::midpoint ? 4 : 2));
    return most < 0x1p63 ? static_cast<std::uint64_t>(most) : std::numeric_limits<std::uint64_t>::max();
}

Query with_budget(Query query, std::uint64_t budget) {
    query.budget = std::min(query.budget, budget);
    return query;
}

// The search of one query.
class CascadeSearch {
public:
    CascadeSearch(const MeshPair& pair, const Query& query, WarmStart* warm_start, Trace& trace, const Cascade& cascade)
        : a_(pair.source),
          points_(pair.points),
          cascade_(cascade),
          most_levels_(most_levels(cascade.split)),
          factor_budget_(subdivisions_of(cascade, a_.triangles.rows())),
          query_(WATCHED_ELSE("cascade: max_factor ends a search", with_budget(query, factor_budget_), query)),
          elements_(query.wanted.fields ? std::make_optional<ElementBounds>(a_.triangles.rows()) : std::nullopt),
          last_bound_(elements_ ? static_cast<std::size_t>(a_.triangles.rows()) : 0),
          stages_(query.wanted.stages),
          proofs_(query.wanted.certificate ? std::make_optional<PieceProofs>(pair, cascade.split) : std::nullopt),
          bounds_(query_, pair.target, {pair.magnitude}, counters_, trace, elements_ ? &*elements_ : nullptr),
          pieces_(pair.target, pair.magnitude, counters_),
          vertices_(a_, points_, pair.target, warm_start, most_levels_, bounds_, counters_) {
        if (pair.source_tree) vertices_.use_regions(*pair.source_tree, query.source_pose);
        if (proofs_) vertices_.use_proofs(*proofs_);
    }

    Result run() {
        Result result = search();
        vertices_.remember();
        if (elements_) {
            queue_.for_each([&](const CascadePiece& piece) { elements_->settle(piece.upper, piece.source); });
            result.fields = bounds_.fields();
            result.fields->push_back({"bound", Field::Of::elements, Field::Meaning::number, last_bound_});
        }
        if (result.status == Status::budget && counters_.subdivisions >= factor_budget_)
            result.note = "max_factor was spent";
        result.reported = stages_.seconds();
        if (proofs_) proofs_->finish(result);
        return result;
    }

private:
    Result search();
    void push_triangles();
    bool settle(const CascadePiece& piece) {
        return bounds_.settle(piece.upper, piece.source, piece.level, most_levels_);
    }
    double bound(PieceBound which, const CascadePiece& piece);
    bool bound(CascadePiece& piece);
    void push(CascadePiece piece);
    void split(const CascadePiece& piece);

    const TriangleMesh& a_;
    const Points& points_;
    const Cascade& cascade_;
    int most_levels_;
    std::uint64_t factor_budget_;
    Query query_;
    Counters counters_;
    std::optional<ElementBounds> elements_;  // set only if fields are wanted
    // For each triangle of A, the bound computed last for one of its pieces: a PieceBound, or 0 for an exact one. Empty
    // if no fields are wanted.
    std::vector<double> last_bound_;
    Stages stages_;
    std::optional<PieceProofs> proofs_;  // set only if a certificate is wanted
    SearchBounds bounds_;
    PieceBounds pieces_;
    SourceVertices vertices_;
    PieceQueue<CascadePiece> queue_;
};

double CascadeSearch::bound(PieceBound which, const CascadePiece& piece) {
    switch (which) {
        case PieceBound::u1:
            return pieces_.u1(piece.corners, piece.level);
        case PieceBound::u2:
            return pieces_.u2(piece.corners, piece.level);
        case PieceBound::u3:
            return pieces_.u3(piece.corners, piece.level);
        case PieceBound::u4:
            return pieces_.u4(piece.corners, piece.level);
        case PieceBound::nearest_triangles:
            break;
    }
    const double three = pieces_.nearest_triangles(piece.corners, piece.level);
    if (three <= bounds_.purged_at_most(piece.level)) return three;
    const PieceArgument of_three = pieces_.argument();
    const MeasuredPoint centre =
        bounds_.measure(barycentre(piece.corners), piece.corners[0].triangle, piece.source,
                        piece.level + WATCHED("cascade: a barycentre is off its piece", level_of_inner_point));
    const double fourth = pieces_.nearest_triangles(piece.corners, piece.level, centre.triangle);
    if (fourth < three) return fourth;
    if (WATCHED("proofs: the triangle of Zheng's bound", true)) pieces_.restore(of_three);
    return three;
}

// Computes upper bounds of a piece one after another, and lowers `piece.upper` to the least of them. Returns true as
// soon as a bound is so small that the piece needs no further work, and false if none is.
bool CascadeSearch::bound(CascadePiece& piece) {
    const auto lower = [&](double upper, double which) {
        piece.upper = std::min(piece.upper, upper);
        if (proofs_ && upper < proofs_->upper(piece.node))
            proofs_->prove(piece.node, upper, pieces_.argument(), piece.corners);
        if (elements_) last_bound_[static_cast<std::size_t>(piece.source)] = which;
        return settle(piece);
    };
    const double exact = pieces_.same_triangle(piece.corners, piece.level);
    if (exact < std::numeric_limits<double>::infinity()) return lower(exact, 0);
    for (const PieceBound which : cascade_.order) {
        if (lower(bound(which, piece), static_cast<double>(which))) return true;
    }
    const double tied = WATCHED_ELSE("cascade: ties are looked at", pieces_.tied_triangle(piece.corners, piece.level),
                                     std::numeric_limits<double>::infinity());
    return tied < std::numeric_limits<double>::infinity() && lower(tied, 0);
}

void CascadeSearch::push(CascadePiece piece) {
    if (bound(piece)) return;
    ++counters_.queue_pushes;
    queue_.push(piece);
}

void CascadeSearch::push_triangles() {
    for (Index i = 0; i < a_.triangles.rows(); ++i) {
        if (!vertices_.settled(i))
            push({vertices_.corners(i), std::numeric_limits<double>::infinity(), i, 0,
                  static_cast<PieceProofs::Node>(i)});
    }
}

void CascadeSearch::split(const CascadePiece& piece) {
    ++counters_.subdivisions;
    const int level = piece.level + 1;
    if (elements_) elements_->subdivided(piece.source, level);
    const auto cut = cut_triangle(piece.corners, cascade_.split, [&](const Vec3& point, const MeasuredPoint& near) {
        return bounds_.measure(point, near.triangle, piece.source, level);
    });
    const PieceProofs::Node first = proofs_ ? proofs_->cut(piece.node, cut.pieces[0][0]) : 0;
    for (std::size_t c = 0; c < cut.piece_count; ++c)
        push({cut.corners(c), piece.upper, piece.source, level, first + static_cast<PieceProofs::Node>(c)});
}

Result CascadeSearch::search() {
    const bool measured = vertices_.measure();
    stages_.end("measure vertices");
    if (!measured) {
        if (proofs_) proofs_->one_for_all(0);
        return bounds_.result_without_bounds(a_.triangles, points_);
    }
    push_triangles();
    stages_.end("first bounds");
    const Status status = split_until_done(
        queue_, bounds_, counters_, [&](const CascadePiece& piece) { return settle(piece); },
        [&](const CascadePiece& piece) { split(piece); });
    stages_.end("subdivide");
    return bounds_.result(status, queue_.upper());
}

template <class Tree> class CascadeSolver final : public MeshSolver<Tree> {
public:
    explicit CascadeSolver(Cascade cascade) : MeshSolver<Tree>(false, cascade.regions), cascade_(std::move(cascade)) {}

    std::unique_ptr<State> begin() const override { return std::make_unique<WarmStart>(); }

private:
    Result search(const MeshPair& pair, const Query& query, State* state, Trace& trace) const override {
        return CascadeSearch(pair, query, static_cast<WarmStart*>(state), trace, cascade_).run();
    }

    Cascade cascade_;
};

}  // namespace

SolverInfo cascade_info(std::string name, std::string title, std::string paper, bool regions) {
    SolverInfo info = mesh_solver_info<TriangleBvh>(std::move(name), std::move(title), std::move(paper));
    info.abilities.insert({Ability::warm, Ability::certificates});
    info.parameters = {split_parameter(), regions_parameter(regions, regions ? "on" : "off")};
    info.may_need.push_back(need<TriangleBvh>(Side::source));
    return info;
}

Cascade cascade_of(const Options& options, std::vector<PieceBound> order) {
    Cascade cascade;
    cascade.order = std::move(order);
    cascade.split = split_of(options);
    cascade.regions = options.flag("regions");
    return cascade;
}

std::unique_ptr<Solver> cascade_solver(Cascade cascade) {
    if (cascade.grid) return std::make_unique<CascadeSolver<TriangleGrid>>(std::move(cascade));
    return std::make_unique<CascadeSolver<TriangleBvh>>(std::move(cascade));
}

}  // namespace hausbench
