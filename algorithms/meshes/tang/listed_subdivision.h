// Subdivision of pieces of A with lists of near triangles of B (Tang et al. 2009, section 5.1). A piece is settled when
// its upper bound shows that it needs no further work (SearchBounds::settle). Cuts pieces until all are settled, the
// piece with the largest upper bound first. A piece with a list is cut without closest point queries: the new vertices
// are measured against the triangles of the list alone. If a piece has no list, each new vertex costs a query.
#pragma once

#include "algorithms/meshes/tang/enclosed_move.h"
#include "algorithms/meshes/tang/target_culling.h"
#include "algorithms/meshes/tang/voronoi_cut.h"
#include "algorithms/search/queue.h"

namespace hausbench {

// The queue of pieces, and the loop that cuts them. `Tree` is the type of the BVH of B.
template <class Tree> class ListedSubdivision {
public:
    // Keeps references. If `by_moving` is not null, Lemma 4 (enclosed_move.h) is tried on each piece before it is cut.
    ListedSubdivision(TargetCulling<Tree>& on_b, const PieceCutter& cutter, SearchBounds& bounds, Counters& counters,
                      EnclosedMove<Tree>* by_moving = nullptr)
        : on_b_(on_b), cutter_(cutter), bounds_(bounds), counters_(counters), by_moving_(by_moving) {}

    // Returns whether a piece is settled. If so, records its upper bound.
    bool settle(const ListedPiece& piece) {
        return bounds_.settle(piece.upper, piece.source, piece.level, cutter_.most_levels());
    }

    // Queues a piece unless it is settled.
    void push(const ListedPiece& piece);

    // Cuts pieces until the search is over, and returns the reason.
    Status run();

    // Returns the largest upper bound of a piece in the queue, 0 if the queue is empty.
    double upper() const { return queue_.upper(); }

    // Records the upper bounds of the pieces that are still in the queue, each for its triangle of A. Requires that the
    // search keeps bounds for each triangle (SearchBounds::elements() is not null).
    void settle_elements() const {
        queue_.for_each([&](const ListedPiece& piece) { bounds_.elements()->settle(piece.upper, piece.source); });
    }

    // Returns the largest number of cuts that led to any one piece.
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
