// Reproducible random numbers for tests.
#pragma once

#include "algorithms/scene.h"

#include <cstdint>

namespace hausbench {

class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15 + 1) {}

    std::uint64_t bits() {
        state_ ^= state_ << 13;
        state_ ^= state_ >> 7;
        return state_ ^= state_ << 17;
    }
    Index below(Index n) { return static_cast<Index>(bits() % static_cast<std::uint64_t>(n)); }
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }  // [0, 1)
    double real(double low, double high) { return low + (high - low) * unit(); }
    Vec3 vector(double size = 1) {
        const double x = real(-size, size), y = real(-size, size), z = real(-size, size);
        return {x, y, z};
    }

private:
    std::uint64_t state_;
};

}  // namespace hausbench
