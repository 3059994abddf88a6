#include "harness/record/statistics.h"

#include <boost/math/distributions/binomial.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace hausbench {

Estimate median(std::vector<double> values) {
    if (values.empty()) throw std::invalid_argument("median: no values");
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    Estimate estimate{n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]), values.front(), values.back(),
                      0, n};
    if (n == 1) return estimate;
    const boost::math::binomial heads(double(n), 0.5);
    // The interval [x(k), x(n+1-k)] misses the true median only if fewer than k values lie on one side of that median.
    std::size_t k = 1;
    while (2 * (k + 1) <= n && 1 - 2 * boost::math::cdf(heads, double(k)) >= 0.95) ++k;
    estimate.low = values[k - 1];
    estimate.high = values[n - k];
    estimate.confidence = 1 - 2 * boost::math::cdf(heads, double(k - 1));
    return estimate;
}

Estimate paired_ratio(const std::vector<double>& base, const std::vector<double>& candidate) {
    std::vector<double> logs;
    for (std::size_t i = 0; i < std::min(base.size(), candidate.size()); ++i)
        logs.push_back(std::log(candidate[i] / base[i]));
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
