// Gives two small shapes to every certified solver that accepts them. All intervals must overlap, and
// agree with the exact distance d of the farthest vertex or centroid of A: upper >= d, and
// lower <= d + A's longest edge. For point sets, d is h.
#include "algorithms/kernel/triangle.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "tests/fuzz/coordinates.h"
#include "tests/fuzz/exact_distance.h"
#include "tests/support/exact.h"
#include "tests/support/quick_options.h"
#include "tests/support/scenes.h"

#include <ctime>

namespace hausbench::fuzz {
namespace {

using exact::Rational;

constexpr double most_seconds = 5;  // CPU time of a solve; a longer one counts as a hang

struct Case {
    Scene scene;
    Query query;
    std::uint32_t variant;
};

// Returns 1 in a quarter of the cases, otherwise 2^-k for a k up to 1074; 2^-1074 is the smallest positive double.
double own_size(Bytes& in) {
    const int k = in.next<std::uint16_t>() % 1433;
    return k <= 1074 ? std::ldexp(1.0, -k) : 1;
}

// Makes points or triangles. With `sizes`, each gets its own size; otherwise all have size 1.
Shape shape_of(bool points, std::uint32_t count, double scale, const Vec3& offset, Coordinates& coordinates,
               Bytes* sizes) {
    Points all(static_cast<Index>(points ? count : 3 * count), 3);
    double size = 1;
    for (Index i = 0; i < all.rows(); ++i) {
        if (sizes && (points || i % 3 == 0)) size = own_size(*sizes);
        all.row(i) = scale * (size * coordinates.point() + offset);
    }
    if (points) return PointSet{all};
    return soup(all);
}

Case decode(Bytes& in) {
    const std::uint32_t kinds = in.byte(), counts = in.byte();
    const std::uint32_t variant = in.byte();
    const double scale = kinds & 16 ? std::ldexp(1.0, static_cast<int>(in.next<std::uint16_t>() % 1201) - 600) : 1;
    const Vec3 offset = kinds & 32 ? Vec3(1e8, -1e8, 3e7) : Vec3::Zero();
    const double part = std::ldexp(1.0, -static_cast<int>(in.below(40)));
    Coordinates coordinates(in);
    const bool points = kinds & 1;
    Bytes* const sizes = kinds & 128 ? &in : nullptr;
    Shape a = shape_of(points, 1 + counts % 12, scale, offset, coordinates, sizes);
    Shape b = kinds & 8 ? a : shape_of(points, 1 + counts / 12 % 12, scale, offset, coordinates, sizes);
    Query query;
    if (kinds & 2) query.quantity = Quantity::symmetric;
    const double extent = std::max(magnitude(points_of(a)), magnitude(points_of(b)));
    const double least = 1e-3 * part * (extent > 0 ? extent : 1);
    query.tolerance = kinds & 4 ? Tolerance{Tolerance::Of::lower, std::max(part, 1e-9)}
                                : Tolerance{Tolerance::Of::absolute, std::max(least, 0x1p-1070)};
    query.budget = 300;
    if (kinds & 64) {
        Coordinates moves(in);
        query.source_pose = turned(0.6, 0.8, scale / 8 * moves.point());
    }
    return {{std::move(a), std::move(b)}, query, variant};
}

// Returns the largest squared distance from a vertex or centroid of `a` to `b`.
Rational squared_at_samples(const Shape& a, const Shape& b) {
    Rational most = 0;
    for (Index i = 0; i < points_of(a).rows(); ++i)
        most = std::max(most, squared_to(exact::vector(points_of(a).row(i)), b));
    if (kind_of(a) == ShapeKind::points) return most;
    for (Index t = 0; t < mesh_of(a).triangles.rows(); ++t) {
        const Triangle v = triangle_of(mesh_of(a), t);
        const exact::RVec3 x = exact::vector(v.a), y = exact::vector(v.b), z = exact::vector(v.c);
        most = std::max(most,
                        squared_to({(x[0] + y[0] + z[0]) / 3, (x[1] + y[1] + z[1]) / 3, (x[2] + y[2] + z[2]) / 3}, b));
    }
    return most;
}

// Returns the squared longest edge. No point of a triangle is farther than this from its corners.
Rational squared_longest_edge(const Shape& a) {
    Rational most = 0;
    if (kind_of(a) == ShapeKind::points) return most;
    for (Index t = 0; t < mesh_of(a).triangles.rows(); ++t) {
        const Triangle v = triangle_of(mesh_of(a), t);
        const exact::RVec3 x = exact::vector(v.a), y = exact::vector(v.b), z = exact::vector(v.c);
        most = std::max(
            {most, exact::squared_distance(x, y), exact::squared_distance(y, z), exact::squared_distance(z, x)});
    }
    return most;
}

struct Known {
    Rational at_samples;    // squared; at most h^2
    Rational longest_edge;  // squared; h <= sqrt(at_samples) + sqrt(longest_edge)
};

Known measured(const Case& problem) {
    const auto moved = [](const Shape& shape, const Pose& pose) {
        Shape copy = shape;
        points_of(copy) = posed(points_of(copy), pose);
        return copy;
    };
    const Shape a = moved(problem.scene.source, problem.query.source_pose), b = problem.scene.target;
    Known all{squared_at_samples(a, b), squared_longest_edge(a)};
    if (problem.query.quantity == Quantity::symmetric) {
        all.at_samples = std::max(all.at_samples, squared_at_samples(b, a));
        all.longest_edge = std::max(all.longest_edge, squared_longest_edge(b));
    }
    return all;
}

// Returns whether x <= sqrt(a) + sqrt(b) for x >= 0, that is x^2 - a - b <= 2 sqrt(a b).
bool at_most_sum(const Rational& x, const Rational& a, const Rational& b) {
    const Rational left = x * x - a - b;
    return left <= 0 || left * left <= 4 * a * b;
}

bool legal(const Query& query, const Result& result) {
    const Bounds& bounds = result.bounds;
    switch (result.status) {
        case Status::converged:
            return bounds.gap() <= query.tolerance.gap(bounds.lower);
        case Status::below_floor:
        case Status::above_cutoff:
        case Status::time_limit:
            return false;  // the query sets no floor, cutoff or time limit
        case Status::budget:
        case Status::precision_floor:
        case Status::stalled:
            return true;
    }
    return false;
}

void check(const Query& query, const Result& result, const Known& truth, const std::string& who) {
    const Bounds& bounds = result.bounds;
    expect(bounds.lower >= 0 && std::isfinite(bounds.lower) && bounds.upper >= bounds.lower,
           who + ": bounds that are none");
    expect(legal(query, result), who + ": a status that does not fit: " + std::string(to_string(result.status)));
    if (std::isfinite(bounds.upper)) {
        const Rational upper = bounds.upper;
        expect(upper * upper >= truth.at_samples, who + ": the upper bound is below a sample");
    }
    expect(at_most_sum(Rational(bounds.lower), truth.at_samples, truth.longest_edge),
           who + ": the lower bound is too large");
}

std::vector<std::pair<const SolverEntry*, std::vector<Options>>> certified(ShapeKind kind) {
    std::vector<std::pair<const SolverEntry*, std::vector<Options>>> all;
    for (const SolverEntry& entry : solvers()) {
        if (!entry.info.certified || !entry.info.source.contains(kind) || !entry.info.target.contains(kind) ||
            !entry.info.offers(Quantity::directed))
            continue;
        std::vector<Options> options;
        for (const ParameterMap& given : variants_of(entry)) {
            const Options quick = quick_options(entry, given);
            if (entry.make(quick)->certified()) options.push_back(quick);
        }
        if (!options.empty()) all.emplace_back(&entry, options);
    }
    return all;
}

void solvers_agree(const Case& problem) {
    static const auto of_points = certified(ShapeKind::points), of_meshes = certified(ShapeKind::mesh);
    const Known truth = measured(problem);
    double greatest_lower = 0, least_upper = std::numeric_limits<double>::infinity();
    QuerySet queries;
    queries.moves = !problem.query.source_pose.is_identity();
    queries.symmetric = problem.query.quantity == Quantity::symmetric;
    std::uint32_t turn = problem.variant;
    for (const auto& [entry, options] : kind_of(problem.scene.source) == ShapeKind::points ? of_points : of_meshes) {
        const Options& chosen = options[turn++ % options.size()];
        std::string who = entry->info.name;
        for (const auto& [name, value] : chosen.values()) who += " " + name + "=" + to_string(value);
        Trace trace;
        const std::clock_t begin = std::clock();
        const Result result = Session(*entry, chosen, problem.scene, queries).solve(problem.query, trace);
        const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        expect(seconds < most_seconds, who + ": takes " + std::to_string(seconds) + " s");
        check(problem.query, result, truth, who);
        greatest_lower = std::max(greatest_lower, result.bounds.lower);
        least_upper = std::min(least_upper, result.bounds.upper);
        expect(greatest_lower <= least_upper, who + ": its interval and another do not overlap");
    }
}

void differential(std::string_view bytes) {
    Bytes in(bytes);
    try {
        solvers_agree(decode(in));
    } catch (const InputError& error) {  // a pose leaves the range of doubles
        expect_one_line(error);
    }
}

}  // namespace

}  // namespace hausbench::fuzz

HAUSBENCH_FUZZ_TARGET(differential)
