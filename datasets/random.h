// Random numbers that are the same on every machine: a hash of the seed and a counter (splitmix64, Steele, Lea and
// Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014), never a std:: distribution.
#pragma once

#include <cstdint>

namespace hausbench {

class Random {
public:
    explicit Random(std::uint64_t seed) : key_(mix(seed + gamma)) {}

    // The number at one place of the sequence; any order of calls gives the same.
    std::uint64_t bits(std::uint64_t counter) const { return mix(key_ + (counter + 1) * gamma); }

    // In [0, 1): a multiple of 2^-53.
    double uniform(std::uint64_t counter) const { return static_cast<double>(bits(counter) >> 11) * 0x1p-53; }

private:
    static constexpr std::uint64_t gamma = 0x9e3779b97f4a7c15u;

    static std::uint64_t mix(std::uint64_t z) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }

    std::uint64_t key_;
};

}  // namespace hausbench
