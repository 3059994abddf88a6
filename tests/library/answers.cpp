// Prints answers of the C library to the last bit, a line for each question, so that two builds can be compared: other
// compilers, instruction sets or processors must print the same text (tools/same_bits).
#include <hausbench.hpp>

#include <array>
#include <cfenv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using Vertices = std::vector<std::array<double, 3>>;
using Faces = std::vector<std::array<std::int64_t, 3>>;

// Numbers that are the same everywhere: integers of 31 bits, scaled by powers of two.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15U + 1) {}
    double between(double low, double high) { return low + (high - low) * std::ldexp(double(next()), -31); }
    std::uint64_t next() {
        state_ = state_ * 6364136223846793005U + 1442695040888963407U;
        return state_ >> 33;
    }

private:
    std::uint64_t state_;
};

struct Mesh {
    Vertices vertices;
    Faces faces;
};

// A grid of n x n squares with a bumpy height, whose side is `size`, far from the origin by `away`.
Mesh sheet(std::int64_t n, double size, double bump, double away, std::uint64_t seed) {
    Random random(seed);
    Mesh mesh;
    for (std::int64_t y = 0; y <= n; ++y)
        for (std::int64_t x = 0; x <= n; ++x)
            mesh.vertices.push_back(
                {away + size * double(x) / double(n), size * double(y) / double(n), bump * random.between(-1, 1)});
    for (std::int64_t y = 0; y < n; ++y) {
        for (std::int64_t x = 0; x < n; ++x) {
            const std::int64_t v = y * (n + 1) + x;
            mesh.faces.push_back({v, v + 1, v + n + 1});
            mesh.faces.push_back({v + 1, v + n + 2, v + n + 1});
        }
    }
    return mesh;
}

// Triangles without a common vertex; each is a needle whose height is `thin` of its length, if `thin` is less than 1.
Mesh soup(std::int64_t triangles, double size, double thin, std::uint64_t seed) {
    Random random(seed);
    Mesh mesh;
    for (std::int64_t t = 0; t < triangles; ++t) {
        std::array<std::array<double, 3>, 3> corners{};
        for (auto& corner : corners)
            for (double& x : corner) x = size * random.between(-1, 1);
        if (thin < 1)
            for (int i = 0; i < 3; ++i) corners[2][i] = corners[1][i] + thin * (corners[2][i] - corners[0][i]);
        for (const auto& corner : corners) mesh.vertices.push_back(corner);
        mesh.faces.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

hausbench::Shape shape_of(const Mesh& mesh) { return {mesh.vertices, mesh.faces}; }

void print(const char* question, const hausbench::Answer& answer) {
    std::printf("  %s: status %d, [%a, %a], rows %lld %lld, at", question, answer.status, answer.bounds.lower,
                answer.bounds.upper, static_cast<long long>(answer.source_row),
                static_cast<long long>(answer.target_row));
    for (const double x : answer.source_point) std::printf(" %a", x);
    for (const double x : answer.target_point) std::printf(" %a", x);
    std::printf("\n");
}

// Asks, and prints the answer or the code of the error; a solver may not know the quantity.
template <class Ask> void ask(const char* question, const Ask& answer) {
    try {
        answer();
    } catch (const hausbench::Error& error) {
        std::printf("  %s: error %d\n", question, error.code());
    }
}

void ask_all(const char* scene, const hausbench::Shape& a, const hausbench::Shape& b, const std::string& solver) {
    std::printf("%s, %s\n", scene, solver.c_str());
    hausbench::Plan plan;
    plan.solver = solver.c_str();
    hausbench::Query query, turned;
    query.tolerance = turned.tolerance = 1e-3;
    query.share_tolerance = 1e-2;
    turned.source_pose = {0.6, -0.8, 0, 0.125, 0.8, 0.6, 0, -0.25, 0, 0, 1, 0.0625, 0, 0, 0, 1};
    ask("prepare", [&] {
        const hausbench::Pair pair(a, b, plan);
        hausbench::Answer h;
        ask("directed", [&] { print("directed", h = pair.directed(query)); });
        ask("turned", [&] { print("turned", pair.directed(turned)); });
        ask("symmetric", [&] { print("symmetric", pair.symmetric(query)); });
        ask("within", [&] { print("within", pair.within(0.75 * h.bounds.upper, query)); });
        ask("distribution", [&] {
            for (const auto& value : pair.distribution({"mean", "rms", "quantile 0.9", "within 0.25"}, query).values)
                std::printf("  statistic [%a, %a]\n", value.lower, value.upper);
        });
        ask("field", [&] {
            const hausbench::Field field = pair.field(query);
            for (std::size_t v = 0; v < field.values.size(); v += 7)
                std::printf("  vertex %zu: [%a, %a], row %lld\n", v, field.values[v].lower, field.values[v].upper,
                            static_cast<long long>(field.nearest[v]));
        });
    });
}

}  // namespace

int main() {
    for (const std::string& solver : hausbench::solvers()) {
        const auto ask_of = [&](const char* scene, const Mesh& a, const Mesh& b) {
            ask_all(scene, shape_of(a), shape_of(b), solver);
        };
        ask_of("sheets", sheet(20, 1, 0.05, 0, 1), sheet(17, 1, 0.05, 0, 2));
        const Mesh a = sheet(9, 1, 0.05, 0, 1), b = sheet(8, 1, 0.05, 0, 2);
        std::fesetround(FE_UPWARD);  // the answers do not depend on it
        ask_of("sheets, rounding upward", a, b);
        std::fesetround(FE_TONEAREST);
        ask_of("far sheets", sheet(9, 1, 0.05, 1e6, 3), sheet(8, 1, 0.05, 1e6, 4));
        ask_of("tiny soup", soup(12, 1e-9, 1, 5), soup(15, 1e-9, 1, 6));
        ask_of("needles", soup(40, 1, 1e-9, 7), soup(40, 1, 1e-9, 8));
        ask_of("huge soup", soup(12, 1e100, 1, 9), soup(15, 1e100, 1, 10));
        const Mesh many = soup(700, 1, 1, 11), others = soup(600, 1, 1, 12);
        ask_all("points", hausbench::Shape(many.vertices), hausbench::Shape(others.vertices), solver);
        ask_all("mesh and points", shape_of(soup(30, 1, 1, 13)), hausbench::Shape(others.vertices), solver);
    }
}
