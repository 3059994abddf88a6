// Finds the element of a shape that is nearest to a point, with code of its own, to check solvers.
#pragma once

#include "harness/check/verify_exact.h"

#include <utility>
#include <vector>

namespace hausbench {

// Returns the distance of p to a point, or to a triangle, in doubles. BoxTree says how much it may err.
double distance_to(const Vec3& p, const Element& e);

// A tree of boxes over the elements of a shape, halved at the median of the longest side.
class BoxTree {
public:
    explicit BoxTree(const Standing& shape);

    // How much distances may err because triangles are thin, besides the rounding of coordinates. A foot on the plane of a
    // triangle of length L and height w errs by about u L^2 / w, u = 2^-53. For triangles that are so thin that this is
    // more than w, only the edges count; they are within w of all of the triangle.
    double error_of_slivers() const { return error_of_slivers_; }

    // Returns the element nearest to p, and its distance. O(log n) on well-behaved shapes.
    std::pair<Index, double> nearest(const Vec3& p) const;

    const Element& element(Index i) const { return elements_[std::size_t(i)]; }

private:
    struct Node {
        Vec3 low, high;
        std::size_t begin, end, second;  // second child; 0: a leaf. The first child follows its parent
    };

    std::size_t build(std::size_t begin, std::size_t end);
    double to_box(const Vec3& p, std::size_t node) const;
    void search(std::size_t at, const Vec3& p, std::pair<Index, double>& best) const;

    double error_of_slivers_ = 0;
    std::vector<Index> order_;
    std::vector<Element> elements_;
    std::vector<Node> nodes_;
};

}  // namespace hausbench
