#include "derive.h"

#include "error.h"
#include "random.h"
#include "surfaces/surface_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace hausbench {
namespace {

const TriangleMesh& mesh_of(const Shape& shape, const std::string& operation) {
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) return *mesh;
    throw InputError(operation + " takes a mesh, but its origin is a point set");
}

// For each row, the first row with the same coordinates (-0 = +0).
std::vector<Index> first_equal(const Points& points) {
    const auto less = [&](Index a, Index b) {
        for (int k = 0; k < 3; ++k)
            if (points(a, k) != points(b, k)) return points(a, k) < points(b, k);
        return a < b;
    };
    std::vector<Index> order(static_cast<std::size_t>(points.rows()));
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), less);
    std::vector<Index> first(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && points.row(order[i]) == points.row(order[i - 1]);
        first[static_cast<std::size_t>(order[i])] = same ? first[static_cast<std::size_t>(order[i - 1])] : order[i];
    }
    return first;
}

Points rows_of(const Points& points, const std::vector<Index>& rows) {
    Points chosen(static_cast<Eigen::Index>(rows.size()), 3);
    for (std::size_t i = 0; i < rows.size(); ++i) chosen.row(static_cast<Eigen::Index>(i)) = points.row(rows[i]);
    return chosen;
}

PointSet weld_points(const Points& points) {
    const std::vector<Index> first = first_equal(points);
    std::vector<Index> kept;
    for (std::size_t v = 0; v < first.size(); ++v)
        if (first[v] == static_cast<Index>(v)) kept.push_back(first[v]);
    return {rows_of(points, kept)};
}

PointSet choose_points(const Points& points, Index count, std::uint64_t seed) {
    if (count > points.rows())
        throw InputError(fmt::format("sample: cannot choose {1} points of a point set of {0}", points.rows(), count));
    const Random random(seed);
    std::vector<std::pair<std::uint64_t, Index>> lots;
    for (Index i = 0; i < points.rows(); ++i) lots.emplace_back(random.bits(static_cast<std::uint64_t>(i)), i);
    std::sort(lots.begin(), lots.end());
    std::vector<Index> rows;
    for (Index i = 0; i < count; ++i) rows.push_back(lots[static_cast<std::size_t>(i)].second);
    std::sort(rows.begin(), rows.end());
    return {rows_of(points, rows)};
}

PointSet sample_surface(const TriangleMesh& mesh, Index count, std::uint64_t seed) {
    std::vector<double> area_up_to;
    double area = 0;
    const auto corner = [&](Eigen::Index t, int k) -> Vec3 {
        return mesh.vertices.row(mesh.triangles(t, k)).transpose();
    };
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
        area += (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm();
        area_up_to.push_back(area);
    }
    if (!(area > 0) || !std::isfinite(area)) throw InputError("sample: the mesh has no area");
    const Random random(seed);
    PointSet set{Points(count, 3)};
    for (Index i = 0; i < count; ++i) {
        const std::uint64_t counter = 3 * static_cast<std::uint64_t>(i);
        const double wanted = random.uniform(counter) * area;
        const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end(), wanted);
        const Eigen::Index t = std::min<Eigen::Index>(found - area_up_to.begin(), mesh.triangles.rows() - 1);
        const double u = std::sqrt(random.uniform(counter + 1)), v = random.uniform(counter + 2);
        set.points.row(i) = ((1 - u) * corner(t, 0) + u * (1 - v) * corner(t, 1) + u * v * corner(t, 2)).transpose();
    }
    return set;
}

void add_noise(Points& points, double amplitude, std::uint64_t seed) {
    const Random random(seed);
    for (Eigen::Index i = 0; i < points.rows(); ++i)
        for (int k = 0; k < 3; ++k)
            points(i, k) += amplitude * (2 * random.uniform(static_cast<std::uint64_t>(3 * i + k)) - 1);
}

void quantise(Points& points, double cells) {
    points = points.unaryExpr([&](double x) { return std::floor(x * cells + 0.5) / cells; }).eval();
}

void normalise(Points& points) {
    const double length = diagonal(points);
    if (!(length > 0)) throw InputError("normalise: all points are equal");
    const Eigen::RowVector3d centre = (points.colwise().minCoeff() + points.colwise().maxCoeff()) / 2;
    for (Eigen::Index i = 0; i < points.rows(); ++i) points.row(i) = (points.row(i) - centre) / length;
}

// A length along (2, 1, 2) / 3, a unit vector: the box grows along every axis.
Eigen::RowVector3d away(double distance) { return distance * Eigen::RowVector3d(2, 1, 2) / 3; }

