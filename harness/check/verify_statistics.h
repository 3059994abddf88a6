// Re-checks statistics of the distance (Quantity::distribution), independently of the solver: by random samples.
//
// Let A and B be the shapes moved by their poses, and d the distance of a point of A to B. n points of A are drawn,
// uniformly by area or by number, and their distances measured with a tree of boxes that shares no code with the
// solvers. R is an upper bound on d over A. Intervals around the estimates hold with a probability of at least
// 1 - 1e-12 each:
// - for means, of d or of d^2: the empirical Bernstein bound of Maurer and Pontil (2009, theorem 4), which needs the
//   variance of the samples and R;
// - for shares and quantiles: the inequality of Dvoretzky, Kiefer and Wolfowitz with Massart's constant, |F_n - F| <= e
//   everywhere.
// A shape that counts by number is measured completely, so these terms are 0.
//
// A bound is refuted if its interval lies outside of this one, by more than rounding explains. So the check can refute
// bounds, not prove them, and a bound that is wrong by less than about 1 % of the spread of d may pass. The largest
// distance is compared with the largest sample and with R.
#pragma once

#include "harness/check/verify.h"
#include "harness/result/result_file.h"

#include <map>
#include <memory>

namespace hausbench {

// Checks statistics of two point sets or meshes in fixed poses. Use one checker for all rows of a pair, because it
// keeps its samples.
class StatisticsChecker {
public:
    StatisticsChecker(const Shape& source, const Pose& source_pose, const Shape& target, const Pose& target_pose,
                      Stop stop = {}, std::size_t samples = 100'000);
    ~StatisticsChecker();

    // Checks the bounds of a statistic. Returns `not_checked` if the largest |coordinate| is not between 1e-140 and 1e140
    // (and not 0), if a mesh without area counts by area, or if the check was stopped.
    Check check(const Bounds& bounds, const Statistic& statistic, WeighBy weigh);

private:
    struct Samples;
    const Samples* samples(bool of_source, WeighBy weigh);  // null: there are none

    struct Pair;
    std::unique_ptr<Pair> pair_;
};

// Checks the rows `members`, statistics of two shapes in the same poses, as verify_rows() (verify.h) does.
void check_statistics(std::vector<Row>& rows, const std::vector<std::size_t>& members, std::size_t checked,
                      const std::function<const Shape*(const std::string&)>& load, const Stop& stop);

}  // namespace hausbench
