#include "algorithms/composed/penetration/common_volume.h"

#include "algorithms/kernel/watched.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <map>
#include <new>
#include <set>
#include <utility>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

namespace hausbench::penetration {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;
using Face = SurfaceMesh::Face_index;
using Corners = std::array<Point, 3>;

Corners corners_of(const SurfaceMesh& mesh, Face face) {
    Corners corners;
    std::size_t k = 0;
    for (const auto vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh)) corners[k++] = mesh.point(vertex);
    return corners;
}

Corners sorted(Corners corners) {
    std::sort(corners.begin(), corners.end());
    return corners;
}

// Records, while CGAL intersects two meshes, which triangles of the common volume come from A, and whether any
// triangles of A and B are coplanar.
struct Origins : pmp::Corefinement::Default_visitor<SurfaceMesh> {
    struct Record {
        std::map<Face, bool> of_source;
        bool coplanar = false;
    };

    Origins(const SurfaceMesh& source, Record& record) : source_(&source), record_(&record) {}

    void after_face_copy(Face, const SurfaceMesh& from, Face copy, SurfaceMesh&) {
        record_->of_source[copy] = &from == source_;
    }
    void start_handling_intersection_of_coplanar_faces(std::size_t pairs) const {
        record_->coplanar = record_->coplanar || pairs > 0;
    }

private:
    const SurfaceMesh* source_;
    Record* record_;
};

// Collects triangles of one mesh, with the vertices that they use. Pass the same mesh to every add(): a vertex is known
// by its index in it.
class Collector {
public:
    void add(const SurfaceMesh& mesh, Face face) {
        std::array<Index, 3> row;
        std::size_t k = 0;
        for (const auto vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh)) {
            const auto [at, fresh] = number_.emplace(vertex, Index(points_.size()));
            if (fresh) points_.push_back(mesh.point(vertex));
            row[k++] = at->second;
        }
        rows_.push_back(row);
    }

    TriangleMesh mesh() const {
        TriangleMesh made;
        made.vertices.resize(Eigen::Index(points_.size()), 3);
        for (std::size_t v = 0; v < points_.size(); ++v)
            made.vertices.row(Eigen::Index(v)) << points_[v].x(), points_[v].y(), points_[v].z();
        made.triangles.resize(Eigen::Index(rows_.size()), 3);
        for (std::size_t t = 0; t < rows_.size(); ++t)
            made.triangles.row(Eigen::Index(t)) << rows_[t][0], rows_[t][1], rows_[t][2];
        return made;
    }

private:
    std::map<SurfaceMesh::Vertex_index, Index> number_;
    std::vector<Point> points_;
    std::vector<std::array<Index, 3>> rows_;
};

double size_of(const CommonPart& part) {
    Eigen::AlignedBox3d box;
    for (const Points* points : {&part.of_source.vertices, &part.of_target.vertices})
        for (Eigen::Index v = 0; v < points->rows(); ++v) box.extend(points->row(v).transpose());
    return box.isEmpty() ? 0 : box.diagonal().norm();
}

// Splits the common volume into connected parts, and the boundary of each part into its triangles from A and from B.
// `target` is B after corefinement, which cuts coplanar triangles of A and B alike. So a triangle of A that is also a
// triangle of B has the same corners in `target`.
std::vector<CommonPart> parts_of(const SurfaceMesh& volume, const SurfaceMesh& target, const Origins::Record& record) {
    std::set<Corners> of_target;
    if (record.coplanar)
        for (const Face face : target.faces()) of_target.insert(sorted(corners_of(target, face)));
    std::map<Face, std::size_t> surface;
    std::size_t count =
        pmp::connected_components(volume, boost::associative_property_map<std::map<Face, std::size_t>>(surface));
    // Groups the surfaces that bound the same part: a hollow part has an outer and an inner surface.
    if (WATCHED("common_volume: a part may have a surface within another one", count > 1))
        count = pmp::volume_connected_components(volume,
                                                 boost::associative_property_map<std::map<Face, std::size_t>>(surface));
    std::vector<std::array<Collector, 2>> sides(count);
    for (const Face face : volume.faces()) {
        auto& [of_a, of_b] = sides[surface.at(face)];
        const bool of_source = record.of_source.at(face);
        const bool shared = of_source && record.coplanar && of_target.contains(sorted(corners_of(volume, face)));
        (of_source ? of_a : of_b).add(volume, face);
        if (WATCHED("common_volume: what lies in one plane bounds the volume on both sides", shared))
            of_b.add(volume, face);
    }
    std::vector<CommonPart> parts;
    for (const auto& [of_a, of_b] : sides) parts.push_back({of_a.mesh(), of_b.mesh()});
    std::stable_sort(parts.begin(), parts.end(),
                     [](const CommonPart& a, const CommonPart& b) { return size_of(a) > size_of(b); });
    return parts;
}

