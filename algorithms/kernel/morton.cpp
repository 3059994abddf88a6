#include "algorithms/kernel/morton.h"

#include "algorithms/kernel/pages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

namespace hausbench {
namespace {

constexpr int bits = 10;  // bits of a Morton key per coordinate
constexpr double cells = 1 << bits;
constexpr std::size_t few = 32;  // up to this many points with equal keys are not sorted further

// Inserts two zero bits before each of the ten bits of x, so that three coordinates can be interleaved.
std::uint32_t spread(std::uint32_t x) {
    x = (x | (x << 16)) & 0x030000ff;
    x = (x | (x << 8)) & 0x0300f00f;
    x = (x | (x << 4)) & 0x030c30c3;
    return (x | (x << 2)) & 0x09249249;
}

// One step down the Hilbert curve, from a cube into one of its octants. The curve visits the eight octants in an order
// that depends on the corner `entry` where it enters the cube, and on the axis `along` of the edge from there to its
// exit. These two are the state, 3 * entry + along. Each state and octant has a step, with the number of the octant in
// this order (an octal digit of the position on the curve) and the state for the octant.
struct HilbertStep {
    std::uint8_t digits, state;
};

constexpr std::array<std::array<HilbertStep, 8>, 24> hilbert_single_steps() {
    std::array<std::array<HilbertStep, 8>, 24> steps{};
    const auto turned_left = [](unsigned x, unsigned by) { return (x << by | x >> (3 - by)) & 7; };
    const auto gray = [](unsigned i) { return i ^ i >> 1; };
    for (unsigned entry = 0; entry < 8; ++entry) {
        for (unsigned along = 0; along < 3; ++along) {
            const unsigned turn = (along + 1) % 3;
            for (unsigned digit = 0; digit < 8; ++digit) {
                const unsigned octant = turned_left(gray(digit), turn) ^ entry;
                const unsigned next_entry = digit == 0 ? 0 : gray((digit - 1) / 2 * 2);
                const auto ones =
                    static_cast<unsigned>(std::countr_one(digit % 2 == 0 && digit > 0 ? digit - 1 : digit));
                const unsigned next_along = (along + (digit == 0 ? 0 : ones % 3) + 1) % 3;
                steps[3 * entry + along][octant] = {
                    static_cast<std::uint8_t>(digit),
                    static_cast<std::uint8_t>(3 * (entry ^ turned_left(next_entry, turn)) + next_along)};
            }
        }
    }
    return steps;
}

// Returns a table for two steps down the Hilbert curve at once, indexed by the state and two octants (six bits of a
// Morton key).
constexpr std::array<std::array<HilbertStep, 64>, 24> hilbert_double_steps() {
    constexpr auto single = hilbert_single_steps();
    std::array<std::array<HilbertStep, 64>, 24> steps{};
    for (std::size_t state = 0; state < 24; ++state) {
        for (std::size_t octants = 0; octants < 64; ++octants) {
            const HilbertStep first = single[state][octants >> 3], second = single[first.state][octants & 7];
            steps[state][octants] = {static_cast<std::uint8_t>(first.digits << 3 | second.digits), second.state};
        }
    }
    return steps;
}

// The key of a point in the upper 32 bits and its row in the lower 32 bits, so that points can be sorted as plain
// integers.
using Item = std::uint64_t;
Item item_of(std::uint32_t key, Index row) { return (Item{key} << 32) | static_cast<std::uint32_t>(row); }
Index row_of(Item item) { return static_cast<Index>(item & 0xffffffff); }
std::uint32_t key_of(Item item) { return static_cast<std::uint32_t>(item >> 32); }

constexpr std::size_t digits = 3, values = 1 << bits;  // a key is this many digits of a radix sort, each below `values`
using Counts = std::array<std::uint32_t, values>;

std::size_t digit_of(Item item, std::size_t k) { return (item >> (32 + bits * k)) & (values - 1); }

// Sorts items by digit k into `to`, in parallel. Items with the same digit keep their order.
void sort_by_digit(std::span<const Item> from, std::span<Item> to, std::size_t k, std::vector<Counts>& counts,
                   const Threads& threads) {
    const auto each_block = [&](const auto& use) {
        threads.for_each(counts.size(), [&](std::size_t block) {
            const Part mine = part(from.size(), block, counts.size());
            for (std::size_t i = mine.begin; i < mine.end; ++i) use(block, from[i]);
        });
    };
    for (Counts& count : counts) count.fill(0);
    each_block([&](std::size_t block, Item item) { ++counts[block][digit_of(item, k)]; });
    std::uint32_t sum = 0;
    for (std::size_t value = 0; value < values; ++value)
        for (Counts& count : counts) sum += std::exchange(count[value], sum);
    each_block([&](std::size_t block, Item item) { to[counts[block][digit_of(item, k)]++] = item; });
}

// Sorts items by key. If the input is ordered by row, items with equal keys stay in this order. `room` is a scratch
// buffer.
void sort_items(std::span<Item> items, std::vector<Item>& room, const Threads& threads = Threads()) {
    if (items.size() < 1024) {
        std::sort(items.begin(), items.end());
        return;
    }
    if (room.size() < items.size()) room = filled<Item>(items.size());
    std::span<Item> from = items, to(room.data(), items.size());
    if (const std::size_t blocks = blocks_of(items.size(), 8192); threads.most() > 1 && blocks > 1) {
        std::vector<Counts> counts(blocks);
        for (std::size_t k = 0; k < digits; ++k) {
            sort_by_digit(from, to, k, counts, threads);
            std::swap(from, to);
        }
    } else {  // one thread counts all digits at once
        std::array<Counts, digits> counts{};
        for (const Item item : items)
            for (std::size_t k = 0; k < digits; ++k) ++counts[k][digit_of(item, k)];
        for (std::size_t k = 0; k < digits; ++k) {
            std::uint32_t sum = 0;
            for (std::uint32_t& count : counts[k]) sum += std::exchange(count, sum);
            for (const Item item : from) to[counts[k][digit_of(item, k)]++] = item;
            std::swap(from, to);
        }
    }
    std::copy(from.begin(), from.end(), to.begin());  // an odd number of passes leaves the result in the other buffer
}

enum class Curve { morton, hilbert };

template <Curve curve> std::uint32_t key_along(const MortonFrame& frame, const double* point) {
    const std::uint32_t key = frame.key(point);
    return curve == Curve::hilbert ? hilbert_key(key) : key;
}

// Sorts items with equal keys further: each run of more than `few` of them is sorted by the keys of a smaller frame,
// and so on, recursively. Stops at a run that the smaller frame does not split, because all its points are equal or
// because of rounding. All items keep their keys in `outer`.
template <Curve curve>
void refine_runs(const Points& points, std::span<Item> items, const MortonFrame& outer, std::vector<Item>& room) {
    for (std::size_t begin = 0; begin < items.size();) {
        std::size_t end = begin + 1;
        while (end < items.size() && key_of(items[end]) == key_of(items[begin])) ++end;
        if (end - begin > few) {
            Box box;
            for (std::size_t i = begin; i < end; ++i) box.add(Vec3(points.row(row_of(items[i]))));
            if (box.low != box.high) {
                const MortonFrame frame = outer.inside(box);
                std::vector<Item> run(end - begin);
                for (std::size_t i = begin; i < end; ++i) {
                    const Index row = row_of(items[i]);
                    run[i - begin] = item_of(key_along<curve>(frame, points.row(row).data()), row);
                }
                sort_items(run, room);
                if (key_of(run.front()) != key_of(run.back())) refine_runs<curve>(points, run, frame, room);
                const std::uint32_t key = key_of(items[begin]);
                for (std::size_t i = begin; i < end; ++i) items[i] = item_of(key, row_of(run[i - begin]));
            }
        }
        begin = end;
    }
}

}  // namespace

MortonFrame::MortonFrame(const Box& box) : MortonFrame(box.low, (box.high - box.low).maxCoeff()) {}

MortonFrame::MortonFrame(const Vec3& low, double width) : low_(low), width_(width) {
    if (width > 0x1p-900) cells_per_length_ = cells / width;  // otherwise it stays 0, and all points are in cell 0
}

std::uint32_t MortonFrame::key(const double* point) const {
    std::uint32_t key = 0;
    for (int k = 0; k < 3; ++k) {
        const double cell = std::min(std::max((point[k] - low_[k]) * cells_per_length_, 0.0), cells - 1);
        key |= spread(static_cast<std::uint32_t>(static_cast<std::int32_t>(cell))) << (2 - k);
    }
    return key;
}

// Returns the position of x along an axis of the cube as a 52-bit integer. Its highest bit says in which half of the
// cube x lies, the next bit in which half of that half, and so on.
std::uint64_t MortonFrame::halvings_of(double x, int axis) const {
    constexpr double places = 0x1p52;
    const double part = (x - low_[axis]) * cells_per_length_ * (places / cells);
    return static_cast<std::uint64_t>(std::min(std::max(part, 0.0), places - 1));
}

bool MortonFrame::before(const double* first, const double* second) const {
    // The first halving that separates the points decides their order. If it separates them along several axes, x
    // decides before y, and y before z.
    std::uint64_t highest = 0;  // the bits that differ along the deciding axis
    bool less = false;
    for (int k = 0; k < 3; ++k) {
        const std::uint64_t a = halvings_of(first[k], k), b = halvings_of(second[k], k), differ = a ^ b;
        if (std::bit_width(differ) > std::bit_width(highest)) {
            highest = differ;
            less = a < b;
        }
    }
    return less;
}

MortonFrame MortonFrame::inside(const Box& box) const {
    std::uint64_t first[3], differ = 0;
    for (int k = 0; k < 3; ++k) {
        first[k] = halvings_of(box.low[k], k);
        differ |= first[k] ^ halvings_of(box.high[k], k);
    }
    const int halvings = std::max(52 - static_cast<int>(std::bit_width(differ)), bits);
    const double width = std::ldexp(width_, -halvings);
    if (differ == 0 || !(width > 0x1p-900)) return MortonFrame(box);
    Vec3 low;
    for (int k = 0; k < 3; ++k) low[k] = low_[k] + width * static_cast<double>(first[k] >> (52 - halvings));
    return {low, width};
}

std::uint32_t hilbert_key(std::uint32_t morton_key) {
    static constexpr auto steps = hilbert_double_steps();
    std::uint32_t key = 0;
    std::size_t state = 0;
    for (int shift = 3 * bits - 6; shift >= 0; shift -= 6) {
        const HilbertStep step = steps[state][morton_key >> shift & 63];
        key = key << 6 | step.digits;
        state = step.state;
    }
    return key;
}

namespace {

template <Curve curve>
std::vector<Index> order_along(const Points& points, const std::vector<Index>* chosen, const MortonFrame& frame,
                               const Threads& threads) {
    const std::size_t count = chosen ? chosen->size() : static_cast<std::size_t>(points.rows());
    auto items = filled<Item>(count);
    std::vector<Item> room;
    const std::size_t blocks = blocks_of(count, 4096);
    threads.for_each(blocks, [&](std::size_t block) {
        const Part mine = part(count, block, blocks);
        for (std::size_t i = mine.begin; i < mine.end; ++i) {
            const Index row = chosen ? (*chosen)[i] : static_cast<Index>(i);
            items[i] = item_of(key_along<curve>(frame, points.row(row).data()), row);
        }
    });
    sort_items(items, room, threads);
    refine_runs<curve>(points, items, frame, room);
    auto order = filled<Index>(count);
    for (std::size_t i = 0; i < count; ++i) order[i] = row_of(items[i]);
    return order;
}

}  // namespace

std::vector<Index> morton_order(const Points& points, const std::vector<Index>* chosen, const MortonFrame& frame) {
    return order_along<Curve::morton>(points, chosen, frame, Threads());
}

std::vector<Index> hilbert_order(const Points& points, const MortonFrame& frame, const Threads& threads) {
    return order_along<Curve::hilbert>(points, nullptr, frame, threads);
}

}  // namespace hausbench
