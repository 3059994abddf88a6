// Which piece a branch-and-bound search looks into next: the one of largest upper bound.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace hausbench {

// `Piece` has a member `upper`, its upper bound. The heap moves a bound and a place, 16 bytes; the pieces themselves stay
// where they are, and the place of a piece that was taken is used again. So there are as many places as there were pieces
// at any one time. The order of equal bounds is that of std::push_heap and std::pop_heap: it depends on nothing but the
// order of the calls.
template <class Piece> class PieceQueue {
public:
    bool empty() const { return heap_.empty(); }
    std::size_t size() const { return heap_.size(); }
    std::size_t places() const { return pieces_.size(); }

    // The largest upper bound of a piece in the queue, 0 where it is empty.
    double upper() const { return heap_.empty() ? 0.0 : heap_.front().upper; }

    // O(log n). At most 2^32 pieces at a time.
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

    // The piece of largest upper bound, which leaves the queue. O(log n).
    Piece pop() {
        std::pop_heap(heap_.begin(), heap_.end());
        free_.push_back(heap_.back().place);
        heap_.pop_back();
        return pieces_[free_.back()];
    }

    // Each piece in the queue, in no order.
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
