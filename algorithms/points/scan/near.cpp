#include "algorithms/points/scan/near.h"

#include "algorithms/points/scan/cells.h"
#include "algorithms/points/scan/point_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace hausbench::scan {
namespace {

constexpr std::uint64_t most_a_row = 48;  // points of B compared per row of A, on average, above which a tree is faster

// Step 4 of scan.cpp: returns the rows of B that may be closest to an undecided point of A. They lie in grid cells
// within the distance from that point to a known point of B. Returns nothing if there are so many of these cells that
// this is not worth the time.
std::optional<std::vector<Index>> near_undecided(const Work& work, const std::vector<Undecided>& undecided,
                                                 ScanState& state) {
    std::vector<std::uint8_t> flags(work.grid.cells());
    std::size_t cells = 0;
    for (const Undecided& point : undecided) {
        cells += 8 + work.grid.mark_within(work.a.row(point.row).data(), point.squared, flags);
        if (cells > static_cast<std::size_t>(work.b.rows())) return {};
    }
    state.counters.bound_tests += undecided.size();
    std::vector<Index> near;
    for (Index j = 0; j < work.b.rows(); ++j) {
        if (flags[work.grid.cell_of(work.b.row(j).data())]) near.push_back(j);
    }
    return near;
}

void take(const CellFindings& findings, ScanState& state) {
    state.counters += findings.counters;
    if (findings.farthest.squared > state.farthest.squared) state.farthest = findings.farthest;
}

// Calls search_cells() for the given rows of A (all if null), in rounds of 64 blocks. Each block starts from the
// largest distance known before its round, so the result does not depend on the threads. Appends rows whose search was
// given up to `open`. Returns `converged`, or the reason if it had to stop early.
Status search_blocks(const Work& work, const std::vector<Index>* rows, const PointCells& cells,
                     std::vector<Index>& open, ScanState& state) {
    constexpr std::size_t size = Work::block_rows, at_once = 64;  // blocks between two checks of the clock
    const std::size_t count = rows ? rows->size() : static_cast<std::size_t>(work.a.rows());
    for (std::size_t begin = 0; begin < count; begin += size * at_once) {
        if (const Status stopped = work.stop(state); stopped != Status::converged) return stopped;
        const std::size_t end = std::min(count, begin + size * at_once), blocks = (end - begin + size - 1) / size;
        std::vector<CellFindings> findings(blocks);
        work.threads.for_each(blocks, [&](std::size_t block) {
            const std::size_t from = begin + block * size, to = std::min(end, from + size);
            CellFindings of_block{
                state.farthest, {}, {}};  // a copy of its own: neighbours in a vector share cache lines
            if (rows)
                search_cells(cells, work.grid, work.a, std::span(*rows).subspan(from, to - from), work.b, of_block);
            else
                search_cells(cells, work.grid, work.a, static_cast<Index>(from), static_cast<Index>(to), work.b,
                             of_block);
            findings[block] = std::move(of_block);
        });
        for (const CellFindings& of_block : findings) {
            take(of_block, state);
            open.insert(open.end(), of_block.open.begin(), of_block.open.end());
        }
    }
    return Status::converged;
}

// Step 5 of scan.cpp: puts the rows `near` of B (all if null) into small cells, and searches them for the given rows of
// A (all if null). Appends rows whose search was given up to `open`. Returns nothing if a tree would be faster,
// according to a sample; all rows are then still to be searched.
std::optional<Status> search_in_cells(const Work& work, const std::vector<Index>* rows, const std::vector<Index>* near,
                                      std::vector<Index>& open, ScanState& state) {
    // Chooses the edge of the cells. An occupied cell of the grid contains `crowd` points on average. If the points lie
    // on a surface, a cell whose edge is shorter by a factor of sqrt(crowd / 2) contains about two. A longer edge is
    // used if the largest distance d so far allows it: with the edge d / 1.75, a cell has the diagonal (sqrt(3) / 1.75)
    // d < d, so any point of B in the cell of a point of A is within d of it.
    const double crowd = static_cast<double>(work.b.rows()) / static_cast<double>(work.grid.occupied());
    const double finer = std::sqrt(std::max(crowd / 2, 1.0));
    const double wide_enough = 1.75 / distance_at_most(std::max(state.farthest.squared, 0.0), true);
    const double cells_per_length = std::min(work.grid.cells_per_length() * finer, wide_enough);
    const PointCells cells(work.b, near, work.target_box, cells_per_length, work.threads);
    // Searches for a sample of the rows first. It raises the largest distance early, so that one cell is enough for
    // most other rows.
    const std::vector<Index> some = sample_of(work.a, rows);
    CellFindings first{state.farthest, {}, {}};
    search_cells(cells, work.grid, work.a, some, work.b, first);
    take(first, state);
    // A tree is faster if the search was given up for many rows of the sample, or if it compared many points of B per
    // row because some cells are crowded.
    if (first.open.size() > some.size() / 4) return std::nullopt;
    if (first.counters.point_distances > most_a_row * some.size()) return std::nullopt;
    return search_blocks(work, rows, cells, open, state);
}

// Compares the given rows of A (all if null) with the rows `near` of B (all if null), pair by pair. Goes on to the next
// row of A as soon as a point of B is within the largest distance so far. Builds no structure, so it is fastest for few
// pairs.
Status compare(const Work& work, const std::vector<Index>* rows, const std::vector<Index>* near, ScanState& state) {
    const Points &a = work.a, &b = work.b;
    const auto count = near ? static_cast<Index>(near->size()) : static_cast<Index>(b.rows());
    const auto those = rows ? static_cast<Index>(rows->size()) : static_cast<Index>(a.rows());
    for (Index r = 0; r < those; ++r) {
        const Index i = rows ? (*rows)[static_cast<std::size_t>(r)] : r;
        if (const Status stopped = work.stop(state); stopped != Status::converged) return stopped;
        FarthestPoint nearest{std::numeric_limits<double>::infinity(), i, -1};
        ++state.counters.closest_point_queries;
        for (Index n = 0; n < count && nearest.squared > state.farthest.squared; ++n) {
            const Index j = near ? (*near)[static_cast<std::size_t>(n)] : n;
            const double squared = squared_distance(a.row(i).data(), b.row(j).data());
            ++state.counters.point_distances;
            if (squared < nearest.squared) {
                nearest.squared = squared;
                nearest.target = j;
            }
        }
        if (nearest.squared > state.farthest.squared) state.farthest = nearest;
    }
    return Status::converged;
}

// Step 6 of scan.cpp: finds the nearest point of B for each point in the given leaves of A.
Status search(const Work& work, std::span<const PointLeaf> leaves, const PointBlocks& blocks, ScanState& state) {
    constexpr std::size_t chunk = 64;  // leaves between two checks of the clock
    if (leaves.size() > chunk) search_samples(blocks, leaves, state);
    for (std::size_t begin = 0; begin < leaves.size(); begin += chunk) {
        if (const Status stopped = work.stop(state); stopped != Status::converged) return stopped;
        search_leaves(blocks, leaves.subspan(begin, std::min(chunk, leaves.size() - begin)), state);
    }
    return Status::converged;
}

// Finds the largest distance from the given rows of A (all if null) to B. Their closest points must be among the rows
// `near` of B (all if null). Uses small cells if there are at least `cells_from` pairs of these rows. For the rows that
// remain, uses a tree if there are at least `tree_from` pairs, and plain comparisons otherwise.
Status search_near(const Work& work, const std::vector<Index>* rows, const std::vector<Index>* near, ScanState& state) {
    if (const Status stopped = work.stop(state); stopped != Status::converged) return stopped;
    const auto count = static_cast<double>(near ? near->size() : static_cast<std::size_t>(work.b.rows()));
    const auto pairs = [&] {
        return count * static_cast<double>(rows ? rows->size() : static_cast<std::size_t>(work.a.rows()));
    };
    std::vector<Index> open;
    if (work.grid.cells_per_length() > 0 && pairs() >= work.cells_from) {
        const std::optional<Status> stopped = search_in_cells(work, rows, near, open, state);
        if (stopped && (*stopped != Status::converged || open.empty())) return *stopped;
        if (stopped) rows = &open;
    }
    if (pairs() < work.tree_from) return compare(work, rows, near, state);
    const PointBlocks blocks(work.b, near, work.target_box);
    return search(work, leaves_of(work.a, rows, blocks.frame), blocks, state);
}

}  // namespace

