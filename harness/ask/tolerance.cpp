#include "harness/ask/tolerance.h"

#include <algorithm>
#include <limits>

namespace hausbench {

double unit_of(const std::string& of, double diagonal, double longest_side) {
    return of == "diagonal" ? diagonal : of == "longest" ? longest_side : 1;
}

double diagonal_of_both(const Points& a, const Points& b) {
    Points corners(4, 3);
    corners << a.colwise().minCoeff(), a.colwise().maxCoeff(), b.colwise().minCoeff(), b.colwise().maxCoeff();
    return diagonal(corners);
}

// The lower limit is for an A that is a point, or so small that the product rounds to 0: the answer should then be as
// tight as doubles allow. The upper limit is for an A whose diagonal overflows.
double tolerance_as_length(double tolerance, double unit) {
    using Limit = std::numeric_limits<double>;
    return std::clamp(tolerance * unit, Limit::denorm_min(), Limit::max());
}

ResolvedTolerance resolve_tolerance(double tolerance, const std::string& of, const Points& a, double extent) {
    if (of == "lower") return {{Tolerance::Of::lower, tolerance}, of};
    ResolvedTolerance resolved{{}, of, unit_of(of, diagonal(a), longest_side(a))};
    resolved.fell_back = resolved.unit == 0;
    if (resolved.unit == 0) {
        resolved.of = "diagonal of both";
        resolved.unit = extent;
    }
    if (resolved.unit == 0) {
        resolved.of = "absolute";
        resolved.unit = 1;
    }
    resolved.tolerance = {Tolerance::Of::absolute, tolerance_as_length(tolerance, resolved.unit)};
    return resolved;
}

}  // namespace hausbench