Points stacked(const Points& above, const Points& below) {
    Points all(above.rows() + below.rows(), 3);
    all << above, below;
    return all;
}

// The last element once more, moved by `shift`, with vertices of its own.
Shape with_stray(const Shape& shape, const Eigen::RowVector3d& shift) {
    const auto* mesh = std::get_if<TriangleMesh>(&shape);
    const Points& points = points_of(shape);
    if (!mesh) return PointSet{stacked(points, points.bottomRows(1).rowwise() + shift)};
    const auto n = static_cast<Index>(points.rows());
    Points corners(3, 3);
    for (int k = 0; k < 3; ++k) corners.row(k) = points.row(mesh->triangles(mesh->triangles.rows() - 1, k)) + shift;
    Triangles triangles(mesh->triangles.rows() + 1, 3);
    triangles << mesh->triangles, Eigen::RowVector3<Index>(n, n + 1, n + 2);
    return TriangleMesh{stacked(points, corners), triangles};
}

// All elements once more, moved by `shift`, with vertices of their own.
Shape with_copy(const Shape& shape, const Eigen::RowVector3d& shift) {
    const Points& points = points_of(shape);
    const Points all = stacked(points, points.rowwise() + shift);
    const auto* mesh = std::get_if<TriangleMesh>(&shape);
    if (!mesh) return PointSet{all};
    Triangles triangles(2 * mesh->triangles.rows(), 3);
    triangles << mesh->triangles, (mesh->triangles.array() + static_cast<Index>(points.rows())).matrix();
    return TriangleMesh{all, triangles};
}

// From the unit quaternion (1, t axis / |axis|) / sqrt(1 + t^2).
Eigen::Matrix3d rotation(const Vec3& axis, double t) {
    const double length = std::sqrt(axis.x() * axis.x() + axis.y() * axis.y() + axis.z() * axis.z());
    if (!(length > 0)) throw InputError("rotate: the axis x, y, z is zero");
    const double w = 1 / std::sqrt(1 + t * t);
    const double x = t * w * (axis.x() / length), y = t * w * (axis.y() / length), z = t * w * (axis.z() / length);
    Eigen::Matrix3d r;
    r << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
    return r;
}

}  // namespace

TriangleMesh weld(const TriangleMesh& mesh) {
    const std::vector<Index> first = first_equal(mesh.vertices);
    std::vector<Index> becomes(first.size()), kept;
    for (std::size_t v = 0; v < first.size(); ++v) {
        if (first[v] == static_cast<Index>(v)) {
            becomes[v] = static_cast<Index>(kept.size());
            kept.push_back(first[v]);
        } else {
            becomes[v] = becomes[static_cast<std::size_t>(first[v])];
        }
    }
    TriangleMesh welded{rows_of(mesh.vertices, kept), mesh.triangles};
    for (Index& v : welded.triangles.reshaped()) v = becomes[static_cast<std::size_t>(v)];
    return welded;
}

