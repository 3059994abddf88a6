// Points in Morton order (Z order): neighbours in the order are mostly neighbours in space.
//
// Source: Morton, A computer oriented geodetic data base, 1966. Only the order of work and the shape of trees depend on it,
// never a bound, so its rounding does not matter.
#pragma once

#include "box.h"

#include <cstdint>
#include <span>
#include <vector>

namespace hausbench {

// A cube over a box, cut into 2^10 cells along each axis. Points outside count as those at its faces.
class MortonFrame {
public:
    MortonFrame() = default;
    explicit MortonFrame(const Box& box);

    // 30 bits.
    std::uint32_t key(const double* point) const;

private:
    Vec3 low_ = Vec3::Zero();
    double cells_per_length_ = 0;
};

struct MortonOrder {
    std::vector<Index> order;         // the chosen points, each once
    std::vector<std::uint32_t> keys;  // of the frame, never falling
};

// Sorts the chosen rows (all rows if `chosen` is null) by key, equal keys by row. With `refine`, points that share a cell
// are sorted again in the frame of their own box, until few are left in each; keys stay those of the given frame.
// O(n) for tame data: a radix sort; O(n) memory.
MortonOrder morton_order(const Points& points, const std::vector<Index>* chosen, const MortonFrame& frame, bool refine);

}  // namespace hausbench
