#include "algorithms/structures/quantised_boxes.h"

#include <algorithm>
#include <bit>

namespace hausbench {

// Let d be the exact x - origin >= 0 and r the rounded one. q step is a double for every q here, and rounding is
// monotone: r < q step implies d < q step, and r > q step implies d > q step. So the largest q with q step <= r has
// (q - 1) step < d < (q + 1) step. If a sum is at most (at least) a double, so is the rounded sum. Hence plane(q)
// is on the right side of x or, if not, plane(q - 1) is for a lower and plane(q + 1) for an upper coordinate. In
// real numbers: a lower q has q step <= r, an upper one has r <= q step, and |r - d| <= u r < 2^-45 step.
//
// No q exceeds 255: `step` is a power of two above the rounded quotient of the longest rounded extent by 255. If
// 255 step were not more than the rounded extent, the quotient would be at least `step`, because rounding is
// monotone. If the product with the inverse underflows, the largest q is 0, as it should be.
Box QuantisedBoxes::set(std::span<const Box> boxes) {
    Box whole = boxes.front();
    for (const Box& box : boxes.subspan(1)) whole.add(box);
    const double least_step = std::max((whole.high - whole.low).maxCoeff() / 255, 0x1p-441);
    const std::uint64_t exponent = (std::bit_cast<std::uint64_t>(least_step) >> 52) + 1;  // biased by 1023
    step = std::bit_cast<double>(exponent << 52);
    inverse = std::bit_cast<double>((2046 - exponent) << 52);
    for (int k = 0; k < 3; ++k) {
        origin[k] = whole.low[k];
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const double lower = boxes[i].low[k], upper = boxes[i].high[k], extent = upper - origin[k];
            const int steps = static_cast<int>((lower - origin[k]) * inverse);
            low(k, i) = static_cast<std::uint8_t>(steps - (origin[k] + steps * step > lower ? 1 : 0));
            const int upper_steps = static_cast<int>(extent * inverse);
            const bool inside = upper_steps * step < extent || origin[k] + upper_steps * step < upper;
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
