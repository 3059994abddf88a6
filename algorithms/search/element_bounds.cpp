#include "algorithms/search/element_bounds.h"

#include "algorithms/kernel/watched.h"

#include <algorithm>

namespace hausbench {

void ElementBounds::offer(const MeasuredPoint& point, Index source, int level) {
    Farthest& far = farthest[static_cast<std::size_t>(source)];
    if (WATCHED_ELSE("fields: the farthest point of a triangle counts", point.squared > far.point.squared, true))
        far = {point, source, level};
}

void ElementBounds::settle(double bound, Index source) {
    double& most = upper[static_cast<std::size_t>(source)];
    most = std::max(WATCHED("fields: the largest of what is settled counts", most), bound);
}

void ElementBounds::subdivided(Index source, int level) {
    double& most = deepest[static_cast<std::size_t>(source)];
    most = std::max(WATCHED("fields: the deepest level counts", most), static_cast<double>(level));
}

}  // namespace hausbench
