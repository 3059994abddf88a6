// The main loop of searches that split one piece of A at a time.
#pragma once

#include "algorithms/search/bounds.h"
#include "algorithms/search/queue.h"

namespace hausbench {

// Takes the piece with the largest upper bound from the queue, again and again, until the bounds are close enough or
// the time or the budget is spent; returns the reason. settle(piece) must return whether the piece needs no further
// work; the lower bound may have grown since the piece was queued. If it returns false, split(piece) must cut the piece
// and queue its parts.
template <class Piece, class Settle, class Split>
Status split_until_done(PieceQueue<Piece>& queue, SearchBounds& bounds, const Counters& counters, const Settle& settle,
                        const Split& split) {
    while (true) {
        if (const auto status = bounds.end(queue.upper(), counters.subdivisions)) return *status;
        const Piece piece = queue.pop();
        if (!settle(piece)) split(piece);
    }
}

}  // namespace hausbench
