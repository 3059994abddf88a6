#include "algorithms/points/scan/near_grid.h"

#include "algorithms/kernel/splitmix.h"
#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <array>

namespace hausbench::scan {
namespace {

// The indices of an occupied cell along the three axes. Empty if no occupied cell is known yet.
struct Place {
    std::int16_t x = -1, y = -1, z = -1;
    bool empty() const { return x < 0; }
};

// Returns the squared distance between the cells p and (x, y, z), in units of the edge of a cell.
int squared(const Place& p, int x, int y, int z) {
    return (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y) + (p.z - z) * (p.z - z);
}

// Returns up to 1024 points, one from each of as many consecutive ranges of rows. The position within the range varies
// (by multiples of the golden ratio), so that a regular order of the input does not bias the sample. Removes
// duplicates, because they say nothing about the extent of the set.
std::vector<std::array<double, 3>> sample_of(const Points& points) {
    const Eigen::Index count = std::min<Eigen::Index>(points.rows(), 1024);
    std::vector<std::array<double, 3>> sample;
    for (Eigen::Index i = 0; i < count; ++i) {
        const Eigen::Index begin = points.rows() * i / count, end = points.rows() * (i + 1) / count;
        const std::uint64_t place = (static_cast<std::uint64_t>(i) * golden_step) >> 32;
        const auto row = begin + WATCHED("grid: a sample in no regular order",
                                         static_cast<Eigen::Index>(place % static_cast<std::uint64_t>(end - begin)));
        sample.push_back({points(row, 0), points(row, 1), points(row, 2)});
    }
    std::sort(sample.begin(), sample.end());
    if (WATCHED("grid: copies of a point tell nothing of the extent", true))
        sample.erase(std::unique(sample.begin(), sample.end()), sample.end());
    return sample;
}

// Returns the part of the box that contains most points, without outliers.
//
// Along each axis, let w be the width of the interval between the quantiles 1/16 and 15/16 of a sample of different
// points. If the box is longer than 8 * w, it is cut down to this interval and w on either side, 3 * w in total. If
// there are fewer than 16 different points in the sample, the quantiles are its least and largest coordinates, so that
// one outlier in the sample keeps the box whole. If the part would be a single point, returns the whole box.
Box dense_part(const Points& points, const Box& box) {
    const std::vector<std::array<double, 3>> sample = sample_of(points);
    std::vector<double> along(sample.size());
    Box part = box;
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < sample.size(); ++i) along[i] = sample[i][k];
        const auto cut = static_cast<std::ptrdiff_t>(sample.size() / 16);
        const auto low = along.begin() + cut, high = along.end() - 1 - cut;
        std::nth_element(along.begin(), low, along.end());
        const double least = *low;
        std::nth_element(low, high, along.end());
        const double width = *high - least;
        const auto axis = static_cast<Eigen::Index>(k);
        if (box.high[axis] - box.low[axis] <= 8 * width) continue;
        part.low[axis] = std::max(part.low[axis], least - width);
        part.high[axis] = std::min(part.high[axis], *high + width);
    }
    return part.low == part.high ? box : part;
}

}  // namespace

NearGrid::NearGrid(const Points& points, const Box& box, const Threads& threads) {
    const Box part = dense_part(points, box);
    const bool whole = part.low == box.low && part.high == box.high;
    lay_cells(part, static_cast<double>(std::clamp<Eigen::Index>(points.rows() / 8, 1, Eigen::Index{1} << 16)));
    const std::int32_t* const size = layout_.size;
    candidates_.assign(
        static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]),
        {{0, 0, 0}, -1});
    take_last_of_each(points, whole ? nullptr : &part, threads);
    fill_empty_cells();
}

// Makes the last point in each cell its candidate. A point outside the grid belongs to the nearest cell but may be far
// from it. So it is taken only if the cell contains no point in `inside`, the box of the grid (null: all points are in
// it).
//
// Each thread notes the last row in each cell for a range of the points. The last range with a point in the cell gives
// the candidate, so the result does not depend on the number of threads.
void NearGrid::take_last_of_each(const Points& points, const Box* inside, const Threads& threads) {
    constexpr std::size_t chunk = 1024;
    const auto count = static_cast<std::size_t>(points.rows());
    const std::size_t parts = std::min(static_cast<std::size_t>(threads.most()), blocks_of(count, 16 * chunk));
    struct Last {
        std::vector<Index> any, within;  // for each cell: the last row, and the last row in `inside`; -1: none
    };
    std::vector<Last> last(parts);
    threads.for_each(parts, [&](std::size_t p) {
        const Part mine = part(count, p, parts);
        last[p].any.assign(candidates_.size(), -1);
        if (inside) last[p].within.assign(candidates_.size(), -1);
        std::int32_t cells[chunk];
        for (std::size_t begin = mine.begin; begin < mine.end; begin += chunk) {
            const std::size_t some = std::min(chunk, mine.end - begin);
            cells_of(layout_, points.data() + 3 * begin, some, cells);
            for (std::size_t i = 0; i < some; ++i) {
                const auto cell = static_cast<std::size_t>(cells[i]);
                const auto row = static_cast<Index>(begin + i);
                last[p].any[cell] = row;
                if (!inside) continue;
                const double* const x = points.row(row).data();
                const Vec3 at(x[0], x[1], x[2]);
                if ((at.array() >= inside->low.array()).all() && (at.array() <= inside->high.array()).all())
                    last[p].within[cell] = row;
            }
        }
    });
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
        Index row = -1;
        for (std::size_t p = parts; p-- > 0 && row < 0 && inside;) row = last[p].within[c];
        for (std::size_t p = parts; p-- > 0 && row < 0;) row = last[p].any[c];
        if (row < 0) continue;
        const double* const x = points.row(row).data();
        candidates_[c] = {{x[0], x[1], x[2]}, row};
        ++occupied_;
    }
}

