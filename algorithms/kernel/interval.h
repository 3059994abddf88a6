// Interval arithmetic with directed rounding: CGAL's Interval_nt, in the variant that does not switch the rounding mode
// itself.
//
// Code that computes with Interval must keep an UpwardRounding object alive while it does. Operations on plain doubles
// are then rounded upward as well; comments say so if a bound depends on it.
//
// CGAL's type was chosen for its speed: it takes about 3 times as long as plain doubles. It keeps (-low, high) in one
// SSE register, so that rounding upward is right for both ends. Boost.Interval takes about 28 times as long as doubles
// with its default policy, which sets and restores the rounding mode in each operation.
#pragma once

#ifndef __ROUNDING_MATH__
#error \
    "interval.h: compile with -frounding-math: without it the compiler may move arithmetic out of UpwardRounding's scope"
#endif

#include "algorithms/kernel/watched.h"

#include <CGAL/Interval_nt.h>

namespace hausbench {

using Interval = CGAL::Interval_nt<false>;

// Sets the rounding mode to upward for its lifetime, and then restores the previous mode.
using UpwardRounding = CGAL::Protect_FPU_rounding<true>;

// Returns the smallest interval, up to rounding, that contains the n-th power of every number in x, for n >= 0. Even
// powers are never negative, whereas x * x may be, because interval multiplication treats its factors as independent.
// O(log n).
inline Interval power(const Interval& x, int n) {
    if (n == 0) return Interval(1.0);
    if (n == 1) return x;
    if (n % 2 == 0) return CGAL::square(power(x, n / 2));
    // Pass each end twice, because the constructor with one argument requires a finite number.
    const Interval low(x.inf(), x.inf()), high(x.sup(), x.sup());
    const Interval at_low = CGAL::square(power(low, n / 2)) * low, at_high = CGAL::square(power(high, n / 2)) * high;
    return Interval(at_low.inf(),
                    WATCHED_ELSE("power: the upper end of an odd one, replayed", at_high.sup(), at_low.sup()));
}

// Returns the largest absolute value in x.
inline double magnitude(const Interval& x) { return x.sup() > -x.inf() ? x.sup() : -x.inf(); }

}  // namespace hausbench
