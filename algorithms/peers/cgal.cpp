// CGAL's one-sided Hausdorff distance of triangle meshes with bounded error, called as its users do.
//
// Source: CGAL 5.5, Polygon_mesh_processing::bounded_error_Hausdorff_distance (after Tang, Lee, Kim 2009, midpoint
// subdivision). It returns a single number v with |v - h| <= error_bound. It starts with error_bound as its lower
// bound, so v is never smaller, except that it is 0 if each face of A is a face of B. Hence, if v is equal to
// error_bound, h may be anywhere in [0, 2 * error_bound]; if v is larger, h is in [v, v + error_bound]. This ignores
// rounding errors, so the solver is not certified. It gives no witness: the points are NaN, the elements -1. CGAL
// builds its structures in every call, so their time counts in solve(), not in prepare().
//
// For an absolute tolerance, error_bound is set to the tolerance. If v is then equal to error_bound, the interval is
// twice as wide as the tolerance, and a second call with half the error_bound gives [0, tolerance] or a narrower one.
// For a tolerance relative to the lower bound, error_bound decreases until the tolerance is met. Limits of time and
// work are ignored.
//
// A mesh becomes a Surface_mesh with shared vertices. If one of its faces does not fit the others (CGAL's add_face
// refuses it), each triangle gets three vertices of its own. CGAL accepts both, because it uses the faces one by one.
// Only its search for faces that A and B share compares vertices, and it compares their sorted positions.
// The time to build B's Surface_mesh counts in prepare(), and the time to build A's in solve(). For bunny and armadillo,
// both together take 24 ms, and CGAL's function takes 110 ms. Until November 2026, this solver first called
// is_polygon_soup_a_polygon_mesh(), which took 280 ms for B alone.
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/solver.h"

#include <exception>
#include <optional>
#include <utility>

#include <CGAL/Simple_cartesian.h>  // before distance.h, which lacks an include

#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Surface_mesh.h>

namespace hausbench::cgal {
namespace {

// CGAL's example uses Exact_predicates_inexact_constructions_kernel, which gives the same answers in the same time. But
// with coordinates near 1e150 or 1e-160, it ends the process with SIGFPE in the library GMP. With this kernel, such
// scenes get wrong answers, which the harness can report.
using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

using Faces = std::vector<std::array<std::size_t, 3>>;

Faces faces_of(const Triangles& triangles) {
    Faces faces(static_cast<std::size_t>(triangles.rows()));
    for (Index i = 0; i < triangles.rows(); ++i) {
        for (int k = 0; k < 3; ++k) {
            faces[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] = static_cast<std::size_t>(triangles(i, k));
        }
    }
    return faces;
}

using Vertex = SurfaceMesh::Vertex_index;

SurfaceMesh::Point point_at(const Points& vertices, std::size_t v) {
    const auto row = static_cast<Index>(v);
    return {vertices(row, 0), vertices(row, 1), vertices(row, 2)};
}

// Returns a mesh whose faces share vertices, or nothing if a face has a vertex twice or does not fit the others.
std::optional<SurfaceMesh> connected_mesh(const Points& vertices, const Faces& faces) {
    SurfaceMesh mesh;
    const auto count = static_cast<std::size_t>(vertices.rows());
    mesh.reserve(static_cast<Index>(count), static_cast<Index>(2 * faces.size()), static_cast<Index>(faces.size()));
    for (std::size_t v = 0; v < count; ++v) mesh.add_vertex(point_at(vertices, v));
    for (const auto& [a, b, c] : faces) {
        if (a == b || b == c || c == a) return std::nullopt;
        const auto face =
            mesh.add_face(Vertex(static_cast<Index>(a)), Vertex(static_cast<Index>(b)), Vertex(static_cast<Index>(c)));
        if (WATCHED("cgal: a face that CGAL refuses counts", face == SurfaceMesh::null_face())) return std::nullopt;
    }
    return mesh;
}

SurfaceMesh surface_mesh(const Points& vertices, const Faces& faces) {
    if (std::optional<SurfaceMesh> connected = connected_mesh(vertices, faces)) return std::move(*connected);
    SurfaceMesh mesh;
    const auto new_vertex = [&](std::size_t v) { return mesh.add_vertex(point_at(vertices, v)); };
    for (const auto& [a, b, c] : faces) mesh.add_face(new_vertex(a), new_vertex(b), new_vertex(c));
    return mesh;
}

class Cgal final : public Solver {
public:
    explicit Cgal(const Options& options) : match_faces_(options.flag("match_faces")) {}

    void prepare(const Scene& scene, const Prepared&) override {
        source_ = &mesh_of(scene.source);
        source_faces_ = faces_of(source_->triangles);
        const auto& target = mesh_of(scene.target);
        target_ = surface_mesh(target.vertices, faces_of(target.triangles));
    }

    Result solve(const Query& query, State*, Trace&) const override {
        Result result;
        try {
            const SurfaceMesh source = surface_mesh(posed(source_->vertices, query.source_pose), source_faces_);
            if (query.tolerance.of == Tolerance::Of::absolute) {
                result.bounds = bounds(source, query.tolerance.value);
                if (result.bounds.gap() > query.tolerance.value)
                    result.bounds = bounds(source, query.tolerance.value / 2);
            } else {
                // A relative tolerance depends on h, which is not known. So the error bound starts at a fraction of the
                // diagonal of the box of A. It decreases until the tolerance is met, or until it is as small as the
                // rounding errors of the coordinates.
                double bound = std::max(diagonal(source_->vertices), std::numeric_limits<double>::min());
                do {
                    bound *= query.tolerance.value < 0.5 ? query.tolerance.value : 0.5;
                    result.bounds = bounds(source, bound);
                } while (result.bounds.gap() > query.tolerance.gap(result.bounds.lower) &&
                         bound > 16 * unit_roundoff * magnitude(source_->vertices));
            }
        } catch (const std::exception&) {  // an assertion of CGAL that failed, in a build with assertions
            return result;
        }
        result.status = query.answer(result.bounds.lower, result.bounds.upper).value_or(Status::stalled);
        return result;
    }

private:
    // Calls CGAL's function once. Returns the interval that contains h according to its answer (see the top of this
    // file).
    Bounds bounds(const SurfaceMesh& source, double error_bound) const {
        namespace pmp = CGAL::Polygon_mesh_processing;
        const auto matched = CGAL::parameters::match_faces(match_faces_);
        const double value =
            pmp::bounded_error_Hausdorff_distance<CGAL::Sequential_tag>(source, target_, error_bound, matched, matched);
        if (value == 0) return {0, 0};  // every face of A is a face of B
        // CGAL rounds error_bound by squaring it and taking the root.
        if (value == std::sqrt(error_bound * error_bound)) return {0, 2 * error_bound};
        Bounds result{value, value + error_bound};
        // Shrinks the interval if rounding the sum made it wider than error_bound.
        while (result.gap() > error_bound) result.upper = next_down(result.upper);
        return result;
    }

    bool match_faces_;
    const TriangleMesh* source_ = nullptr;
    Faces source_faces_;
    SurfaceMesh target_;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info;
    info.name = "cgal";
    info.title = "CGAL";
    info.paper = "cgal";
    info.source.mesh = info.target.mesh = true;
    info.original_coordinates = true;
    info.parameters = {
        {.name = "match_faces",
         .default_value = true,
         .description = "first drop the faces of A that are faces of B; CGAL's default",
         .choices = {}},
    };
    return {info, [](const Options& options) -> std::unique_ptr<Solver> { return std::make_unique<Cgal>(options); }};
}

}  // namespace hausbench::cgal
