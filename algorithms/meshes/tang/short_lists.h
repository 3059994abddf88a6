// Stores many short lists of numbers, such as the triangles of B kept for each piece, in one block of memory.
#pragma once

#include "algorithms/kernel/geometry.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hausbench {

// Each list has at most `most` numbers. Released space is reused for lists of about the same length, so memory is
// bounded by the peak number of lists of each length.
template <std::size_t most> class ShortLists {
public:
    struct List {
        std::uint32_t begin = 0, count = 0;
    };

    // Copies a list; an empty one takes no space.
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

    // Returns the numbers of a list; valid until the next store().
    std::span<const Index> numbers(const List& list) const { return {numbers_.data() + list.begin, list.count}; }

    void give_back(const List& list) {
        if (list.count > 0) free_[kind(list.count)].push_back(list.begin);
    }

private:
    static constexpr std::size_t step = 4;
    static std::size_t kind(std::size_t count) { return (count - 1) / step; }

    std::vector<Index> numbers_;
    std::array<std::vector<std::uint32_t>, (most + step - 1) / step> free_;  // places in numbers_
};

}  // namespace hausbench
