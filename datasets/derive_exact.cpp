// Operations that are exact if the coordinates have few bits; they make shapes whose distance is known.
#include "datasets/derive.h"

#include "algorithms/error.h"
#include "datasets/random.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <vector>

namespace hausbench {
namespace {

Shape stretched(const Given& g) {
    Points points = g.points();
    for (Eigen::Index i = 0; i < points.rows(); ++i) points.row(i) = points.row(i).cwiseProduct(g.xyz().transpose());
    return with_points(g, points);
}

Shape nudged(const Given& g) {
    Points points = g.points();
    for (Index n = 0; n < g.whole("ulps"); ++n)
        for (Eigen::Index i = 0; i < points.rows(); ++i)
            points(i, 0) = std::nextafter(points(i, 0), std::numeric_limits<double>::infinity());
    return with_points(g, points);
}

// Repeats all elements `count` times. If `vertices` is 1, each copy of a mesh has its own vertices; otherwise all
// copies of its faces use the same vertices.
Shape repeated(const Given& g) {
    const Points& points = g.points();
    const Index count = g.whole("count");
    const bool vertices = g.whole("vertices") == 1;
    constexpr double most = 1e8;
    if (const double elements = double(count) * double(element_count(*g.origin)); elements > most)
        throw InputError(
            fmt::format("repeat: {:.0f} copies have {:.3g} elements, and at most {:.0e} are made: lower 'count'",
                        double(count), elements, most));
    Points all(vertices ? points.rows() * count : points.rows(), 3);
    for (Index i = 0; i < (vertices ? count : 1); ++i)
        all.middleRows(i * points.rows(), points.rows()) =
            ((1 + i * g.real("grow")) * points).rowwise() + i * g.xyz().transpose();
    const auto* mesh = std::get_if<TriangleMesh>(g.origin);
    if (!mesh) return PointSet{all};
    Triangles triangles(mesh->triangles.rows() * count, 3);
    for (Index i = 0; i < count; ++i) {
        const auto shift = static_cast<Index>(vertices ? i * points.rows() : 0);
        triangles.middleRows(i * mesh->triangles.rows(), mesh->triangles.rows()) =
            (mesh->triangles.array() + shift).matrix();
    }
    return TriangleMesh{all, triangles};
}

Shape shuffled(const Given& g) {
    const Points& points = g.points();
    const RandomNumbers random(g.seed());
    const std::vector<Index> order = random_order(points.rows(), random, 0);
    Points moved(points.rows(), 3);
    std::vector<Index> place(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        moved.row(static_cast<Eigen::Index>(i)) = points.row(order[i]);
        place[static_cast<std::size_t>(order[i])] = static_cast<Index>(i);
    }
    const auto* mesh = std::get_if<TriangleMesh>(g.origin);
    if (!mesh) return PointSet{moved};
    const auto after = static_cast<std::uint64_t>(points.rows());
    const std::vector<Index> faces = random_order(mesh->triangles.rows(), random, after);
    Triangles triangles(mesh->triangles.rows(), 3);
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const auto turn = static_cast<int>(random.bits(2 * after + 3 * i) % 3);
        for (int k = 0; k < 3; ++k)
            triangles(static_cast<Eigen::Index>(i), k) =
                place[static_cast<std::size_t>(mesh->triangles(faces[i], (k + turn) % 3))];
    }
    return TriangleMesh{moved, triangles};
}

}  // namespace

std::vector<Recipe> exact_operations() {
    const NumberSpec x = coordinate("x"), y = coordinate("y"), z = coordinate("z");
    const NumberSpec fx{"x"}, fy{"y"}, fz{"z"};  // factors for the coordinates
    return {{"move",
             "by lengths",
             {x, y, z},
             [](const Given& g) { return with_points(g, g.points().rowwise() + g.xyz().transpose()); }},
            {"stretch", "a factor for each coordinate; flattens a mesh into needles and caps", {fx, fy, fz}, stretched},
            {"power",
             "multiplies all coordinates by that power of two; they are rounded only if they become subnormal",
             {whole_number("exponent", -1100, 1100)},
             [](const Given& g) {
                 const int exponent = g.whole("exponent");
                 return with_points(g, g.points().unaryExpr([&](double c) { return std::ldexp(c, exponent); }));
             }},
            {"nudge", "each x becomes the double that many steps above it", {whole_number("ulps", 0, 1e6)}, nudged},
            {"repeat",
             "copies of all elements, each moved on by (`x`, `y`, `z`), and copy i larger by the factor 1 + i `grow`; "
             "with `vertices` 0, only faces are copied",
             {whole_number("count", 1, 1e7), whole_number("vertices", 0, 1), x, y, z, coordinate("grow")},
             repeated},
            {"shuffle",
             "another order of vertices and of faces, and another first corner of each face",
             {seed_number()},
             shuffled},
            {"float32", "each coordinate becomes the nearest float", {}, [](const Given& g) {
                 return with_points(g, g.points().unaryExpr([](double c) { return double(float(c)); }));
             }}};
}

}  // namespace hausbench
