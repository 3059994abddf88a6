#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "algorithms/points/scan/passes.cpp"
#include <hwy/foreach_target.h>

#include "algorithms/kernel/watched.h"
#include "algorithms/points/scan/passes.h"

#include <hwy/highway.h>

#include <cmath>
#include <limits>

#ifndef HAUSBENCH_SCAN_PASSES_ONCE
#define HAUSBENCH_SCAN_PASSES_ONCE
namespace hausbench::scan {
namespace {

// The nearest point of B so far for one row of A. Stores only its tile, a group of 256 successive rows of B, to keep
// the inner loop fast. compare_with_all() finds the row in the tile.
struct Best {
    double squared = std::numeric_limits<double>::infinity();
    std::size_t begin = 0;  // the first row of the tile
};

}  // namespace
}  // namespace hausbench::scan
#endif

HWY_BEFORE_NAMESPACE();
namespace hausbench::scan::HWY_NAMESPACE {

namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 8>;

// Returns the bounding box of some points, and whether they have tiny coordinates. The points are given by `count`
// coordinates, three for each point.
Extent extent_of_part(const double* data, std::size_t count) {
    const Doubles d;
    const std::size_t lanes = hn::Lanes(d);
    Extent extent;
    const auto look = [&](double x, std::size_t i) {
        const auto k = static_cast<Index>(i % 3);
        extent.box.low[k] = std::min(extent.box.low[k], x);
        extent.box.high[k] = std::max(extent.box.high[k], x);
        extent.tiny = extent.tiny || (x != 0 && std::abs(x) < smallest_safe_coordinate);
    };
    std::size_t i = 0;
    if (count >= 3 * lanes) {
        // Three vectors hold `lanes` points: lane j of vector v is a coordinate along axis (v * lanes + j) mod 3.
        hn::Vec<Doubles> low[3], high[3];
        for (auto& v : low) v = hn::Set(d, infinity);
        for (auto& v : high) v = hn::Set(d, -infinity);
        auto tiny = hn::Zero(d);
        const auto safe = hn::Set(d, smallest_safe_coordinate), one = hn::Set(d, 1.0);
        for (; i + 3 * lanes <= count; i += 3 * lanes) {
            for (std::size_t v = 0; v < 3; ++v) {
                const auto x = hn::LoadU(d, data + i + v * lanes);
                low[v] = hn::Min(low[v], x);
                high[v] = hn::Max(high[v], x);
                const auto small = hn::And(hn::Lt(hn::Abs(x), safe), hn::Ne(x, hn::Zero(d)));
                tiny = hn::Max(tiny, hn::IfThenElseZero(small, one));
            }
        }
        HWY_ALIGN double buffer[8];
        for (std::size_t v = 0; v < 3; ++v) {
            hn::Store(low[v], d, buffer);
            for (std::size_t j = 0; j < lanes; ++j) look(buffer[j], v * lanes + j);
            hn::Store(high[v], d, buffer);
            for (std::size_t j = 0; j < lanes; ++j) look(buffer[j], v * lanes + j);
        }
        if (WATCHED("scan: tiny coordinates in the pass that looks for them", true))
            extent.tiny = hn::GetLane(hn::MaxOfLanes(d, tiny)) > 0;
    }
    for (; i < count; ++i) look(data[i], i);
    return extent;
}

// Compares each of the given rows of A with the rows [begin, end) of B. Updates best[q], the nearest point to rows[q]
// so far, if one of these is nearer.
void nearest_of_part(const Points& a, std::span<const Index> rows, const Points& b, std::size_t begin, std::size_t end,
                     Best* best) {
    const Doubles d;
    constexpr std::size_t tile = 256;
    HWY_ALIGN double x[tile], y[tile], z[tile];
    for (; begin < end; begin += tile) {
        const double* const data = b.data() + 3 * begin;
        if (end - begin >= tile) {
            for (std::size_t i = 0; i < tile; i += hn::Lanes(d)) {
                hn::Vec<Doubles> vx, vy, vz;
                hn::LoadInterleaved3(d, data + 3 * i, vx, vy, vz);
                hn::Store(vx, d, x + i);
                hn::Store(vy, d, y + i);
                hn::Store(vz, d, z + i);
            }
        } else {
            for (std::size_t i = 0; i < tile; ++i) {  // pads the last tile with its last point
                const double* const p = data + 3 * std::min(i, end - 1 - begin);
                x[i] = p[0];
                y[i] = p[1];
                z[i] = p[2];
            }
        }
        for (std::size_t q = 0; q < rows.size(); ++q) {
            const double* const p = a.row(rows[q]).data();
            const auto px = hn::Set(d, p[0]), py = hn::Set(d, p[1]), pz = hn::Set(d, p[2]);
            auto least = hn::Set(d, infinity);
            for (std::size_t i = 0; i < tile; i += hn::Lanes(d)) {
                const auto dx = hn::Sub(px, hn::Load(d, x + i)), dy = hn::Sub(py, hn::Load(d, y + i)),
                           dz = hn::Sub(pz, hn::Load(d, z + i));
                // Uses the operations of squared_distance() in the same order, so that the bits are the same.
                least = hn::Min(least, hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz)));
            }
            const double squared = hn::GetLane(hn::MinOfLanes(d, least));
            if (squared < best[q].squared) best[q] = {squared, begin};
        }
    }
}

}  // namespace
}  // namespace hausbench::scan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hausbench::scan {

