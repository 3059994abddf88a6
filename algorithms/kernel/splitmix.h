// The random number generator SplitMix64, which gives the same numbers on every machine.
//
// The n-th number is splitmix(seed + n * golden_step). Source: Steele, Lea, Flood: Fast splittable pseudorandom number
// generators, OOPSLA 2014.
#pragma once

#include <cstdint>

namespace hausbench {

// An odd number, about 2^64 divided by the golden ratio. Its multiples are spread evenly over the 64-bit integers, and
// multiplying a number by it mixes low bits into the high ones.
inline constexpr std::uint64_t golden_step = 0x9e3779b97f4a7c15;

// Mixes the bits of z, so that even consecutive numbers give results that look random. No two numbers have the same
// result.
inline constexpr std::uint64_t splitmix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
}

}  // namespace hausbench
