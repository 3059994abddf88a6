// The bridge to mesh solvers: triangulates both surfaces, calls a mesh solver, and widens its answer by the largest
// distance between each mesh and its surface, proven in both directions (surface_mesh.h). If MA and MB are the meshes
// of A and B, and the mesh solver finds that h(MA, MB) is in [l, u], then
//     l - h(MA,A) - h(B,MB) <= h(A,B) <= u + h(A,MA) + h(MB,B).
// Certified, because it accepts only certified mesh solvers. Reports the *deviations* (the distances between meshes and
// surfaces), the mesh solver's own bounds and the numbers of triangles.
//
// The gap is at least the sum of the deviations. This sum is of the order of the size of a cell of the grid, or of its
// square if the surface is smooth and does not meet the sides of its box. If the tolerance is smaller, the status is
// `stalled`. If a deviation cannot be bounded, the upper bound is the largest distance between a point of A's box and a
// point of B's box.
//
// If a polynomial has one sign on the whole grid, its surface has no mesh, and the status is `stalled`. The upper bound
// is then the same largest distance, or infinity if B has no mesh, because B may be empty. Budget, counters and
// witness: as in the mesh solver. O(cells^3) to triangulate, O(cells^2 4^levels) for the deviations.
#include "algorithms/error.h"
#include "algorithms/kernel/watched.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "algorithms/surfaces/surface_mesh.h"

#include "algorithms/kernel/interval.h"

#include <algorithm>
#include <limits>
#include <string>

namespace hausbench::surface_meshes {
namespace {

class SurfaceMeshes final : public Solver {
public:
    explicit SurfaceMeshes(const Options& options)
        : cells_(static_cast<int>(options.integer("cells"))),
          levels_(static_cast<int>(options.integer("levels"))),
          entry_(find_solver(options.text("solver"))) {}

    void prepare(const Scene& scene, const Prepared&) override {
        const auto &a = surface_of(scene.source), &b = surface_of(scene.target);
        farthest_ = farthest(a.box, b.box);
        TriangleMesh of_a, of_b;
        try {
            of_b = triangulate(b, cells_);
        } catch (const InputError& error) {  // the target may be empty
            no_mesh_ = error.what();
            if (WATCHED("surface_meshes: a target without a mesh may be empty", true))
                farthest_ = std::numeric_limits<double>::infinity();
            return;
        }
        try {
            of_a = triangulate(a, cells_);
        } catch (const InputError& error) {
            no_mesh_ = error.what();
            return;
        }
        a_ = deviation(a, of_a, cells_, levels_);
        b_ = deviation(b, of_b, cells_, levels_);
        triangles_ = {static_cast<double>(of_a.triangles.rows()), static_cast<double>(of_b.triangles.rows())};
        meshes_ = std::make_unique<Session>(entry_, Options(entry_.info.name, entry_.info.parameters, {}),
                                            Scene{std::move(of_a), std::move(of_b)}, QuerySet{});
    }

    std::size_t prepared_bytes() const override { return meshes_ ? meshes_->prepare_bytes() : 0; }

    Result solve(const Query& query, State*, Trace& trace) const override {
        if (!meshes_) return without_meshes(query);
        Query inner = query;
        inner.floor = 0;  // floor and cutoff of the query refer to the surfaces, not to the meshes
        inner.cutoff = std::numeric_limits<double>::infinity();
        Trace unused;
        Result result = meshes_->solve(inner, unused);
        const Bounds of_meshes = result.bounds;
        {
            const UpwardRounding upward;  // the negative of a sum is rounded down
            const double below = a_.mesh_to_surface - of_meshes.lower +
                                 WATCHED("surface_meshes: how far B is from its mesh", b_.surface_to_mesh);
            result.bounds.lower = std::max(-below, 0.0);
            result.bounds.upper =
                std::min(of_meshes.upper + WATCHED("surface_meshes: how far A is from its mesh", a_.surface_to_mesh) +
                             b_.mesh_to_surface,
                         farthest_);
        }
        result.witness.source_element = result.witness.target_element = -1;  // they refer to internal meshes
        result.reported = {{"mesh_a_to_surface", a_.mesh_to_surface},
                           {"surface_to_mesh_a", a_.surface_to_mesh},
                           {"mesh_b_to_surface", b_.mesh_to_surface},
                           {"surface_to_mesh_b", b_.surface_to_mesh},
                           {"mesh_lower", of_meshes.lower},
                           {"mesh_upper", of_meshes.upper},
                           {"triangles_a", triangles_[0]},
                           {"triangles_b", triangles_[1]}};
        trace.record(result.bounds.lower, result.bounds.upper);
        if (const auto answer = query.answer(result.bounds.lower, result.bounds.upper)) {
            result.status = *answer;
        } else if (result.status == Status::converged) {
            result.status = Status::stalled;
            result.note = "the meshes are not nearer to their surfaces: give more cells";
        }
        return result;
    }

private:
    // Returns an upper bound on the distance between any point of one box and any point of the other. Row 0 of a box is
    // its low corner, row 1 its high corner.
    static double farthest(const Points& a, const Points& b) {
        const UpwardRounding upward;
        Interval sum(0.0);
        for (int k = 0; k < 3; ++k) {
            const double first = b(1, k) - a(0, k), second = a(1, k) - b(0, k);
            sum += CGAL::square(Interval(std::max({first, second, 0.0})));
        }
        return CGAL::sqrt(sum).sup();
    }

    Result without_meshes(const Query& query) const {
        Result result;
        result.bounds = {0, farthest_};
        result.status = query.answer(0, farthest_).value_or(Status::stalled);
        result.note = no_mesh_;
        return result;
    }

    int cells_, levels_;
    std::string no_mesh_;  // why a mesh is missing; empty: both exist
    SolverEntry entry_;
    MeshDeviation a_{}, b_{};
    std::array<double, 2> triangles_{};
    double farthest_ = 0;
    std::unique_ptr<Session> meshes_;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info;
    info.name = "surface_meshes";
    info.title = "surface meshes (ours)";
    info.source.surface = info.target.surface = true;
    info.certified = true;
    info.abilities.insert({Ability::traces, Ability::coarser_answers});
    info.parameters = {
        {.name = "cells",
         .default_value = std::int64_t{32},
         .unit = "cells an axis",
         .description = "cells of the grid along each axis",
         .least = 2,
         .most = 512},
        {.name = "levels",
         .default_value = std::int64_t{3},
         .description = "boxes in which the distance of mesh and surface is bounded have 1 / 2^levels of a cell's edge",
         .least = 0,
         .most = 8},
        {.name = "solver",
         .default_value = std::string("guthe"),
         .description = "solver for the meshes, with its defaults",
         .choices = {"guthe"}},
    };
    return {info, make_solver<SurfaceMeshes>};
}

}  // namespace hausbench::surface_meshes
