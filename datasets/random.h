// Random numbers that are the same on every machine. Each is a hash of the seed and a counter (kernel/splitmix.h);
// the distributions of the standard library differ from one library to another.
#pragma once

#include "algorithms/kernel/splitmix.h"

namespace hausbench {

class RandomNumbers {
public:
    explicit RandomNumbers(std::uint64_t seed) : key_(splitmix(seed + golden_step)) {}

    // Returns 64 random bits: number `counter` of the sequence. The order of calls does not matter.
    std::uint64_t bits(std::uint64_t counter) const { return splitmix(key_ + (counter + 1) * golden_step); }

    // Returns number `counter` of the sequence as a multiple of 2^-53 in [0, 1).
    double uniform(std::uint64_t counter) const { return static_cast<double>(bits(counter) >> 11) * 0x1p-53; }

private:
    std::uint64_t key_;
};

}  // namespace hausbench
