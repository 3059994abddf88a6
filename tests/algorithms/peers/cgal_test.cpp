// Tests the peer `cgal` on meshes some of whose faces CGAL refuses. The answer must take all faces into account.
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/support/quick_options.h"

#include <gtest/gtest.h>

namespace hausbench {
namespace {

using Faces = std::vector<std::array<Index, 3>>;

// Returns a mesh of these faces. Vertex i of the first five is a corner of a square or its centre; 5 is above the centre.
TriangleMesh mesh_of_faces(const Faces& faces) {
    TriangleMesh mesh{Points(6, 3), Triangles(static_cast<Index>(faces.size()), 3)};
    mesh.vertices << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 0, 0.5, 0.5, 1;
    for (std::size_t i = 0; i < faces.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) mesh.triangles(static_cast<Index>(i), static_cast<Index>(k)) = faces[i][k];
    return mesh;
}

Bounds bounds_by(const char* solver, const TriangleMesh& a, const TriangleMesh& b) {
    const SolverEntry& entry = find_solver(solver);
    Query query;
    query.tolerance = {Tolerance::Of::absolute, 1e-6};
    Trace trace;
    return Session(entry, quick_options(entry), {a, b}, {}).solve(query, trace).bounds;
}

void expect_answers(const char* name, const Faces& faces) {
    const TriangleMesh odd = mesh_of_faces(faces);
    TriangleMesh other = mesh_of_faces({{0, 1, 2}});
    other.vertices.rowwise() += Eigen::RowVector3d(0.3, 0.1, 0.25);
    for (const bool back : {false, true}) {
        const Bounds by_cgal = back ? bounds_by("cgal", other, odd) : bounds_by("cgal", odd, other);
        const Bounds by_guthe = back ? bounds_by("guthe", other, odd) : bounds_by("guthe", odd, other);
        EXPECT_LE(by_cgal.gap(), 2e-6) << name;
        EXPECT_LE(by_cgal.lower, by_guthe.upper + 1e-12) << name << (back ? ", back" : "");
        EXPECT_GE(by_cgal.upper, by_guthe.lower - 1e-12) << name << (back ? ", back" : "");
    }
}

TEST(Cgal, UsesAllFacesIfCgalRefusesSome) {
    expect_answers("a polygon mesh", {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
    expect_answers("turned faces", {{0, 1, 4}, {1, 4, 2}, {2, 3, 4}, {3, 4, 0}});
    expect_answers("three faces at an edge", {{0, 1, 4}, {1, 0, 5}, {0, 1, 2}, {2, 3, 4}});
    expect_answers("two parts that meet at a vertex", {{0, 1, 4}, {2, 3, 4}, {5, 0, 1}});
    expect_answers("a face twice", {{0, 1, 4}, {0, 1, 4}, {2, 3, 4}});
    expect_answers("a vertex twice in a face", {{0, 1, 4}, {1, 1, 2}, {2, 3, 4}});
    expect_answers("a vertex three times in a face", {{0, 1, 4}, {5, 5, 5}, {2, 3, 4}});
}

}  // namespace
}  // namespace hausbench
