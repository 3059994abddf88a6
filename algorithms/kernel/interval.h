// Interval arithmetic with directed rounding: CGAL's Interval_nt, without its own switching of the rounding mode.
//
// Chosen by cost: against plain doubles this type takes about 3 times as long. Boost.Interval takes about 28 times as long
// with its default policy, which sets the rounding mode and restores it in each operation. Without that policy it is nearly as
// fast as CGAL's, but does not set the mode at all. CGAL keeps (-low, high) in one SSE register, so that rounding upward
// gives both ends.
//
// Code that computes with Interval holds an UpwardRounding while it does. Plain doubles are then rounded upward as well;
// comments say so where a bound depends on it.
#pragma once

#ifndef __ROUNDING_MATH__
#error \
    "interval.h: compile with -frounding-math: without it the compiler may move arithmetic out of UpwardRounding's scope"
#endif

#include <CGAL/Interval_nt.h>

namespace hausbench {

using Interval = CGAL::Interval_nt<false>;

// Sets the rounding mode to upward, and restores it when it is destroyed.
using UpwardRounding = CGAL::Protect_FPU_rounding<true>;

// x^n, n >= 0, with even powers never below 0 and odd ones sharp. O(log n).
inline Interval power(const Interval& x, int n) {
    if (n == 0) return Interval(1.0);
    if (n == 1) return x;
    if (n % 2 == 0) return CGAL::square(power(x, n / 2));
    // Interval ends, because they may be infinite.
    const Interval low(x.inf(), x.inf()), high(x.sup(), x.sup());
    const Interval at_low = CGAL::square(power(low, n / 2)) * low, at_high = CGAL::square(power(high, n / 2)) * high;
    return Interval(at_low.inf(), at_high.sup());
}

// The largest absolute value.
inline double magnitude(const Interval& x) { return x.sup() > -x.inf() ? x.sup() : -x.inf(); }

}  // namespace hausbench
