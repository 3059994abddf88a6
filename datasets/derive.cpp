#include "datasets/derive.h"

#include "algorithms/error.h"
#include "algorithms/kernel/direction.h"
#include "algorithms/surfaces/surface_mesh.h"
#include "datasets/random.h"

#include <boost/pending/disjoint_sets.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace hausbench {
namespace {

const TriangleMesh& mesh_of(const Given& g, const char* operation) {
    if (const auto* mesh = std::get_if<TriangleMesh>(g.origin)) return *mesh;
    throw InputError(fmt::format("{} takes a mesh, but its origin is a point set", operation));
}

PointSet choose_points(const Points& points, Index count, std::uint64_t seed) {
    if (count > points.rows())
        throw InputError(fmt::format("sample: cannot choose {1} points of a point set of {0}", points.rows(), count));
    std::vector<Index> rows = random_order(points.rows(), RandomNumbers(seed), 0);
    rows.resize(static_cast<std::size_t>(count));
    std::sort(rows.begin(), rows.end());
    return {rows_of(points, rows)};
}

PointSet sample_surface(const TriangleMesh& mesh, Index count, std::uint64_t seed) {
    std::vector<double> area_up_to;  // twice the area of the triangles up to each one, in scaled coordinates
    double area = 0;
    const auto corner = [&](Eigen::Index t, int k) -> Vec3 {
        return mesh.vertices.row(mesh.triangles(t, k)).transpose();
    };
    // Scales the mesh by a power of two to an extent of about 1. Otherwise the areas of a tiny mesh would underflow
    // when norm() squares them.
    const double extent = longest_side(mesh.vertices);
    const int exponent = extent > 0 && std::isfinite(extent) ? -std::ilogb(extent) : 0;
    const auto edge = [&](Eigen::Index t, int k) -> Vec3 {
        return (corner(t, k) - corner(t, 0)).unaryExpr([&](double x) { return std::ldexp(x, exponent); });
    };
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        area += edge(t, 1).cross(edge(t, 2)).norm();
        area_up_to.push_back(area);
    }
    if (!(area > 0) || !std::isfinite(area)) throw InputError("sample: the mesh has no area");
    const RandomNumbers random(seed);
    PointSet set{Points(count, 3)};
    for (Index i = 0; i < count; ++i) {
        const std::uint64_t counter = 3 * static_cast<std::uint64_t>(i);
        const double wanted = random.uniform(counter) * area;
        const auto position = std::upper_bound(area_up_to.begin(), area_up_to.end(), wanted);
        const Eigen::Index t = std::min<Eigen::Index>(position - area_up_to.begin(), mesh.triangles.rows() - 1);
        const double u = std::sqrt(random.uniform(counter + 1)), v = random.uniform(counter + 2);
        set.points.row(i) = ((1 - u) * corner(t, 0) + u * (1 - v) * corner(t, 1) + u * v * corner(t, 2)).transpose();
    }
    return set;
}

Shape with_noise(const Given& g) {
    const RandomNumbers random(g.seed());
    Points points = g.points();
    const double amplitude = g.real("amplitude") * diagonal(points);
    for (Eigen::Index i = 0; i < points.rows(); ++i)
        for (int k = 0; k < 3; ++k)
            points(i, k) += amplitude * (2 * random.uniform(static_cast<std::uint64_t>(3 * i + k)) - 1);
    return with_points(g, points);
}

Shape quantised(const Given& g) {
    const double cells = g.real("cells");
    return with_points(g, g.points().unaryExpr([&](double x) { return std::floor(x * cells + 0.5) / cells; }));
}

Shape normalised(const Given& g) {
    Points points = g.points();
    const double length = diagonal(points);
    if (!(length > 0)) throw InputError("normalise: all points are equal");
    const Eigen::RowVector3d centre = (points.colwise().minCoeff() + points.colwise().maxCoeff()) / 2;
    for (Eigen::Index i = 0; i < points.rows(); ++i) points.row(i) = (points.row(i) - centre) / length;
    return with_points(g, points);
}

