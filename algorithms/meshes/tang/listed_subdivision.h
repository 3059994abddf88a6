// Cuts triangles of A into pieces until all upper bounds are small enough (Tang et al. 2009, section 5.1). The piece
// with the largest upper bound comes first. If a piece has a list of the triangles of B near it, the distances of its
// new vertices are computed from the list alone. Otherwise each new vertex costs a closest point query.
#pragma once

#include "algorithms/kernel/watched.h"
#include "algorithms/meshes/tang/enclosed_move.h"
#include "algorithms/meshes/tang/target_culling.h"
#include "algorithms/meshes/tang/voronoi_cut.h"
#include "algorithms/search/queue.h"

namespace hausbench::tang {

// The queue of pieces, and the loop that cuts them. `Tree` is the type of the BVH of B.
template <class Tree> class ListedSubdivision {
public:
    // Keeps the references. If `by_moving` is not null, each piece is first moved through B (enclosed_move.h), and cut
    // only if this does not lower its bound.
    ListedSubdivision(TargetCulling<Tree>& on_b, const PieceCutter& cutter, SearchBounds& bounds, Counters& counters,
                      EnclosedMove<Tree>* by_moving = nullptr)
        : on_b_(on_b), cutter_(cutter), bounds_(bounds), counters_(counters), by_moving_(by_moving) {}

    // Returns whether a piece needs no further cut, because its upper bound is small enough or because it is too small
    // to cut (SearchBounds::settle). If so, records its upper bound.
    bool settle(const ListedPiece& piece) {
        return bounds_.settle(piece.upper, piece.source, piece.level, cutter_.most_levels());
    }

    // Queues a piece unless settle() accepts it.
    void push(const ListedPiece& piece);

    // Cuts pieces until the search ends, and returns the reason for the end.
    Status run();

    // Returns the largest upper bound among the queued pieces; 0 if the queue is empty.
    double upper() const { return queue_.upper(); }

    // Records the upper bound of each queued piece as a bound of its triangle of A. Requires that the search keeps
    // bounds for each triangle (bounds_.elements() is not null).
    void settle_elements() const {
        queue_.for_each([&](const ListedPiece& piece) {
            if (WATCHED("tang: the triangles of pieces in the queue have a bound", true))
                bounds_.elements()->settle(piece.upper, piece.source);
        });
    }

    // Returns the largest depth of a piece: the number of successive cuts that made it.
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

}  // namespace hausbench::tang
