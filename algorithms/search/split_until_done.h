// The main loop of searches that split one piece of A at a time.
#pragma once

#include "algorithms/search/bounds.h"
#include "algorithms/search/queue.h"

namespace hausbench {

// Takes pieces from the queue, the largest upper bound first, until the bounds answer the query or the time or the
// budget is spent. Returns the reason. settle(piece) must return whether the piece can be dropped: the lower bound may
// have grown since the piece was queued. If not, split(piece) must cut the piece and queue its parts.
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
