#include "algorithms/meshes/tang/listed_subdivision.h"

#include "algorithms/kernel/watched.h"
#include "algorithms/search/split_until_done.h"

#include <algorithm>

namespace hausbench::tang {

template <class Tree> void ListedSubdivision<Tree>::push(const ListedPiece& piece) {
    if (settle(piece)) return;
    ++counters_.queue_pushes;
    queue_.push(piece);
}

template <class Tree> Status ListedSubdivision<Tree>::run() {
    const auto settled = [&](const ListedPiece& piece) {
        const bool all = settle(piece);
        if (all) on_b_.give_back(piece);
        return all;
    };
    return split_until_done(queue_, bounds_, counters_, settled, [&](const ListedPiece& piece) { split(piece); });
}

// Tries to lower the upper bound of a piece to bounds_.sought(), at which the search could end, by moving the piece
// through B (enclosed_move.h). Returns whether this lowered the bound. The caller then queues the piece again instead
// of cutting it.
template <class Tree> bool ListedSubdivision<Tree>::moves(ListedPiece& piece) {
    if (!by_moving_) return false;
    const double sought = bounds_.sought();
    if (!(sought < piece.upper)) return false;
    const double upper = by_moving_->upper(piece.corners, piece.level, sought);
    if (!(upper < piece.upper)) return false;
    piece.upper = upper;
    return true;
}

template <class Tree> void ListedSubdivision<Tree>::split(ListedPiece piece) {
    if (piece.list.count == 0 && piece.crowd <= most_near) {
        on_b_.cull(piece);
        if (settle(piece)) return;
        on_b_.list(piece);
    }
    if (moves(piece)) {
        if (settle(piece))
            on_b_.give_back(piece);
        else
            push(piece);
        return;
    }
    ++counters_.subdivisions;
    const int depth = piece.depth + 1;
    const int level = cutter_.level_of_parts(piece.corners, piece.level, depth);
    const bool listed = piece.list.count > 0;
    deepest_ = std::max(deepest_, depth);
    if (bounds_.elements()) bounds_.elements()->subdivided(piece.source, depth);
    auto cut = cutter_.cut(piece.corners, depth, [&](const Vec3& point, const MeasuredPoint& near) {
        return listed ? MeasuredPoint{point} : bounds_.measure(point, near.triangle, piece.source, level);
    });
    on_b_.measure(piece, cut);
    for (std::size_t v = 3; v < cut.vertex_count && listed; ++v) {
        bounds_.offer(cut.vertices[v], piece.source,
                      WATCHED("tang: the lower bound is widened by the level of a cut", level));
    }
    for (std::size_t c = 0; c < cut.piece_count; ++c) {
        ListedPiece part = on_b_.part(piece, cut, c, level);
        if (settle(part)) continue;
        if (listed) on_b_.list(part);
        push(part);
    }
}

template class ListedSubdivision<SweptSphereBvh>;
template class ListedSubdivision<TriangleBvh>;

}  // namespace hausbench::tang
