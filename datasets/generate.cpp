#include "datasets/generate.h"

#include "algorithms/error.h"
#include "datasets/circle.h"
#include "datasets/derive.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace hausbench {
namespace {

// Returns the point of the unit circle after k/n of a turn, 0 <= k < n. Reduces the angle to an eighth of a turn
// exactly, in integers, and then uses the Taylor series.
Circle circle_point(std::int64_t k, std::int64_t n) {
    const std::int64_t eighth = 8 * k / n;         // 0..7
    const std::int64_t rest = 8 * k - eighth * n;  // position within the eighth, in units of 1/n
    const bool mirrored = eighth % 2 == 1;         // in an odd eighth, the angle is measured back from its end
    const double part = static_cast<double>(mirrored ? n - rest : rest) / static_cast<double>(n);
    Circle point = circle_near_zero(part * 0.78539816339744830961);
    if (mirrored) std::swap(point.cosine, point.sine);
    point = turned(point, static_cast<int>(eighth / 2));
    return {point.cosine + 0.0, point.sine + 0.0};  // + 0.0 turns -0 into +0
}

class MeshBuilder {
public:
    Index vertex(double x, double y, double z) {
        points_.push_back({x, y, z});
        return static_cast<Index>(points_.size() - 1);
    }
    void triangle(Index a, Index b, Index c) { triangles_.push_back({a, b, c}); }
    void square(Index a, Index b, Index c, Index d) {  // corners in cyclic order; split from a to c
        triangle(a, b, c);
        triangle(a, c, d);
    }
    // Adds the squares of a grid whose vertices are numbered row by row and whose last row and column are joined to the
    // first ones.
    void closed_grid(Index rows, Index columns) {
        for (Index i = 0; i < rows; ++i)
            for (Index j = 0; j < columns; ++j) {
                const Index i1 = (i + 1) % rows, j1 = (j + 1) % columns;
                square(i * columns + j, i1 * columns + j, i1 * columns + j1, i * columns + j1);
            }
    }
    TriangleMesh mesh() const {
        return {
            Eigen::Map<const Points>(points_.front().data(), static_cast<Eigen::Index>(points_.size()), 3),
            Eigen::Map<const Triangles>(triangles_.front().data(), static_cast<Eigen::Index>(triangles_.size()), 3)};
    }

private:
    std::vector<std::array<double, 3>> points_;
    std::vector<std::array<Index, 3>> triangles_;
};

void move_to_unit_sphere(Points& points) {
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        const double x = points(v, 0), y = points(v, 1), z = points(v, 2);
        const double length = std::sqrt(x * x + y * y + z * z);
        points.row(v) << x / length, y / length, z / length;
    }
}

TriangleMesh icosphere(const Given& g) {
    const double golden = (1 + std::sqrt(5.0)) / 2;
    std::vector<Vec3> corners;
    for (const double a : {-1.0, 1.0})
        for (const double b : {-golden, golden}) {
            corners.emplace_back(0, a, b);
            corners.emplace_back(a, b, 0);
            corners.emplace_back(b, 0, a);
        }
    // Three corners form a face if their distances are all an edge length, which is 2. The next larger distance is 3.2,
    // so a squared distance below 5 means an edge.
    const auto joined = [&](std::size_t i, std::size_t j) { return (corners[i] - corners[j]).squaredNorm() < 5; };
    MeshBuilder builder;
    for (const Vec3& p : corners) builder.vertex(p.x(), p.y(), p.z());
    for (std::size_t i = 0; i < corners.size(); ++i)
        for (std::size_t j = i + 1; j < corners.size(); ++j)
            for (std::size_t k = j + 1; k < corners.size(); ++k) {
                if (!joined(i, j) || !joined(j, k) || !joined(k, i)) continue;
                const bool outward = (corners[j] - corners[i]).cross(corners[k] - corners[i]).dot(corners[i]) > 0;
                builder.triangle(static_cast<Index>(i), static_cast<Index>(outward ? j : k),
                                 static_cast<Index>(outward ? k : j));
            }
    TriangleMesh mesh = builder.mesh();
    move_to_unit_sphere(mesh.vertices);
    for (int i = 0; i < g.whole("level"); ++i) {
        mesh = subdivide(mesh);
        move_to_unit_sphere(mesh.vertices);
    }
    mesh.vertices *= g.real("radius");
    return mesh;
}