// Returns a vector of length `distance`, along (2, 1, 2) / 3, so that the bounding box grows along every axis.
Eigen::RowVector3d away(const Given& g) { return g.real("distance") * Eigen::RowVector3d(2, 1, 2) / 3; }

Points stacked(const Points& above, const Points& below) {
    Points all(above.rows() + below.rows(), 3);
    all << above, below;
    return all;
}

// Adds a shifted copy of the last element, with its own vertices.
Shape with_stray(const Given& g) {
    const auto* mesh = std::get_if<TriangleMesh>(g.origin);
    const Points& points = g.points();
    const Eigen::RowVector3d shift = away(g);
    if (!mesh) return PointSet{stacked(points, points.bottomRows(1).rowwise() + shift)};
    const auto n = static_cast<Index>(points.rows());
    Points corners(3, 3);
    for (int k = 0; k < 3; ++k) corners.row(k) = points.row(mesh->triangles(mesh->triangles.rows() - 1, k)) + shift;
    Triangles triangles(mesh->triangles.rows() + 1, 3);
    triangles << mesh->triangles, Eigen::RowVector3<Index>(n, n + 1, n + 2);
    return TriangleMesh{stacked(points, corners), triangles};
}

// Adds a shifted copy of all elements, with its own vertices.
Shape with_copy(const Given& g) {
    const Points& points = g.points();
    const Points all = stacked(points, points.rowwise() + away(g));
    const auto* mesh = std::get_if<TriangleMesh>(g.origin);
    if (!mesh) return PointSet{all};
    Triangles triangles(2 * mesh->triangles.rows(), 3);
    triangles << mesh->triangles, (mesh->triangles.array() + static_cast<Index>(points.rows())).matrix();
    return TriangleMesh{all, triangles};
}

// Rotates by the unit quaternion (1, t * axis / |axis|) / sqrt(1 + t^2), where t is the tangent of half the angle.
Shape rotated(const Given& g) {
    const Vec3 axis = at_unit_scale(g.xyz());
    const double t = g.real("t");
    const double length = std::sqrt(axis.x() * axis.x() + axis.y() * axis.y() + axis.z() * axis.z());
    if (!(length > 0)) throw InputError("rotate: the axis x, y, z is zero");
    const double w = 1 / std::sqrt(1 + t * t);
    const double x = t * w * (axis.x() / length), y = t * w * (axis.y() / length), z = t * w * (axis.z() / length);
    Eigen::Matrix3d r;
    r << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
    return with_points(g, posed(g.points(), {r, Vec3::Zero()}));
}

Shape welded(const Given& g) {
    if (const auto* mesh = std::get_if<TriangleMesh>(g.origin)) return weld(*mesh);
    const std::vector<Index> first = first_equal(g.points());
    std::vector<Index> kept;
    for (std::size_t v = 0; v < first.size(); ++v)
        if (first[v] == static_cast<Index>(v)) kept.push_back(first[v]);
    return PointSet{rows_of(g.points(), kept)};
}

Shape sampled(const Given& g) {
    const auto* mesh = std::get_if<TriangleMesh>(g.origin);
    return mesh ? sample_surface(*mesh, g.whole("count"), g.seed())
                : choose_points(g.points(), g.whole("count"), g.seed());
}

Shape simplified(const Given& g) {
    const TriangleMesh& mesh = mesh_of(g, "simplify");
    const double wanted = g.numbers.contains("ratio")
                              ? std::floor(g.real("ratio") * static_cast<double>(mesh.triangles.rows()))
                              : g.real("triangles");
    return simplify(mesh, static_cast<Index>(wanted));
}

Shape subdivided(const Given& g) {
    if (g.whole("levels") == 0) return *g.origin;
    TriangleMesh mesh = mesh_of(g, "subdivide");
    for (Index i = 0; i < g.whole("levels"); ++i) mesh = subdivide(mesh);
    return mesh;
}

