#include "harness/record/estimates.h"

#include <boost/math/distributions/binomial.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace hausbench {

namespace {

// The interval [x(k), x(n+1-k)] of n sorted values x(1) to x(n), and its confidence that it has the true median.
struct Ranks {
    std::size_t k;
    double confidence;
};

Ranks computed_ranks(std::size_t n) {
    const boost::math::binomial heads(double(n), 0.5);
    // The interval misses the true median only if fewer than k values lie on one side of that median.
    std::size_t k = 1;
    while (2 * (k + 1) <= n && 1 - 2 * boost::math::cdf(heads, double(k)) >= 0.95) ++k;
    return {k, 1 - 2 * boost::math::cdf(heads, double(k - 1))};
}

Ranks ranks_of(std::size_t n) {  // the last ones are kept, because a result has the same n in row after row
    thread_local std::size_t cached_n = 0;
    thread_local Ranks ranks{};
    if (n != cached_n) ranks = computed_ranks(n);
    cached_n = n;
    return ranks;
}

}  // namespace

Estimate median(std::vector<double> values) {
    if (values.empty()) throw std::invalid_argument("median: no values");
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    Estimate estimate{n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]), values.front(), values.back(),
                      0, n};
    if (n == 1) return estimate;
    const Ranks ranks = ranks_of(n);
    estimate.low = values[ranks.k - 1];
    estimate.high = values[n - ranks.k];
    estimate.confidence = ranks.confidence;
    return estimate;
}

Estimate paired_ratio(const std::vector<double>& base, const std::vector<double>& candidate) {
    if (base.size() != candidate.size()) throw std::invalid_argument("paired_ratio: lists of different lengths");
    std::vector<double> logs;
    for (std::size_t i = 0; i < base.size(); ++i) logs.push_back(std::log(candidate[i] / base[i]));
    Estimate ratio = median(logs);
    ratio.value = std::exp(ratio.value);
    ratio.low = std::exp(ratio.low);
    ratio.high = std::exp(ratio.high);
    return ratio;
}

const char* verdict_of(const Estimate& ratio) {
    return ratio.confidence < 0.95 ? "too few rounds"
           : !separated(ratio)     ? "not separated"
           : ratio.value > 1       ? "slower"
                                   : "faster";
}

double geometric_mean(const std::vector<double>& values) {
    double logs = 0;
    for (double value : values) logs += std::log(value);
    return std::exp(logs / double(values.size()));
}

}  // namespace hausbench