TriangleMesh cube(const Given& g) {
    const int n = g.whole("subdivisions");
    MeshBuilder builder;
    std::map<std::array<int, 3>, Index> numbers;
    const auto at = [&](std::array<int, 3> place) {
        const auto [entry, fresh] = numbers.try_emplace(place, 0);
        const auto coordinate = [&](int i) { return static_cast<double>(i) / n - 0.5; };
        if (fresh) entry->second = builder.vertex(coordinate(place[0]), coordinate(place[1]), coordinate(place[2]));
        return entry->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int side : {0, n})
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const auto corner = [&](int di, int dj) {
                        std::array<int, 3> place{};
                        place[axis] = side;
                        place[(axis + 1) % 3] = i + di;
                        place[(axis + 2) % 3] = j + dj;
                        return at(place);
                    };
                    const Index a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
                    if (side == 0)
                        builder.square(a, d, c, b);
                    else
                        builder.square(a, b, c, d);
                }
    return builder.mesh();
}

TriangleMesh torus(const Given& g) {
    const int rings = g.whole("rings"), sides = g.whole("sides");
    const double major = g.real("major"), minor = g.real("minor");
    MeshBuilder builder;
    for (int i = 0; i < rings; ++i) {
        const Circle around = circle_point(i, rings);
        for (int j = 0; j < sides; ++j) {
            const Circle tube = circle_point(j, sides);
            const double distance = major + minor * tube.cosine;
            builder.vertex(distance * around.cosine, distance * around.sine, minor * tube.sine);
        }
    }
    builder.closed_grid(rings, sides);
    return builder.mesh();
}

// Sweeps a rectangle, which extends from the bore to the rim, around the axis. The rim follows the teeth: a quarter of
// each tooth is its tip and a quarter is its root, with straight flanks between them.
TriangleMesh gear(const Given& g) {
    const int steps = g.whole("steps"), rings = g.whole("rings"), layers = g.whole("layers");
    const double outer = g.real("outer"), root = g.real("root"), bore = g.real("bore"), height = g.real("height");
    const auto rim = [&](int step) {
        const double phase = 4.0 * step / steps;  // tip, flank, root, flank
        if (phase <= 1) return outer;
        if (phase < 2) return outer + (root - outer) * (phase - 1);
        if (phase <= 3) return root;
        return root + (outer - root) * (phase - 3);
    };
    const int around = g.whole("teeth") * steps;
    MeshBuilder builder;
    for (int i = 0; i < around; ++i) {
        const Circle turn = circle_point(i, around);
        const auto vertex = [&](double part, double z) {
            const double radius = bore + (rim(i % steps) - bore) * part;
            builder.vertex(radius * turn.cosine, radius * turn.sine, height * (z - 0.5));
        };
        for (int j = 0; j < rings; ++j) vertex(static_cast<double>(j) / rings, 0);
        for (int j = 0; j < layers; ++j) vertex(1, static_cast<double>(j) / layers);
        for (int j = rings; j > 0; --j) vertex(static_cast<double>(j) / rings, 1);
        for (int j = layers; j > 0; --j) vertex(0, static_cast<double>(j) / layers);
    }
    builder.closed_grid(around, 2 * (rings + layers));
    return builder.mesh();
}

TriangleMesh plane(const Given& g) {
    const int n = g.whole("n");
    const double z = g.real("z");
    MeshBuilder builder;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j)
            builder.vertex(static_cast<double>(i) / n - 0.5, static_cast<double>(j) / n - 0.5, z);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const Index a = i * (n + 1) + j, b = a + n + 1;
            builder.square(a, b, b + 1, a + 1);
        }
    return builder.mesh();
}

TriangleMesh needle(const Given& g) {
    MeshBuilder builder;
    builder.vertex(-0.5, 0, 0);
    builder.vertex(0.5, 0, 0);
    builder.vertex(0, 1 / g.real("ratio"), 0);
    builder.triangle(0, 1, 2);
    return builder.mesh();
}