Shape with_outlier(const Given& g) {
    if (std::holds_alternative<TriangleMesh>(*g.origin))
        throw InputError("outlier takes a point set, but its origin is a mesh");
    return PointSet{stacked(g.points(), g.xyz().transpose())};
}

}  // namespace

Shape with_points(const Given& g, const Points& points) {
    Shape shape = *g.origin;
    points_of(shape) = points;
    return shape;
}

std::vector<Index> random_order(Eigen::Index count, const RandomNumbers& random, std::uint64_t first) {
    std::vector<std::pair<std::uint64_t, Index>> lots;
    for (Index i = 0; i < count; ++i) lots.emplace_back(random.bits(first + static_cast<std::uint64_t>(i)), i);
    std::sort(lots.begin(), lots.end());
    std::vector<Index> order;
    for (const auto& [lot, i] : lots) order.push_back(i);
    return order;
}

TriangleMesh weld(const TriangleMesh& mesh) {
    const std::vector<Index> first = first_equal(mesh.vertices);
    return without_unused(mesh.vertices,
                          mesh.triangles.unaryExpr([&](Index v) { return first[static_cast<std::size_t>(v)]; }));
}

std::vector<Index> connected_parts(const TriangleMesh& mesh) {
    const std::vector<Index> vertex = first_equal(mesh.vertices);
    const auto corner = [&](Eigen::Index t, int k) { return vertex[static_cast<std::size_t>(mesh.triangles(t, k))]; };
    boost::disjoint_sets_with_storage<> sets(vertex.size());
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        for (int k = 1; k < 3; ++k)
            sets.union_set(static_cast<std::size_t>(corner(t, 0)), static_cast<std::size_t>(corner(t, k)));
    }
    std::vector<Index> number(vertex.size(), -1), parts;
    Index next = 0;
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        Index& part = number[sets.find_set(static_cast<std::size_t>(corner(t, 0)))];
        if (part < 0) part = next++;
        parts.push_back(part);
    }
    return parts;
}

TriangleMesh subdivide(const TriangleMesh& mesh) {
    std::unordered_map<std::uint64_t, Index> midpoints;
    midpoints.reserve(static_cast<std::size_t>(mesh.triangles.rows()) * 2);
    std::vector<std::array<Index, 2>> edges;
    const auto old_count = static_cast<Index>(mesh.vertices.rows());
    const auto midpoint = [&](Index a, Index b) {
        const auto [low, high] = std::minmax(a, b);
        const std::uint64_t key = (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint32_t>(high);
        const auto [entry, fresh] = midpoints.try_emplace(key, old_count + static_cast<Index>(edges.size()));
        if (fresh) edges.push_back({low, high});
        return entry->second;
    };
    TriangleMesh fine;
    fine.triangles.resize(mesh.triangles.rows() * 4, 3);
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        const Index a = mesh.triangles(t, 0), b = mesh.triangles(t, 1), c = mesh.triangles(t, 2);
        const Index ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
        fine.triangles.middleRows(4 * t, 4) << a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca;
    }
    fine.vertices.resize(mesh.vertices.rows() + static_cast<Eigen::Index>(edges.size()), 3);
    fine.vertices.topRows(old_count) = mesh.vertices;
    for (std::size_t e = 0; e < edges.size(); ++e)  // halving first avoids overflow; exact except for subnormal numbers
        fine.vertices.row(old_count + static_cast<Eigen::Index>(e)) =
            mesh.vertices.row(edges[e][0]) / 2 + mesh.vertices.row(edges[e][1]) / 2;
    return fine;
}

