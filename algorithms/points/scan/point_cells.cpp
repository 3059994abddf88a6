#include "algorithms/points/scan/point_cells.h"

#include <algorithm>
#include <bit>

namespace hausbench::scan {

// Chooses the size of the table. Along each axis, starts with a power of two that exceeds the number of cells in the
// box. Then halves the axis with the most entries until the table has fewer than four entries per point.
void PointCells::lay_table(std::size_t count, const Box& box) {
    const int most = std::bit_width(2 * count - 1);
    int bits[3];
    for (int k = 0; k < 3; ++k) {
        const double cells = std::min((box.high[k] - box.low[k]) * cells_per_length_, 0x1p29);
        bits[k] = std::bit_width(static_cast<std::uint32_t>(cells));
    }
    while (bits[0] + bits[1] + bits[2] > most) --*std::max_element(bits, bits + 3);
    for (int k = 0; k < 3; ++k) masks_[k] = (std::uint32_t{1} << bits[k]) - 1;
    shift_y_ = bits[0];
    shift_z_ = bits[0] + bits[1];
    first_.assign(std::size_t{1} << (bits[0] + bits[1] + bits[2]), -1);
}

PointCells::PointCells(const Points& points, const std::vector<Index>* chosen, const Box& box, double cells_per_length,
                       const Threads& threads)
    : low_{box.low[0], box.low[1], box.low[2]},
      cells_per_length_(cells_per_length),
      next_(std::make_unique_for_overwrite<Index[]>(static_cast<std::size_t>(points.rows()))) {
    const std::size_t count = chosen ? chosen->size() : static_cast<std::size_t>(points.rows());
    const auto row_of = [&](std::size_t i) { return chosen ? (*chosen)[i] : static_cast<Index>(i); };
    const auto place_of = [&](Index row) { return place(cell_of(points.row(row).data())); };
    const auto add = [&](Index row, std::size_t place) {
        next_[static_cast<std::size_t>(row)] = first_[place];
        first_[place] = row;
    };
    lay_table(count, box);
    const auto parts = static_cast<std::size_t>(threads.most());
    if (parts == 1) {
        for (std::size_t i = 0; i < count; ++i) add(row_of(i), place_of(row_of(i)));
        return;
    }
    // First computes the table entry of each point. Then each thread fills its own part of the table: it goes through
    // all points in order and adds those whose entry is in this part.
    const auto places = std::make_unique_for_overwrite<std::uint32_t[]>(count);
    const std::size_t blocks = blocks_of(count, 1 << 13);
    threads.for_each(blocks, [&](std::size_t block) {
        const Part mine = part(count, block, blocks);
        for (std::size_t i = mine.begin; i < mine.end; ++i) places[i] = static_cast<std::uint32_t>(place_of(row_of(i)));
    });
    threads.for_each(parts, [&](std::size_t p) {
        const Part mine = part(first_.size(), p, parts);
        for (std::size_t i = 0; i < count; ++i) {
            if (places[i] - mine.begin < mine.size()) add(row_of(i), places[i]);
        }
    });
}

}  // namespace hausbench::scan
