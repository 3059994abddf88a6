// Medians and ratios of times, with confidence intervals that are valid for every distribution.
#pragma once

#include <vector>

namespace hausbench {

// An estimate from n values, with its confidence interval [low, high].
struct Estimate {
    double value = 0, low = 0, high = 0;
    double confidence = 0;  // of [low, high]; 0 if there is only one value
    std::size_t n = 0;
};

// Returns the median of n values. Its interval is [x(k), x(n+1-k)], where x(k) is the k-th smallest value and k is the
// largest for which the interval contains the true median with a confidence of at least 95 % (by the binomial
// distribution). If n is too small for that, the interval is [min, max], with a confidence of 1 - 2^(1-n). Throws if
// `values` is empty.
Estimate median(std::vector<double> values);

// Returns the median of the ratios candidate[i] / base[i], computed from their logarithms. Throws
// std::invalid_argument if the lists have different lengths or no values.
Estimate paired_ratio(const std::vector<double>& base, const std::vector<double>& candidate);

// Returns "faster" or "slower" if the interval excludes 1 with 95 % confidence, which needs at least six rounds.
// Otherwise returns the reason: "too few rounds" or "not separated".
const char* verdict_of(const Estimate& ratio);

double geometric_mean(const std::vector<double>& values);

// Returns whether the interval excludes 1, so that one of the two compared is faster.
inline bool separated(const Estimate& ratio) { return ratio.n > 1 && (ratio.low > 1 || ratio.high < 1); }

}  // namespace hausbench