TriangleMesh subdivide(const TriangleMesh& mesh) {
    std::unordered_map<std::uint64_t, Index> midpoints;
    midpoints.reserve(static_cast<std::size_t>(mesh.triangles.rows()) * 2);
    std::vector<std::array<Index, 2>> edges;
    const auto old_count = static_cast<Index>(mesh.vertices.rows());
    const auto midpoint = [&](Index a, Index b) {
        const auto [low, high] = std::minmax(a, b);
        const std::uint64_t key = (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint32_t>(high);
        const auto [found, fresh] = midpoints.try_emplace(key, old_count + static_cast<Index>(edges.size()));
        if (fresh) edges.push_back({low, high});
        return found->second;
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
    for (std::size_t e = 0; e < edges.size(); ++e)  // halves first: no overflow, and exact except for subnormal numbers
        fine.vertices.row(old_count + static_cast<Eigen::Index>(e)) =
            mesh.vertices.row(edges[e][0]) / 2 + mesh.vertices.row(edges[e][1]) / 2;
    return fine;
}

const std::vector<Recipe>& operations() {
    static const NumberSpec seed{"seed", true, 0, 0x1p53}, x{"x", false, -1e100, 1e100}, y{"y", false, -1e100, 1e100},
        z{"z", false, -1e100, 1e100};
    static const std::vector<Recipe> list = {
        {"vertices", {}},
        {"weld", {}},
        {"quantise", {{"cells", true, 1, 0x1p53}}},
        {"triangulate", {{"cells", true, 1, 512}}},
        {"sample", {{"count", true, 1, 1e8}, seed}},
        {"simplify", {{"ratio", false, 1e-6, 1, false}, {"triangles", true, 4, 1e9, false}}},
        {"remesh", {{"edge", false, 1e-4, 1}}},
        {"noise", {{"amplitude", false, 0, 1e6}, seed}},
        {"subdivide", {{"levels", true, 0, 8}}},
        {"scale", {{"factor", false, 1e-100, 1e100}}},
        {"normalise", {}},
        {"outlier", {x, y, z}},
        {"translate", {x, y, z}},
        {"rotate", {x, y, z, {"t", false, -1e9, 1e9}}},
        {"stray", {{"distance", false, 0, 1e100}}},
        {"two_clusters", {{"distance", false, 0, 1e100}}}};
    return list;
}

bool made_in_a_process(const std::string& operation) { return operation == "simplify" || operation == "remesh"; }

void check_operation(const std::string& where, const Recipe& operation, const Numbers& numbers) {
    check_numbers(where, operation, numbers);
    if (operation.name == "simplify" && numbers.size() != 1)
        throw InputError(where + ": simplify needs one of 'ratio' and 'triangles'");
}

LoadedShape derive(const std::string& operation, const Numbers& numbers, const LoadedShape& origin) {
    const auto real = [&](const char* name) { return numbers.at(name); };
    const auto index = [&](const char* name) { return static_cast<Index>(numbers.at(name)); };
    const auto seed = [&] { return static_cast<std::uint64_t>(numbers.at("seed")); };
    const auto mesh = [&]() -> const TriangleMesh& { return mesh_of(origin.shape, operation); };
    const auto* as_mesh = std::get_if<TriangleMesh>(&origin.shape);
    if (const auto* surface = std::get_if<AlgebraicSurface>(&origin.shape)) {
        if (operation != "triangulate")
            throw InputError("operation '" + operation + "' takes no algebraic surface: triangulate it first");
        LoadReport report = origin.report;
        report.format = "derived";
        return {triangulate(*surface, index("cells")), report};
    }
    if (operation == "triangulate")
        throw InputError("operation 'triangulate' takes an algebraic surface, not a mesh or points");
    LoadedShape made{origin.shape, origin.report};
    made.report.format = "derived";
    made.report.polygons = 0;
    made.report.unreferenced = 0;
    Points& points = points_of(made.shape);
    if (operation == "vertices")
        made.shape = PointSet{points_of(origin.shape)};
    else if (operation == "weld")
        made.shape = as_mesh ? Shape(weld(*as_mesh)) : Shape(weld_points(points));
    else if (operation == "sample")
        made.shape = as_mesh ? sample_surface(*as_mesh, index("count"), seed())
                             : choose_points(points_of(origin.shape), index("count"), seed());
    else if (operation == "simplify") {
        const double wanted = numbers.contains("ratio")
                                  ? std::floor(real("ratio") * static_cast<double>(mesh().triangles.rows()))
                                  : real("triangles");
        made.shape = simplify(mesh(), static_cast<Index>(wanted));
    } else if (operation == "remesh")
        made.shape = remesh(mesh(), real("edge") * diagonal(points));
    else if (operation == "quantise")
        quantise(points, real("cells"));
    else if (operation == "noise")
        add_noise(points, real("amplitude") * diagonal(points), seed());
    else if (operation == "subdivide")
        for (Index i = 0; i < index("levels"); ++i) made.shape = subdivide(mesh_of(made.shape, operation));
    else if (operation == "scale")
        points *= real("factor");
    else if (operation == "normalise")
        normalise(points);
    else if (operation == "outlier") {
        if (as_mesh) throw InputError("outlier takes a point set, but its origin is a mesh");
        points.conservativeResize(points.rows() + 1, 3);
        points.row(points.rows() - 1) << real("x"), real("y"), real("z");
    } else if (operation == "translate")
        points.rowwise() += diagonal(points) * Eigen::RowVector3d(real("x"), real("y"), real("z"));
    else if (operation == "rotate")
        points = posed(points, {rotation({real("x"), real("y"), real("z")}, real("t")), Vec3::Zero()});
    else if (operation == "stray")
        made.shape = with_stray(origin.shape, away(real("distance")));
    else if (operation == "two_clusters")
        made.shape = with_copy(origin.shape, away(real("distance")));
    else {
        std::vector<std::string> known;
        for (const Recipe& o : operations()) known.push_back(o.name);
        throw InputError("no operation '" + operation + "'" + nearest_hint(operation, known));
    }
    return made;
}

}  // namespace hausbench
