// Medians and ratios with intervals that assume nothing about the distribution of times.
#pragma once

#include <vector>

namespace hausbench {

struct Estimate {
    double value = 0, low = 0, high = 0;
    double confidence = 0;  // of [low, high]; 0 where one value is all there is
    std::size_t n = 0;
};

// Median, with the narrowest pair of order statistics x(k), x(n+1-k) that covers the true median with at least 95 %
// (binomial); where n is too small for that, [min, max] with the confidence it has, 1 - 2^(1-n). Throws for no values.
Estimate median(std::vector<double> values);

// exp(median) of the logarithms of candidate[i] / base[i], paired by position; the longer list's rest is left out.
Estimate paired_ratio(const std::vector<double>& base, const std::vector<double>& candidate);

// Whether the interval leaves out 1: otherwise the two are "not separated".
inline bool separated(const Estimate& ratio) { return ratio.n > 1 && (ratio.low > 1 || ratio.high < 1); }

}  // namespace hausbench
