// Stores many short lists of numbers, such as the triangles of B kept for each piece, in one block of memory.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hausbench::tang {

// Lists of up to `most` numbers each. Lengths are rounded up to a multiple of 4, and the space of a released list is
// reused for a list of the same rounded length. All lists together must occupy less than 2^32 numbers.
template <std::size_t most> class ShortLists {
public:
    // The handle of a stored list: numbers_[begin] to numbers_[begin + count - 1].
    struct List {
        std::uint32_t begin = 0, count = 0;
    };

    // Stores a copy of the numbers and returns its handle. An empty list occupies no space.
    List store(std::span<const Index> numbers) {
        if (numbers.empty()) return {};
        std::vector<std::uint32_t>& free = free_[kind(numbers.size())];
        List list{static_cast<std::uint32_t>(numbers_.size()), static_cast<std::uint32_t>(numbers.size())};
        if (free.empty()) {
            numbers_.resize(numbers_.size() + step * (kind(numbers.size()) + 1));
        } else {
            list.begin = free.back();
            free.pop_back();
        }
        std::copy(numbers.begin(), numbers.end(), numbers_.begin() + list.begin);
        return list;
    }

    // Returns the numbers of a list. The span is valid until the next store().
    std::span<const Index> numbers(const List& list) const { return {numbers_.data() + list.begin, list.count}; }

    // Releases a list so that its space can be reused. The handle becomes invalid.
    void give_back(const List& list) {
        if (list.count > 0) free_[kind(list.count)].push_back(list.begin);
    }

private:
    static constexpr std::size_t step = 4;
    static std::size_t kind(std::size_t count) { return (count - 1) / step; }

    std::vector<Index> numbers_;
    // free_[k]: where the released lists with room for step * (k + 1) numbers begin in numbers_.
    std::array<std::vector<std::uint32_t>, (most + step - 1) / step> free_;
};

}  // namespace hausbench::tang
