#include "algorithms/search/element_bounds.h"

#include <algorithm>

namespace hausbench {

void ElementBounds::offer(const MeasuredPoint& point, Index source, int level) {
    Farthest& far = farthest[static_cast<std::size_t>(source)];
    if (point.squared > far.point.squared) far = {point, source, level};
}

void ElementBounds::settle(double bound, Index source) {
    double& most = upper[static_cast<std::size_t>(source)];
    most = std::max(most, bound);
}

void ElementBounds::subdivided(Index source, int level) {
    double& most = deepest[static_cast<std::size_t>(source)];
    most = std::max(most, static_cast<double>(level));
}

}  // namespace hausbench
