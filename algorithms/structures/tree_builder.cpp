#include "algorithms/structures/tree_builder.h"

#include "algorithms/kernel/pages.h"
#include "algorithms/kernel/triangle.h"

#include <algorithm>
#include <cmath>

namespace hausbench::builder {
namespace {

// If the centres of a range spread over less than this, localise() makes its coordinates finer: floats just below 1 are
// 2^-24 apart, so only 2^12 different coordinates are left within 2^-12.
constexpr float least_spread = 0x1p-12F;

Vec3 middle_of(const Box& box) { return 0.5 * box.low + 0.5 * box.high; }

}  // namespace

LocalFrame LocalFrame::of(const Box& box) {
    LocalFrame frame;
    frame.centre = middle_of(box);
    const double extent = (box.high - box.low).maxCoeff();
    if (extent > 0) frame.scale = std::ldexp(1.0, std::clamp(-std::ilogb(extent), -1000, 1000));
    return frame;
}

Builder::Builder(const TriangleMesh& over) : mesh(over) {
    Box box;
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) box.add(Vec3(mesh.vertices.row(i)));
    const LocalFrame frame = LocalFrame::of(box);
    auto points = filled<FloatBox>(static_cast<std::size_t>(mesh.vertices.rows()));
    for (Index i = 0; i < mesh.vertices.rows(); ++i) {
        FloatBox& point = points[static_cast<std::size_t>(i)];
        point.low = point.high = frame.local(mesh.vertices.row(i));
    }
    const auto count = static_cast<Index>(mesh.triangles.rows());
    reserve_touched(elements, static_cast<std::size_t>(count));
    for (Index i = 0; i < count; ++i) {
        FloatBox& element = elements.emplace_back();
        for (const Index corner : mesh.triangles.row(i)) element.add(points[static_cast<std::size_t>(corner)].low);
    }
    for (std::size_t i = 0; i < elements.size(); ++i) set_number(elements[i], static_cast<Index>(i));
    reserve_touched(tree.order, elements.size());
    tree.leaf_begin.push_back(0);
}

void Builder::localise(Range& whole) {
    if (whole.spread() >= least_spread) return;
    Box centres;
    for (std::int32_t i = whole.begin; i < whole.end; ++i) {
        centres.add(middle_of(box_of(triangle_of(mesh, number_of(elements[static_cast<std::size_t>(i)])))));
    }
    const LocalFrame frame = LocalFrame::of(centres);
    for (std::int32_t i = whole.begin; i < whole.end; ++i) {
        FloatBox& element = elements[static_cast<std::size_t>(i)];
        const Index number = number_of(element);
        const Box box = box_of(triangle_of(mesh, number));
        element.low = frame.local(box.low);
        element.high = frame.local(box.high);
        set_number(element, number);
    }
    whole = range(whole.begin, whole.end);
}

// Counts for each element how many others have a smaller centre. Elements with a count below middle - begin go to the
// left. Comparing all pairs avoids unpredictable branches.
void Builder::put_in_order(const Range& range, std::int32_t middle) {
    using Int4 [[gnu::vector_size(16)]] = std::int32_t;
    constexpr std::int32_t most = tree_width * leaf_capacity;
    const Float4 extent = range.centres.high - range.centres.low;
    int axis = 0;
    for (int k = 1; k < 3; ++k) axis = extent[k] > extent[axis] ? k : axis;

    // Keys are integers that have the same order as the coordinates. Their last six bits hold the index of the element
    // within the range, so that no two keys are equal.
    std::array<Int4, most / 4> keys;
    FloatBox* const first = elements.data() + range.begin;
    const std::int32_t size = range.size(), fours = (size + 3) / 4;
    const auto key = [&](std::int32_t i) -> auto& { return keys[static_cast<std::size_t>(i / 4)]; };
    key(size - 1) = Int4{} + std::numeric_limits<std::int32_t>::max();
    for (std::int32_t i = 0; i < size; ++i) {
        const Float4 centre = centre_of(first[i]);
        const auto bits = std::bit_cast<std::int32_t>(static_cast<float>(centre[axis]));
        key(i)[i % 4] = ((bits ^ (bits >> 31 & 0x7fffffff)) & ~(most - 1)) | i;
    }
    std::int32_t left = 0, right = 0;
    for (std::int32_t i = 0; i < size; ++i) {
        Int4 less{};  // minus the number of smaller keys, because a comparison that is true gives -1
        const Int4 mine = Int4{} + key(i)[i % 4];
        for (std::int32_t j = 0; j < fours; ++j) less += keys[static_cast<std::size_t>(j)] < mine;
        const bool is_left = -(less[0] + less[1] + less[2] + less[3]) < middle - range.begin;
        const FloatBox element = first[i];
        first[left] = element;
        scratch[static_cast<std::size_t>(right)] = element;
        left += is_left ? 1 : 0;
        right += is_left ? 0 : 1;
    }
    std::copy_n(scratch.begin(), right, first + left);
}

}  // namespace hausbench::builder
