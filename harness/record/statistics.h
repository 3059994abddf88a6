// Medians and ratios, with intervals that are valid for every distribution of times.
#pragma once

#include <vector>

namespace hausbench {

struct Estimate {
    double value = 0, low = 0, high = 0;
    double confidence = 0;  // of [low, high]; 0 if there is only one value
    std::size_t n = 0;
};

// Returns the median, with the narrowest pair of order statistics x(k), x(n+1-k) that covers the
// true median with a confidence of at least 95 % (binomial); if n is too small for that, [min,
// max] with its confidence 1 - 2^(1-n). Throws if `values` is empty.
Estimate median(std::vector<double> values);

// Returns exp(median) of the logarithms of candidate[i] / base[i], paired by position; ignores
// the end of the longer list.
Estimate paired_ratio(const std::vector<double>& base, const std::vector<double>& candidate);

// Returns "faster" or "slower" if the interval excludes 1 with 95 % confidence, which takes at
// least six rounds; otherwise the reason why neither is known.
const char* verdict_of(const Estimate& ratio);

double geometric_mean(const std::vector<double>& values);

// Returns whether the interval excludes 1; if not, the two are "not separated".
inline bool separated(const Estimate& ratio) { return ratio.n > 1 && (ratio.low > 1 || ratio.high < 1); }

}  // namespace hausbench
