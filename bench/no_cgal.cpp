#include "bench/closest_rival.h"

namespace hausbench {

std::unique_ptr<ClosestRival> cgal_rival() { return nullptr; }

}  // namespace hausbench
