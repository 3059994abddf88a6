// Subdivision of pieces of A with lists of near triangles of B (Tang et al. 2009, section 5.1). Cuts pieces until
// they are settled, the one with the largest upper bound first. The list of a piece replaces B for its parts; if a
// piece has no list, its parts are measured by closest point queries.
#pragma once

#include "algorithms/meshes/tang/enclosed_move.h"
#include "algorithms/meshes/tang/target_culling.h"
#include "algorithms/meshes/tang/voronoi_cut.h"
#include "algorithms/search/queue.h"

namespace hausbench {

// `Tree` is over B.
template <class Tree> class ListedSubdivision {
public:
    // Keeps references. `by_moving` is tried before a piece is cut; it may be null.
    ListedSubdivision(TargetCulling<Tree>& on_b, const PieceCutter& cutter, SearchBounds& bounds, Counters& counters,
                      EnclosedMove<Tree>* by_moving = nullptr)
        : on_b_(on_b), cutter_(cutter), bounds_(bounds), counters_(counters), by_moving_(by_moving) {}

    // Returns whether a piece needs no further work; its bound is then kept.
    bool settle(const ListedPiece& piece) {
        return bounds_.settle(piece.upper, piece.source, piece.level, cutter_.most_levels());
    }

    // Queues a piece unless it is settled.
    void push(const ListedPiece& piece);

    // Cuts pieces until the search is over.
    Status run();

    // Returns the largest upper bound of an unsettled piece, 0 if there is none.
    double upper() const { return queue_.upper(); }

    // Gives the bounds of unsettled pieces to their triangles.
    void settle_elements() const {
        queue_.for_each([&](const ListedPiece& piece) { bounds_.elements()->settle(piece.upper, piece.source); });
    }

    // Returns the largest depth of subdivision of any piece.
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
