#include "bench/closest_rival.h"

namespace hausbench {

std::unique_ptr<ClosestRival> embree_rival() { return nullptr; }

}  // namespace hausbench
