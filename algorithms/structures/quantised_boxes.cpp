#include "algorithms/structures/quantised_boxes.h"

#include "algorithms/kernel/watched.h"

#include <algorithm>
#include <bit>

namespace hausbench {

// Proof that set() keeps its promise. Let x be a coordinate of a box, d = x - origin >= 0 its exact distance from the
// origin, r = fl(d) the rounded one, and u = 2^-53.
//
// Computed planes. Let q be the largest integer with q * step <= r. Products of step and small integers are doubles,
// and rounding is monotone, so r < (q + 1) * step implies d < (q + 1) * step, and r > (q - 1) * step implies
// d > (q - 1) * step. If an exact sum is at most (at least) some double, so is the rounded sum: hence
// plane(q - 1) <= x <= plane(q + 1). The lower plane is plane(q), or plane(q - 1) if plane(q) > x. The upper plane is
// plane(q), or plane(q + 1) if q * step < r or plane(q) < x.
//
// Real numbers. The byte p of a lower plane has p * step <= r, and the byte p of an upper plane has p * step >= r. The
// rounding error is |r - d| <= u * r < 2^-45 * step, because r < 255 * step.
//
// No byte exceeds 255. Let E be the longest extent, as rounded. `step` is a power of two greater than fl(E / 255).
// Suppose that 255 * step <= E. Then E / 255 >= step and, because rounding is monotone, fl(E / 255) >= step: a
// contradiction. So r <= E < 255 * step, and q + 1 <= 255.
//
// The code computes q as the integer part of r * inverse. This product is exact unless it underflows; then q is 0, as
// it should be.
Box QuantisedBoxes::set(std::span<const Box> boxes) {
    Box whole = boxes.front();
    for (const Box& box : boxes.subspan(1)) whole.add(box);
    const double least_step = std::max(
        (whole.high - whole.low).maxCoeff() / WATCHED_ELSE("tree boxes: 255 steps hold the extent", 255, 255.0000001),
        WATCHED("tree boxes: steps do not underflow", 0x1p-441));
    const std::uint64_t exponent = (std::bit_cast<std::uint64_t>(least_step) >> 52) + 1;  // biased by 1023
    step = std::bit_cast<double>(exponent << 52);
    inverse = std::bit_cast<double>((2046 - exponent) << 52);
    for (int k = 0; k < 3; ++k) {
        origin[k] = whole.low[k];
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const double lower = boxes[i].low[k], upper = boxes[i].high[k], extent = upper - origin[k];
            const int steps = static_cast<int>((lower - origin[k]) * inverse);
            low(k, i) = static_cast<std::uint8_t>(
                steps - WATCHED("tree boxes: a lower plane one step back where rounding put it inside",
                                origin[k] + steps * step > lower ? 1 : 0));
            const int upper_steps = static_cast<int>(extent * inverse);
            const bool inside = WATCHED_ELSE(
                "tree boxes: an upper plane is compared in full",
                WATCHED("tree boxes: an upper plane is no less before it is rounded", upper_steps * step < extent) ||
                    WATCHED("tree boxes: an upper plane is rounded up", origin[k] + upper_steps * step < upper),
                upper_steps < extent * inverse);
            high(k, i) = static_cast<std::uint8_t>(upper_steps + (inside ? 1 : 0));
        }
        for (std::size_t i = boxes.size(); i < tree_width; ++i) {
            low(k, i) = low(k, 0);
            high(k, i) = high(k, 0);
        }
    }
    return whole;
}

}  // namespace hausbench