HWY_EXPORT(extent_of_part);
HWY_EXPORT(nearest_of_part);

namespace {

constexpr std::size_t part_rows = 1 << 14;  // least number of rows for which a thread is worth its cost

std::vector<Best> nearest_of_all(const Points& a, std::span<const Index> rows, const Points& b,
                                 const Threads& threads) {
    const auto count = static_cast<std::size_t>(b.rows());
    const std::size_t parts = blocks_of(count, part_rows);
    std::vector<std::vector<Best>> best(parts, std::vector<Best>(rows.size()));
    threads.for_each(parts, [&](std::size_t p) {
        const Part mine = part(count, p, parts);
        HWY_DYNAMIC_DISPATCH(nearest_of_part)(a, rows, b, mine.begin, mine.end, best[p].data());
    });
    for (std::size_t p = 1; p < parts; ++p) {
        for (std::size_t q = 0; q < rows.size(); ++q)
            if (best[p][q].squared < best[0][q].squared) best[0][q] = best[p][q];
    }
    return std::move(best[0]);
}

}  // namespace

Extent extent_of(const Points& points, const Threads& threads) {
    const auto count = static_cast<std::size_t>(points.rows());
    const std::size_t parts = blocks_of(count, part_rows);
    std::vector<Extent> extents(parts);
    threads.for_each(parts, [&](std::size_t p) {
        const Part mine = part(count, p, parts);
        extents[p] = HWY_DYNAMIC_DISPATCH(extent_of_part)(points.data() + 3 * mine.begin, 3 * mine.size());
    });
    Extent whole = extents[0];
    for (const Extent& extent : extents) {
        whole.box.add(extent.box.low);
        whole.box.add(extent.box.high);
        whole.tiny = whole.tiny || extent.tiny;
    }
    return whole;
}

std::vector<double> squared_to_nearest(const Points& a, std::span<const Index> rows, const Points& b,
                                       const Threads& threads) {
    std::vector<double> squared;
    for (const Best& best : nearest_of_all(a, rows, b, threads)) squared.push_back(best.squared);
    return squared;
}

void compare_with_all(const Points& a, std::span<const Index> rows, const Points& b, const Threads& threads,
                      FarthestPoint& farthest, Counters& counters) {
    const std::vector<Best> best = nearest_of_all(a, rows, b, threads);
    counters.point_distances += rows.size() * static_cast<std::size_t>(b.rows());
    counters.closest_point_queries += rows.size();
    for (std::size_t q = 0; q < rows.size(); ++q) {
        if (!(best[q].squared > farthest.squared)) continue;
        auto j = static_cast<Index>(best[q].begin);
        while (squared_distance(a.row(rows[q]).data(), b.row(j).data()) != best[q].squared) ++j;
        farthest = {best[q].squared, rows[q], j};
    }
}

}  // namespace hausbench::scan
#endif
