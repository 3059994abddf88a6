#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "structures/near_cells.cpp"
#include <hwy/foreach_target.h>

#include "structures/near_cells.h"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hausbench::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

void cells_of(const CellLayout& layout, const double* points, std::size_t count, std::int32_t* cells) {
    using Doubles = hn::CappedTag<double, 8>;
    const Doubles d;
    const hn::Rebind<std::int32_t, Doubles> whole;
    const auto per_length = hn::Set(d, layout.cells_per_length), zero = hn::Zero(d);
    // The operations of CellLayout::along(), in its order.
    const auto along = [&](hn::Vec<Doubles> x, int k) HWY_ATTR {
        const auto scaled = hn::Mul(hn::Sub(x, hn::Set(d, layout.low[k])), per_length);
        return hn::DemoteTo(whole, hn::Min(hn::Max(scaled, zero), hn::Set(d, layout.last[k])));
    };
    const auto row = hn::Set(whole, layout.size[0]), column = hn::Set(whole, layout.size[1]);
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
        hn::Vec<Doubles> x, y, z;
        hn::LoadInterleaved3(d, points + 3 * i, x, y, z);
        const auto cell = hn::Add(along(x, 0), hn::Mul(row, hn::Add(along(y, 1), hn::Mul(column, along(z, 2)))));
        hn::StoreU(cell, whole, cells + i);
    }
    for (; i < count; ++i) cells[i] = layout.cell_of(points + 3 * i);
}

}  // namespace
}  // namespace hausbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench {

HWY_EXPORT(cells_of);

void cells_of(const CellLayout& layout, const double* points, std::size_t count, std::int32_t* cells) {
    HWY_DYNAMIC_DISPATCH(cells_of)(layout, points, count, cells);
}

}  // namespace hausbench
#endif
