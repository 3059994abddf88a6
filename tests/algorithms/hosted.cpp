// The algorithms as a shared library with one C function, as hosts in other languages (such as Python) load it.
#include "algorithms/registry.h"
#include "algorithms/session/session.h"

#include <vector>

using namespace hausbench;

// Returns how many mesh solvers bounded the distance between two meshes with three corners per triangle; -1 if one
// threw.
extern "C" int bound_by_all_solvers(const double* a, const double* b, int points) {
    try {
        PointSet source{Points(points, 3)}, target{Points(points, 3)};
        for (int i = 0; i < 3 * points; ++i) source.points(i / 3, i % 3) = a[i], target.points(i / 3, i % 3) = b[i];
        TriangleMesh mesh{source.points, Triangles(points / 3, 3)}, other{target.points, Triangles(points / 3, 3)};
        for (int i = 0; i < points; ++i) mesh.triangles(i / 3, i % 3) = other.triangles(i / 3, i % 3) = i;
        int bounded = 0;
        for (const SolverEntry& entry : solvers()) {
            if (entry.info.source.surface || !refusal(entry.info, ShapeKind::mesh, ShapeKind::mesh).empty()) continue;
            ParameterMap given;
            if (entry.info.name == "sampling") given["step"] = 0.05;
            Query query;
            query.tolerance.value = 1e-3;
            query.threads = 2;
            const Session session(entry, Options(entry.info.name, entry.info.parameters, given), Scene{mesh, other},
                                  {});
            Trace untraced;
            bounded += session.solve(query, untraced).bounds.upper > 0;
        }
        return bounded;
    } catch (const std::exception&) {
        return -1;
    }
}
