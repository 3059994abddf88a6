// Random orders that depend only on a seed, so they are the same on every machine.
#pragma once

#include "algorithms/kernel/splitmix.h"
#include "algorithms/scene.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace hausbench {

// SplitMix64 as a random number generator.
class Generator {
public:
    explicit Generator(std::uint64_t seed) : state_(seed) {}

    std::uint64_t operator()() { return splitmix(state_ += golden_step); }

private:
    std::uint64_t state_;
};

// Returns the numbers 0 to count - 1, shuffled if `shuffle` is set, otherwise in ascending order.
inline std::vector<Index> order_of(Index count, bool shuffle, Generator& random) {
    std::vector<Index> order(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Index>(i);
    if (!shuffle) return order;
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    return order;
}

}  // namespace hausbench