std::size_t NearGrid::squared_to_candidates(const double* points, std::size_t count, double* squared) const {
    static_assert(sizeof(Candidate) == 4 * sizeof(double));
    return squared_to_cells(layout_, candidates_.front().point, points, count, squared);
}

// Chooses the edge of the cubic cells: tries 1/1024 of the longest side of the box, then ever longer edges, until the
// grid has at most `most` cells or the edge is the whole side. A box without extent gets a single cell.
void NearGrid::lay_cells(const Box& box, double most) {
    const Vec3 width = box.high - box.low;
    const double longest = width.maxCoeff();
    for (int k = 0; k < 3; ++k) layout_.low[k] = box.low[k];
    for (int along = longest > 0x1p-900 ? 1024 : 0; along >= 1; along = along * 7 / 8) {
        int size[3];
        double total = 1;
        for (int k = 0; k < 3; ++k) total *= size[k] = 1 + static_cast<int>(along * (width[k] / longest));
        if (total > most && along > 1) continue;
        layout_.cells_per_length = along / longest;
        for (int k = 0; k < 3; ++k) layout_.size[k] = size[k];
        break;
    }
    for (int k = 0; k < 3; ++k) layout_.last[k] = layout_.size[k] - 1;
}

// Gives each empty cell the candidate of an occupied cell nearby, which need not be the nearest one. Each sweep visits
// all cells. An empty cell takes the nearest of the occupied cells that are known to the three neighbours visited
// before it.
void NearGrid::fill_empty_cells() {
    std::vector<Place> places(candidates_.size());
    const std::int32_t(&size_)[3] = layout_.size;
    const auto at = [&](int x, int y, int z) { return static_cast<std::size_t>(x + size_[0] * (y + size_[1] * z)); };
    const auto sweep = [&](bool forward) {
        const int step = forward ? 1 : -1;
        for (int k = 0; k < size_[2]; ++k) {
            const int z = forward ? k : size_[2] - 1 - k;
            for (int j = 0; j < size_[1]; ++j) {
                const int y = forward ? j : size_[1] - 1 - j;
                for (int i = 0; i < size_[0]; ++i) {
                    const int x = forward ? i : size_[0] - 1 - i;
                    Place& here = places[at(x, y, z)];
                    if (candidates_[at(x, y, z)].row >= 0) {
                        here = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                                static_cast<std::int16_t>(z)};
                        continue;
                    }
                    const auto take = [&](int u, int v, int w) {
                        const Place& other = places[at(u, v, w)];
                        if (!other.empty() && (here.empty() || squared(other, x, y, z) < squared(here, x, y, z)))
                            here = other;
                    };
                    if (i > 0) take(x - step, y, z);
                    if (j > 0) take(x, y - step, z);
                    if (k > 0) take(x, y, z - step);
                }
            }
        }
    };
    // The third sweep, forward again, spreads the cells that the backward sweep found.
    sweep(true);
    sweep(false);
    sweep(true);
    Candidate any{};  // only a fallback: the first two sweeps reach every cell
    for (const Candidate& candidate : candidates_) {
        if (candidate.row >= 0) any = candidate;
    }
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
        if (candidates_[c].row < 0)
            candidates_[c] = places[c].empty() ? any : candidates_[at(places[c].x, places[c].y, places[c].z)];
    }
}

Points NearGrid::spread() const {
    Points points(static_cast<Eigen::Index>(occupied_), 3);
    Eigen::Index count = 0;
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
        const double* const p = candidates_[c].point;
        if (cell_of(p) == c && count < points.rows()) points.row(count++) << p[0], p[1], p[2];
    }
    return points.topRows(count);
}

std::size_t NearGrid::mark(const double* point, double radius, std::vector<std::uint8_t>& flags) const {
    // The range need not be widened for rounding. Rounding to nearest is monotone and leaves doubles unchanged. So if
    // point - radius <= x <= point + radius holds exactly and x is a double, it also holds with both ends rounded. And
    // along() is monotone, too.
    const std::int32_t(&size_)[3] = layout_.size;
    int from[3], to[3];
    for (int k = 0; k < 3; ++k) {
        from[k] = layout_.along(point[k] - radius, k);
        to[k] = layout_.along(point[k] + radius, k);
    }
    for (int z = from[2]; z <= to[2]; ++z) {
        for (int y = from[1]; y <= to[1]; ++y) {
            std::uint8_t* row = flags.data() + static_cast<std::size_t>(size_[0] * (y + size_[1] * z));
            std::fill(row + from[0], row + to[0] + 1, std::uint8_t{1});
        }
    }
    return static_cast<std::size_t>(to[0] - from[0] + 1) * static_cast<std::size_t>(to[1] - from[1] + 1) *
           static_cast<std::size_t>(to[2] - from[2] + 1);
}

}  // namespace hausbench::scan