const std::vector<Recipe>& operations() {
    const NumberSpec seed = seed_number(), x = coordinate("x"), y = coordinate("y"), z = coordinate("z"),
                     distance = length("distance", 0);
    static const std::vector<Recipe> list = [&] {
        std::vector<Recipe> all = {
            {"vertices",
             "a mesh becomes the set of its vertices",
             {},
             [](const Given& g) { return PointSet{g.points()}; }},
            {"weld", "vertices or points with equal coordinates become one", {}, welded},
            {"quantise",
             "each coordinate becomes the nearest multiple of 1 / `cells`, as in voxel data; equal points all stay",
             {whole_number("cells", 1, 0x1p53)},
             quantised},
            {"triangulate",
             "an algebraic surface becomes a mesh by marching tetrahedra; no other operation takes a surface",
             {whole_number("cells", 1, 512)},
             [](const Given& g) { return triangulate(surface_of(*g.origin), g.whole("cells")); }},
            {"sample",
             "random points on the surface, uniform in area; of a point set, `count` of its points",
             {whole_number("count", 1, 1e8), seed},
             sampled},
            {"simplify",
             "edge collapse (CGAL, Lindstrom and Turk 1998) down to a share or a number of triangles: give one of the "
             "two",
             {{"ratio", false, 1e-6, 1, false}, {"triangles", true, 4, 1e9, false}},
             simplified},
            {"remesh",
             "edges of even length `edge`, a fraction of the diagonal (CGAL, isotropic remeshing, 3 rounds)",
             {{"edge", false, 1e-4, 1}},
             [](const Given& g) { return remesh(mesh_of(g, "remesh"), g.real("edge") * diagonal(g.points())); }},
            {"noise",
             "each vertex moves within a cube of half-edge `amplitude`, a fraction of the diagonal",
             {{"amplitude", false, 0, 1e6}, seed},
             with_noise},
            {"subdivide",
             "splits each triangle in four at the midpoints of its edges; the surface changes by rounding only",
             {whole_number("levels", 0, 8)},
             subdivided},
            {"scale",
             "about the origin",
             {length("factor")},
             [](const Given& g) { return with_points(g, g.points() * g.real("factor")); }},
            {"normalise", "box centred at the origin, diagonal 1", {}, normalised},
            {"outlier", "adds one point to a point set, as the last", {x, y, z}, with_outlier},
            {"translate",
             "by fractions of the diagonal",
             {x, y, z},
             [](const Given& g) {
                 return with_points(g, g.points().rowwise() + diagonal(g.points()) * g.xyz().transpose());
             }},
            {"rotate",
             "about the axis (`x`, `y`, `z`) through the origin; `t` is the tangent of half the angle (rational, so "
             "that no libm is needed)",
             {x, y, z, {"t", false, -1e9, 1e9}},
             rotated},
            {"stray",
             "adds the last element once more, `distance` away along (2, 1, 2): a scan with one stray triangle or "
             "point",
             {distance},
             with_stray},
            {"two_clusters", "the shape, and a copy of it `distance` away along (2, 1, 2)", {distance}, with_copy}};
        const std::vector<Recipe> exact = exact_operations();
        all.insert(all.end(), exact.begin(), exact.end());
        return all;
    }();
    return list;
}

bool made_in_a_process(const std::string& operation) { return operation == "simplify" || operation == "remesh"; }

void check_operation(const std::string& where, const Recipe& operation, const Numbers& numbers) {
    check_numbers(where, operation, numbers);
    if (operation.name == "simplify" && numbers.size() != 1)
        throw InputError(one_line(where + ": simplify needs one of 'ratio' and 'triangles'"));
}

LoadedShape derive(const std::string& operation, const Numbers& numbers, const LoadedShape& origin) {
    const bool surface = kind_of(origin.shape) == ShapeKind::surface;
    if (surface && operation != "triangulate")
        throw InputError("operation '" + operation + "' takes no algebraic surface: triangulate it first");
    if (!surface && operation == "triangulate")
        throw InputError("operation 'triangulate' takes an algebraic surface, not a mesh or points");
    LoadReport report = origin.report;
    report.format = "derived";
    report.polygons = 0;
    report.unreferenced = 0;
    return {find_recipe(operations(), operation, "no operation").make({numbers, &origin.shape}), report};
}

}  // namespace hausbench