TriangleMesh fan(const Given& g) {
    const Index n = g.whole("triangles");
    MeshBuilder builder;
    for (Index i = 0; i < n; ++i) {
        const Circle at = circle_point(i, n);
        builder.vertex(at.cosine, at.sine, 0);
    }
    const Index hub = builder.vertex(0, 0, g.real("height"));
    for (Index i = 0; i < n; ++i) builder.triangle(i, (i + 1) % n, hub);
    return builder.mesh();
}

}  // namespace

const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> list = [] {
        std::vector<Recipe> all = {
            {"icosphere",
             "an icosahedron, each triangle split in four `level` times, with vertices moved to the sphere; 20 "
             "4^`level` triangles",
             {whole_number("level", 0, 10), length("radius")},
             icosphere},
            {"cube",
             "edge 1 around the origin, n x n squares on each side; 12 n^2 triangles (n = `subdivisions`)",
             {whole_number("subdivisions", 1, 4096)},
             cube},
            {"torus",
             "around the z axis, with these radii; 2 `rings` `sides` triangles",
             {whole_number("rings", 3, 16384), whole_number("sides", 3, 16384), length("major"), length("minor")},
             torus},
            {"gear",
             "a spur gear around the z axis with a bore: `steps` vertices along a tooth, `rings` from bore to rim, "
             "`layers` along the height; closed, 4 `teeth` `steps` (`rings` + `layers`) triangles",
             {whole_number("teeth", 3, 4096), whole_number("steps", 4, 4096), whole_number("rings", 1, 4096),
              whole_number("layers", 1, 4096), length("outer"), length("root"), length("bore"), length("height")},
             gear},
            {"plane",
             "a square of edge 1 around the z axis at height `z`, n x n squares; 2 n^2 triangles",
             {whole_number("n", 1, 16384), coordinate("z")},
             plane},
            {"needle",
             "one triangle with a base of length 1 along x and a height of 1 / `ratio` along y",
             {length("ratio")},
             needle},
            {"fan",
             "triangles around one vertex that lies `height` above the centre of a circle of radius 1",
             {whole_number("triangles", 3, 1e7), coordinate("height")},
             fan}};
        const std::vector<Recipe> points = point_recipes();
        all.insert(all.end(), points.begin(), points.end());
        return all;
    }();
    return list;
}

namespace {

// Throws InputError. The message becomes one line, because names in it may come from strings with line breaks.
[[noreturn]] void refuse(std::string why) { throw InputError(one_line(std::move(why))); }

}  // namespace

const Recipe& find_recipe(const std::vector<Recipe>& list, const std::string& name, const std::string& what) {
    for (const Recipe& recipe : list)
        if (recipe.name == name) return recipe;
    refuse(fmt::format("{} '{}'{}", what, name, nearest_hint(name, names_of(list))));
}

void check_numbers(const std::string& where, const Recipe& recipe, const Numbers& numbers) {
    const std::vector<std::string> names = names_of(recipe.numbers);
    for (const auto& [name, value] : numbers)
        if (std::find(names.begin(), names.end(), name) == names.end())
            refuse(fmt::format("{}: {} takes no number '{}'{}", where, recipe.name, name, nearest_hint(name, names)));
    for (const NumberSpec& spec : recipe.numbers) {
        const auto entry = numbers.find(spec.name);
        if (entry == numbers.end()) {
            if (spec.required) refuse(fmt::format("{}: {} needs the number '{}'", where, recipe.name, spec.name));
            continue;
        }
        const double value = entry->second;
        if (!(value >= spec.least && value <= spec.most))
            refuse(
                fmt::format("{}: {} is {}, but must lie in {} .. {}", where, spec.name, value, spec.least, spec.most));
        if (spec.whole && value != std::floor(value))
            refuse(fmt::format("{}: {} is {}, but must be an integer", where, spec.name, value));
    }
}

Shape generate(const std::string& recipe, const Numbers& numbers) {
    return find_recipe(recipes(), recipe, "no recipe").make({numbers});
}

}  // namespace hausbench
