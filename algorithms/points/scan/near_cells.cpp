#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/points/scan/near_cells.cpp"
#include <hwy/foreach_target.h>

#include "algorithms/points/scan/near_cells.h"

#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace hausbench::scan::HWY_NAMESPACE {

namespace {
namespace hn = hwy::HWY_NAMESPACE;

void cells_of_each(const CellLayout& layout, const double* points, std::size_t count, std::int32_t* cells) {
    using Doubles = hn::CappedTag<double, 8>;
    const Doubles d;
    const hn::Rebind<std::int32_t, Doubles> whole;
    const auto per_length = hn::Set(d, layout.cells_per_length), zero = hn::Zero(d);
    // Performs the operations of CellLayout::along() in the same order.
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

std::size_t squared_to_each(const CellLayout& layout, const double* of_cells, const double* points, std::size_t count,
                            double* squared) {
    using Doubles = hn::CappedTag<double, 8>;
    const Doubles d;
    const hn::Rebind<std::int32_t, Doubles> whole;
    const hn::Rebind<std::int64_t, Doubles> wide;
    constexpr std::size_t chunk = 256;
    HWY_ALIGN std::int32_t cells[chunk];
    auto most = hn::Set(d, -1.0);
    double rest = -1;
    for (std::size_t begin = 0; begin < count; begin += chunk) {
        const std::size_t some = std::min(chunk, count - begin);
        cells_of_each(layout, points + 3 * begin, some, cells);
        std::size_t i = 0;
        for (; i + hn::Lanes(d) <= some; i += hn::Lanes(d)) {
            hn::Vec<Doubles> x, y, z;
            hn::LoadInterleaved3(d, points + 3 * (begin + i), x, y, z);
            const auto at = hn::ShiftLeft<2>(hn::PromoteTo(wide, hn::Load(whole, cells + i)));
            x = hn::Sub(x, hn::GatherIndex(d, of_cells, at));
            y = hn::Sub(y, hn::GatherIndex(d, of_cells + 1, at));
            z = hn::Sub(z, hn::GatherIndex(d, of_cells + 2, at));
            const auto s = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
            hn::StoreU(s, d, squared + begin + i);
            most = hn::Max(most, s);
        }
        for (; i < some; ++i) {
            const double* const p = points + 3 * (begin + i);
            const double* const q = of_cells + 4 * static_cast<std::size_t>(cells[i]);
            const double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
            squared[begin + i] = (x * x + y * y) + z * z;
            rest = std::max(rest, squared[begin + i]);
        }
    }
    const double largest = std::max(rest, hn::GetLane(hn::MaxOfLanes(d, most)));
    return static_cast<std::size_t>(std::find(squared, squared + count, largest) - squared);
}

}  // namespace
}  // namespace hausbench::scan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench::scan {

HWY_EXPORT(cells_of_each);
HWY_EXPORT(squared_to_each);

void cells_of(const CellLayout& layout, const double* points, std::size_t count, std::int32_t* cells) {
    HWY_DYNAMIC_DISPATCH(cells_of_each)(layout, points, count, cells);
}

std::size_t squared_to_cells(const CellLayout& layout, const double* of_cells, const double* points, std::size_t count,
                             double* squared) {
    return HWY_DYNAMIC_DISPATCH(squared_to_each)(layout, of_cells, points, count, squared);
}

}  // namespace hausbench::scan
#endif
