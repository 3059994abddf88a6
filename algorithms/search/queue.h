// The queue of a branch-and-bound search, ordered by largest upper bound.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace hausbench {

// A priority queue of pieces. `Piece` has a member `upper`, its upper bound. The heap moves a bound and an index,
// 16 bytes; the pieces themselves do not move, and the slot of a removed piece is reused, so memory is bounded by
// the peak number of pieces. Pieces with equal bounds come in the order of std::push_heap and std::pop_heap, which
// depends only on the order of the calls.
template <class Piece> class PieceQueue {
public:
    bool empty() const { return heap_.empty(); }
    std::size_t size() const { return heap_.size(); }
    std::size_t places() const { return pieces_.size(); }

    // Returns the largest upper bound in the queue, 0 if it is empty.
    double upper() const { return heap_.empty() ? 0.0 : heap_.front().upper; }

    // Adds a piece. O(log n). At most 2^32 pieces at a time.
    void push(const Piece& piece) {
        std::uint32_t place = static_cast<std::uint32_t>(pieces_.size());
        if (free_.empty()) {
            pieces_.push_back(piece);
        } else {
            place = free_.back();
            free_.pop_back();
            pieces_[place] = piece;
        }
        heap_.push_back({piece.upper, place});
        std::push_heap(heap_.begin(), heap_.end());
    }

    // Removes and returns the piece with the largest upper bound. O(log n).
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
        std::uint32_t place;

        bool operator<(const Queued& other) const { return upper < other.upper; }
    };

    std::vector<Queued> heap_;
    std::vector<Piece> pieces_;
    std::vector<std::uint32_t> free_;  // places in pieces_
};

}  // namespace hausbench