Status Work::stop(const ScanState& state) const {
    if (state.counters.closest_point_queries >= query.budget) return Status::budget;
    if (distance_at_least(std::max(state.farthest.squared, 0.0), true) > query.cutoff) return Status::above_cutoff;
    return deadline.passed() ? Status::time_limit : Status::converged;
}

std::vector<Index> sample_of(const Points& a, const std::vector<Index>* rows) {
    const std::size_t all = rows ? rows->size() : static_cast<std::size_t>(a.rows());
    std::vector<Index> some(std::min<std::size_t>(all, 1024));
    for (std::size_t i = 0; i < some.size(); ++i) {
        const std::size_t at = part(all, i, some.size()).begin;
        some[i] = rows ? (*rows)[at] : static_cast<Index>(at);
    }
    return some;
}

Status search_all(const Work& work, ScanState& state) { return search_near(work, nullptr, nullptr, state); }

Status search_undecided(const Work& work, const std::vector<Undecided>& undecided, ScanState& state) {
    if (undecided.empty()) return Status::converged;
    std::vector<Index> rows;
    for (const Undecided& point : undecided) rows.push_back(point.row);
    std::sort(rows.begin(), rows.end());
    const std::optional<std::vector<Index>> near = near_undecided(work, undecided, state);
    return search_near(work, &rows, near ? &*near : nullptr, state);
}

}  // namespace hausbench::scan
