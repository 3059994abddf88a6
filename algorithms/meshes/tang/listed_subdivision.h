// Subdivision of pieces of A by lists of near triangles of B (Tang et al. 2009, section 5.1): a piece is cut until it is settled, the
// one of largest upper bound first. The list of a piece takes the place of B for its parts; without one they are measured by closest
// point queries.
#pragma once

#include "algorithms/meshes/tang/enclosed_move.h"
#include "algorithms/meshes/tang/target_culling.h"
#include "algorithms/meshes/tang/voronoi_cut.h"
#include "algorithms/search/queue.h"

namespace hausbench {

// `Tree` is over B.
template <class Tree> class ListedSubdivision {
public:
    // References are kept. `by_moving`: tried before a piece is cut, or null.
    ListedSubdivision(TargetCulling<Tree>& on_b, const PieceCutter& cutter, SearchBounds& bounds, Counters& counters,
                      EnclosedMove<Tree>* by_moving = nullptr)
        : on_b_(on_b), cutter_(cutter), bounds_(bounds), counters_(counters), by_moving_(by_moving) {}

    // Whether it needs no further work; its bound is then kept.
    bool settle(const ListedPiece& piece) {
        return bounds_.settle(piece.upper, piece.source, piece.level, cutter_.most_levels());
    }

    // Unless it is settled.
    void push(const ListedPiece& piece);

    // Cuts pieces until the search is over.
    Status run();

    // The largest upper bound of what is not settled, 0 if all is.
    double upper() const { return queue_.upper(); }

    // Gives their triangles the bounds of the pieces that are not settled.
    void settle_elements() const {
        queue_.for_each([&](const ListedPiece& piece) { bounds_.elements()->settle(piece.upper, piece.source); });
    }

    // The most subdivisions that a piece has gone through.
    int deepest() const { return deepest_; }

private:
    bool moves(ListedPiece& piece);
    void split(ListedPiece piece);

    TargetCulling<Tree>& on_b_;
    PieceCutter cutter_;
    SearchBounds& bounds_;
    Counters& counters_;
    EnclosedMove<Tree>* by_moving_;
    PieceQueue<ListedPiece> queue_;
    int deepest_ = 0;
};

}  // namespace hausbench
