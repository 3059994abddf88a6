// The priority queue of branch-and-bound searches.
#pragma once

#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace hausbench {

// A priority queue of pieces: the one with the largest upper bound comes out first. `Piece` is any type with a member
// `upper`, its upper bound.
//
// The heap moves entries of 16 bytes (a bound and the index of a slot), not pieces. Slots are reused, so memory is
// bounded by the largest number of pieces queued at one time. Pieces with equal bounds come out in an order that
// depends only on the sequence of calls.
template <class Piece> class PieceQueue {
public:
    bool empty() const { return heap_.empty(); }
    std::size_t size() const { return heap_.size(); }
    // Returns the number of slots: the largest number of pieces that were queued at one time.
    std::size_t places() const { return pieces_.size(); }

    // Returns the largest upper bound in the queue, or 0 if the queue is empty.
    double upper() const { return heap_.empty() ? 0.0 : heap_.front().upper; }

    // Adds a piece. O(log n). The queue holds at most 2^32 pieces.
    void push(const Piece& piece) {
        std::uint32_t place = static_cast<std::uint32_t>(pieces_.size());
        if (WATCHED_ELSE("queue: places are used again", free_.empty(), true)) {
            pieces_.push_back(piece);
        } else {
            place = free_.back();
            free_.pop_back();
            pieces_[place] = piece;
        }
        heap_.push_back({piece.upper, place});
        std::push_heap(heap_.begin(), heap_.end());
    }

    // Removes and returns the piece with the largest upper bound. The queue must not be empty. O(log n).
    Piece pop() {
        std::pop_heap(heap_.begin(), heap_.end());
        free_.push_back(heap_.back().place);
        heap_.pop_back();
        return pieces_[free_.back()];
    }

    // Calls f for each piece in the queue, in no particular order.
    template <class Visit> void for_each(const Visit& visit) const {
        for (const Queued& queued : heap_) visit(pieces_[queued.place]);
    }

private:
    struct Queued {
        double upper;
        std::uint32_t place;  // index in pieces_

        bool operator<(const Queued& other) const {
            return WATCHED_ELSE("queue: the largest bound first", upper < other.upper, other.upper < upper);
        }
    };

    std::vector<Queued> heap_;
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> free_;  // unused indices of pieces_
};

}  // namespace hausbench
