#include "algorithms/error.h"
#include "datasets/derive.h"

#ifdef HAUSBENCH_HAS_CGAL

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_mesh_to_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <fmt/format.h>

#include <array>
#include <vector>

namespace hausbench {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;
namespace SMS = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Returns the mesh as a manifold (see derive.h). Throws InputError if that is not possible.
SurfaceMesh manifold(const TriangleMesh& soup, const char* operation) {
    const TriangleMesh mesh = weld(soup);
    std::vector<Kernel::Point_3> points;
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
        points.emplace_back(mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2));
    std::vector<std::vector<std::size_t>> faces;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        const auto corner = [&](int k) { return static_cast<std::size_t>(mesh.triangles(t, k)); };
        if (corner(0) != corner(1) && corner(1) != corner(2) && corner(2) != corner(0))
            faces.push_back({corner(0), corner(1), corner(2)});
    }
    PMP::merge_duplicate_polygons_in_polygon_soup(points, faces);
    PMP::orient_polygon_soup(points, faces);  // also duplicates vertices at which several surfaces touch
    PMP::remove_isolated_points_in_polygon_soup(points, faces);
    if (faces.empty() || !PMP::is_polygon_soup_a_polygon_mesh(faces))
        throw InputError(std::string(operation) + ": the mesh cannot be made a manifold");
    SurfaceMesh result;
    PMP::polygon_soup_to_polygon_mesh(points, faces, result);
    return result;
}

TriangleMesh soup(const SurfaceMesh& mesh) {
    std::vector<Kernel::Point_3> points;
    std::vector<std::array<std::size_t, 3>> faces;
    PMP::polygon_mesh_to_polygon_soup(mesh, points, faces);
    TriangleMesh result;
    result.vertices.resize(static_cast<Eigen::Index>(points.size()), 3);
    for (std::size_t v = 0; v < points.size(); ++v)
        result.vertices.row(static_cast<Eigen::Index>(v)) << points[v].x(), points[v].y(), points[v].z();
    result.triangles.resize(static_cast<Eigen::Index>(faces.size()), 3);
    for (std::size_t t = 0; t < faces.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            result.triangles(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(k)) =
                static_cast<Index>(faces[t][k]);
    return result;
}

// A condition for CGAL's edge collapse to stop. CGAL 5.5 itself can only stop at a number of edges.
struct FewEnoughTriangles {
    std::size_t triangles;

    template <class Cost, class Profile, class Count>
    bool operator()(const Cost&, const Profile& profile, Count, Count) const {
        return profile.surface_mesh().number_of_faces() <= triangles;
    }
};

}  // namespace

TriangleMesh simplify(const TriangleMesh& mesh, Index triangles) {
    SurfaceMesh surface = manifold(mesh, "simplify");
    const auto wanted = static_cast<std::size_t>(triangles);
    SMS::edge_collapse(surface, FewEnoughTriangles{wanted});
    surface.collect_garbage();
    const std::size_t reached = surface.number_of_faces();
    if (reached == 0 || static_cast<double>(reached) > 1.1 * static_cast<double>(wanted))
        throw InputError(fmt::format(
            "simplify: {} triangles are left, not {}, because no further edge can be collapsed", reached, wanted));
    return soup(surface);
}

TriangleMesh remesh(const TriangleMesh& mesh, double edge_length) {
    SurfaceMesh surface = manifold(mesh, "remesh");
    if (!(edge_length > 0)) throw InputError("remesh: all points are one");
    PMP::isotropic_remeshing(faces(surface), edge_length, surface, CGAL::parameters::number_of_iterations(3));
    surface.collect_garbage();
    if (surface.number_of_faces() == 0) throw InputError("remesh: nothing is left at this edge length");
    return soup(surface);
}

}  // namespace hausbench

#else

namespace hausbench {

TriangleMesh simplify(const TriangleMesh&, Index) {
    throw InputError("simplify: this program was built without CGAL's GPL parts (HAUSBENCH_WITH_CGAL_PEER=OFF)");
}

TriangleMesh remesh(const TriangleMesh&, double) {
    throw InputError("remesh: this program was built without CGAL's GPL parts (HAUSBENCH_WITH_CGAL_PEER=OFF)");
}

}  // namespace hausbench

#endif
