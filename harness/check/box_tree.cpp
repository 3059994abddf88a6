#include "harness/check/box_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace hausbench {
namespace {

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 edge = b - a;
    const double length = edge.squaredNorm();
    const double t = length > 0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0.0;
    return std::min({(p - a - t * edge).norm(), (p - a).norm(), (p - b).norm()});
}

// Length of the longest edge of a triangle, and its height over that edge.
std::pair<double, double> length_and_height(const Element& e) {
    const Vec3 x = e[1] - e[0], y = e[2] - e[0];
    const double longest = std::sqrt(std::max({x.squaredNorm(), y.squaredNorm(), (y - x).squaredNorm()}));
    return {longest, longest > 0 ? x.cross(y).norm() / longest : 0};
}

bool is_sliver(double length, double height) { return height * height < 0x1p-50 * length * length; }
double sliver_error(const Element& e) {
    if (e.size() == 1) return 0;
    const auto [length, height] = length_and_height(e);
    return is_sliver(length, height) ? height : 0x1p-50 * length * length / height;
}

}  // namespace

// Returns the distance of p to a point, or to a triangle: to its edges or, if the foot on its plane is inside, to that.
double distance_to(const Vec3& p, const Element& e) {
    if (e.size() == 1) return (p - e[0]).norm();
    double least = std::min(
        {distance_to_segment(p, e[0], e[1]), distance_to_segment(p, e[1], e[2]), distance_to_segment(p, e[2], e[0])});
    const Vec3 x = e[1] - e[0], y = e[2] - e[0], q = p - e[0], normal = x.cross(y);
    const double area = normal.squaredNorm();
    const auto [length, height] = length_and_height(e);
    if (!is_sliver(length, height)) {
        const double s = q.cross(y).dot(normal) / area, t = x.cross(q).dot(normal) / area;
        if (s >= 0 && t >= 0 && s + t <= 1) least = std::min(least, (q - s * x - t * y).norm());
    }
    return least;
}

BoxTree::BoxTree(const Standing& shape) : order_(std::size_t(shape.count())) {
    std::iota(order_.begin(), order_.end(), Index(0));
    for (Index i = 0; i < shape.count(); ++i) {
        elements_.push_back(shape[i]);
        error_of_slivers_ = std::max(error_of_slivers_, sliver_error(elements_.back()));
    }
    build(0, order_.size());
}

std::pair<Index, double> BoxTree::nearest(const Vec3& p) const {
    std::pair<Index, double> best{-1, std::numeric_limits<double>::infinity()};
    search(0, p, best);
    return best;
}

std::size_t BoxTree::build(std::size_t begin, std::size_t end) {
    Node node{Vec3::Constant(std::numeric_limits<double>::infinity()),
              Vec3::Constant(-std::numeric_limits<double>::infinity()), begin, end, 0};
    for (std::size_t i = begin; i < end; ++i) {
        for (const Vec3& v : element(order_[i])) {
            node.low = node.low.cwiseMin(v);
            node.high = node.high.cwiseMax(v);
        }
    }
    const std::size_t at = nodes_.size();
    nodes_.push_back(node);
    if (end - begin <= 4) return at;
    int axis = 0;
    (node.high - node.low).maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto place = [&](Index i) {
        double sum = 0;
        for (const Vec3& v : element(i)) sum += v[axis];
        return sum;
    };
    const auto from = order_.begin();
    std::nth_element(from + std::ptrdiff_t(begin), from + std::ptrdiff_t(middle), from + std::ptrdiff_t(end),
                     [&](Index x, Index y) { return place(x) < place(y); });
    build(begin, middle);
    const std::size_t second = build(middle, end);
    nodes_[at].second = second;
    return at;
}

double BoxTree::to_box(const Vec3& p, std::size_t node) const {
    const Node& n = nodes_[node];
    return (n.low - p).cwiseMax(p - n.high).cwiseMax(0.0).norm();
}

void BoxTree::search(std::size_t at, const Vec3& p, std::pair<Index, double>& best) const {
    const Node& node = nodes_[at];
    if (node.second == 0) {
        for (std::size_t i = node.begin; i < node.end; ++i) {
            const double d = distance_to(p, element(order_[i]));
            if (d < best.second) best = {order_[i], d};
        }
        return;
    }
    std::size_t near = at + 1, far = node.second;
    double to_near = to_box(p, near), to_far = to_box(p, far);
    if (to_far < to_near) {
        std::swap(near, far);
        std::swap(to_near, to_far);
    }
    // The factor covers the rounding of the distance to a box.
    if (to_near * (1 - 1e-14) < best.second) search(near, p, best);
    if (to_far * (1 - 1e-14) < best.second) search(far, p, best);
}

}  // namespace hausbench