std::string count_of(std::size_t n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

}  // namespace

struct Solid::Faces {
    SurfaceMesh mesh;  // vertex i is row i of vertices_
};

struct VolumeCutting {
    static SurfaceMesh placed(const Solid& solid, const Pose& pose) {
        SurfaceMesh mesh = solid.faces_->mesh;
        const Points points = solid.posed(pose);
        for (const auto vertex : mesh.vertices()) {
            const auto row = points.row(Eigen::Index(vertex.idx()));
            mesh.point(vertex) = Point(row[0], row[1], row[2]);
        }
        if (WATCHED("common_volume: a mirror turns a solid inside out", pose.rotation.determinant() < 0))
            pmp::reverse_face_orientations(mesh);  // a reflection turns it inside out
        return mesh;
    }
};

Solid::Solid(const TriangleMesh& mesh) : vertices_(mesh.vertices), faces_(std::make_unique<Faces>()) {
    std::vector<Point> points;
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
        points.emplace_back(mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2));
    std::vector<std::vector<std::size_t>> polygons;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
        polygons.push_back(
            {std::size_t(mesh.triangles(t, 0)), std::size_t(mesh.triangles(t, 1)), std::size_t(mesh.triangles(t, 2))});
    pmp::repair_polygon_soup(points, polygons);
    pmp::orient_polygon_soup(points, polygons);  // duplicates vertices that belong to several surfaces
    if (polygons.empty()) {
        flaw_ = "all its triangles are points or lines";
        return;
    }
    vertices_.resize(Eigen::Index(points.size()), 3);
    for (std::size_t v = 0; v < points.size(); ++v)
        vertices_.row(Eigen::Index(v)) << points[v].x(), points[v].y(), points[v].z();
    if (!pmp::is_polygon_soup_a_polygon_mesh(polygons)) {
        flaw_ = "it is not a manifold";
        return;
    }
    SurfaceMesh& made = faces_->mesh;
    pmp::polygon_soup_to_polygon_mesh(points, polygons, made);
    const auto open = std::count_if(made.halfedges().begin(), made.halfedges().end(),
                                    [&](const auto halfedge) { return made.is_border(halfedge); });
    if (WATCHED("common_volume: open meshes", open > 0)) {
        flaw_ = fmt::format("it is not closed: {} on its border", count_of(std::size_t(open), "edge"));
        return;
    }
    std::vector<std::pair<Face, Face>> crossing;
    pmp::self_intersections(made, std::back_inserter(crossing));
    if (WATCHED("common_volume: meshes that cross themselves", !crossing.empty())) {
        flaw_ = fmt::format("it crosses itself or has triangles without area: {} of triangles",
                            count_of(crossing.size(), "pair"));
        return;
    }
    if (WATCHED("common_volume: faces that point inward", true)) pmp::orient_to_bound_a_volume(made);
}

Solid::~Solid() = default;
Solid::Solid(Solid&&) noexcept = default;

std::size_t Solid::bytes() const {
    const SurfaceMesh& mesh = faces_->mesh;
    // Counts a point and a halfedge index for each vertex, four indices for each halfedge, and one for each face.
    return std::size_t(vertices_.size()) * sizeof(double) + mesh.number_of_vertices() * (sizeof(Point) + 4) +
           mesh.number_of_halfedges() * 16 + mesh.number_of_faces() * 4;
}

CommonVolume common_volume(const Solid& source, const Pose& source_pose, const Solid& target, const Pose& target_pose) {
    SurfaceMesh a = VolumeCutting::placed(source, source_pose), b = VolumeCutting::placed(target, target_pose), volume;
    Origins::Record record;
    CommonVolume common;
    try {
        const bool cut = pmp::corefine_and_compute_intersection(
            a, b, volume, CGAL::parameters::visitor(Origins(a, record)).throw_on_self_intersection(true));
        if (!cut) {
            common.failure = "the common volume is not a manifold (parts of it meet in an edge or a point)";
            return common;
        }
        common.parts = parts_of(volume, b, record);
    } catch (const pmp::Corefinement::Self_intersection_exception&) {
        common.failure = "a mesh crosses itself in this pose, where the two meet";
        return common;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        common.failure = std::string("CGAL failed to cut them: ") + error.what();
        return common;
    }
    return common;
}

}  // namespace hausbench::penetration
