// The main loop of searches that split one piece of A at a time.
#pragma once

#include "algorithms/search/bounds.h"
#include "algorithms/search/queue.h"

namespace hausbench {

// Splits the piece with the largest upper bound until the bounds are close enough, or time or budget is spent. Calls settle(piece), which
// returns whether the lower bound settles it by now, and otherwise split(piece).
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
