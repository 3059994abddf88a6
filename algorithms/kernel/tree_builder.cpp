#include "tree_builder.h"

#include <algorithm>
#include <cmath>

namespace hausbench::builder {
namespace {

constexpr float least_spread = 0x1p-12F;  // of the centres, in a frame of size 1: 2^12 different places are left

Vec3 middle_of(const Box& box) { return 0.5 * box.low + 0.5 * box.high; }

}  // namespace

LocalFrame LocalFrame::of(const Box& box) {
    LocalFrame frame;
    frame.centre = middle_of(box);
    const double extent = (box.high - box.low).maxCoeff();
    if (extent > 0) frame.scale = std::ldexp(1.0, std::clamp(-std::ilogb(extent), -1000, 1000));
    return frame;
}

Builder::Builder(const TreeContent& what) : content(what) {
    Box box;
    for (Eigen::Index i = 0; i < content.points.rows(); ++i) box.add(Vec3(content.points.row(i)));
    const LocalFrame frame = LocalFrame::of(box);
    std::vector<FloatBox> points(static_cast<std::size_t>(content.points.rows()));
    for (Index i = 0; i < content.points.rows(); ++i) {
        FloatBox& point = points[static_cast<std::size_t>(i)];
        point.low = point.high = frame.local(content.points.row(i));
    }
    if (content.triangles == nullptr) {
        elements = std::move(points);
    } else {
        elements.reserve(static_cast<std::size_t>(content.count()));
        for (Index i = 0; i < content.count(); ++i) {
            FloatBox& element = elements.emplace_back();
            for (const Index corner : content.triangles->row(i)) {
                element.add(points[static_cast<std::size_t>(corner)].low);
            }
        }
    }
    for (std::size_t i = 0; i < elements.size(); ++i) set_number(elements[i], static_cast<Index>(i));
    tree.order.reserve(elements.size());
    tree.leaf_begin.push_back(0);
}

void Builder::localise(Range& whole) {
    if (whole.spread() >= least_spread) return;
    Box centres;
    for (std::int32_t i = whole.begin; i < whole.end; ++i) {
        centres.add(middle_of(content.box(number_of(elements[static_cast<std::size_t>(i)]))));
    }
    const LocalFrame frame = LocalFrame::of(centres);
    for (std::int32_t i = whole.begin; i < whole.end; ++i) {
        FloatBox& element = elements[static_cast<std::size_t>(i)];
        const Index number = number_of(element);
        const Box box = content.box(number);
        element.low = frame.local(box.low);
        element.high = frame.local(box.high);
        set_number(element, number);
    }
    whole = range(whole.begin, whole.end);
}

}  // namespace hausbench::builder
