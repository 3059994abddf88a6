// CGAL's AABB_tree over triangles in Simple_cartesian<double>, its fastest kernel. The time of build() includes
// accelerate_distance_queries(), which builds CGAL's default search structure for a first guess at the closest point.
#include "bench/closest_rival.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <optional>

namespace hausbench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using CgalTriangles = std::vector<Kernel::Triangle_3>;
using Tree =
    CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, CgalTriangles::const_iterator>>>;

class Cgal final : public ClosestRival {
public:
    std::string name() const override { return "CGAL"; }

    void take(const TriangleMesh& mesh) override {
        triangles_.clear();
        const auto point = [&](Index v) {
            return Kernel::Point_3(mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2));
        };
        for (Index i = 0; i < mesh.triangles.rows(); ++i) {
            triangles_.emplace_back(point(mesh.triangles(i, 0)), point(mesh.triangles(i, 1)),
                                    point(mesh.triangles(i, 2)));
        }
    }

    void build() override {
        tree_.emplace(triangles_.cbegin(), triangles_.cend());
        tree_->build();
        tree_->accelerate_distance_queries();
    }
    void forget() override { tree_.reset(); }

    void distances(const Points& points, std::vector<double>& distances) override {
        for (Index i = 0; i < points.rows(); ++i) {
            const Kernel::Point_3 p(points(i, 0), points(i, 1), points(i, 2));
            const auto [point, triangle] = tree_->closest_point_and_primitive(p);
            distances[static_cast<std::size_t>(i)] = std::sqrt(CGAL::squared_distance(p, point));
        }
    }

private:
    CgalTriangles triangles_;
    std::optional<Tree> tree_;
};

}  // namespace

std::unique_ptr<ClosestRival> cgal_rival() { return std::make_unique<Cgal>(); }

}  // namespace hausbench
