// Monte Carlo: statistics of the distance from random points of A, as Metro and MeshLab sample (Cignoni, Rocchini,
// Scopigno 1998), with statistical intervals (ours; Metro prints none). The rival of `distribution`.
//
// Draws points uniformly by area (of line segments alone: by length; of a point set: points) until the 95 % intervals of all statistics are within the
// tolerance. The intervals are the usual ones for many samples, by the central limit theorem:
// - mean m of n samples with standard deviation s: m +- 1.96 s / sqrt(n); the same for the mean of d^2, whose root is
//   the rms, and of (d - m)^2, whose root is the deviation;
// - share p: p +- 1.96 sqrt(p (1 - p) / n), Wilson's form;
// - quantile of level p: from the sample at n p - 1.96 sqrt(n p (1 - p)) to that at n p + 1.96 sqrt(n p (1 - p));
// - maximum: refused, because samples give no upper bound.
// So about one interval in 20 does not contain the value, and rare far parts of A make more of them wrong. Nothing here
// is certified. Only statistics over A are offered.
//
// The points of a batch are drawn together and visited in the order of the triangles of A, so that each search starts at
// the triangle of B that was nearest to the point before. The unit of Query::budget is one sample. Time: logarithmic in
// the size of B for each sample. Memory: 8 bytes a sample.
#include "algorithms/error.h"
#include "algorithms/kernel/deadline.h"
#include "algorithms/kernel/rounding.h"
#include "algorithms/kernel/splitmix.h"
#include "algorithms/kernel/triangle.h"
#include "algorithms/solver.h"
#include "algorithms/structures/triangle_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace hausbench::monte_carlo {
namespace {

constexpr double z = 1.96;  // 95 % of a normal distribution lie within this many standard deviations
constexpr std::size_t first_batch = 4096, most_of_batch = 1 << 20, most_samples = 200'000'000;

class Drawing {
public:
    Drawing(const TriangleMesh& source, const Points& points, const TriangleBlocks& target, CountedBy by,
            std::uint64_t seed)
        : source_(source), points_(points), target_(target), by_(by), seed_(seed) {
        double sum = 0;
        for (Index i = 0; i < source.triangles.rows(); ++i) {
            const Triangle t = triangle(i);
            sums_.push_back(sum += by == CountedBy::points ? 1
                                   : by == CountedBy::area ? (t.b - t.a).cross(t.c - t.a).norm()
                                                           : (end_of(t) - t.a).norm());
        }
    }

    bool empty() const { return !(sums_.back() > 0); }

    // Adds samples until there are `count`, batch by batch. Returns false if the deadline passed, without the samples of
    // the unfinished batch: a batch visits A triangle by triangle, so its first part covers only some triangles.
    bool draw(std::size_t count, const Deadline& deadline, Counters& counters) {
        while (distances_.size() < count) {
            const std::size_t before = distances_.size();
            if (!draw_batch(std::min(count - before, most_of_batch), deadline, counters)) {
                distances_.resize(before);
                return false;
            }
        }
        return true;
    }

    std::vector<double>& distances() { return distances_; }

private:
    bool draw_batch(std::size_t count, const Deadline& deadline, Counters& counters) {
        std::vector<double> places;
        for (std::size_t i = 0; i < count; ++i) places.push_back(uniform() * sums_.back());
        std::sort(places.begin(), places.end());
        Index at = 0, near = -1;
        for (const double place : places) {
            if (distances_.size() % 256 == 0 && deadline.passed()) return false;
            while (at + 1 < source_.triangles.rows() && sums_[static_cast<std::size_t>(at)] <= place) ++at;
            const Triangle t = triangle(at);
            const double root = std::sqrt(uniform()), part = uniform();
            Vec3 p = (1 - root) * t.a + root * (1 - part) * t.b + root * part * t.c;
            if (by_ == CountedBy::length) p = (1 - part) * t.a + part * end_of(t);
            ClosestHints hints;
            hints.warm_triangle = near;
            const ClosestPoint closest = target_.closest(p, hints, counters);
            near = closest.triangle;
            distances_.push_back(std::sqrt(closest.squared_distance));
        }
        return true;
    }

    static const Vec3& end_of(const Triangle& segment) { return segment.b != segment.a ? segment.b : segment.c; }

    double uniform() { return static_cast<double>(splitmix(seed_ + ++drawn_ * golden_step) >> 11) * 0x1p-53; }
    Triangle triangle(Index i) const {
        const auto v = source_.triangles.row(i);
        return {points_.row(v[0]), points_.row(v[1]), points_.row(v[2])};
    }

    const TriangleMesh& source_;
    const Points& points_;
    const TriangleBlocks& target_;
    CountedBy by_;
    std::uint64_t seed_, drawn_ = 0;
    std::vector<double> sums_;  // of the weights of the triangles up to each
    std::vector<double> distances_;
};

// Returns the 95 % interval of the mean of value(d).
template <class Value> Bounds mean_of(const std::vector<double>& distances, const Value& value) {
    const double n = static_cast<double>(distances.size());
    double sum = 0, squares = 0;
    for (const double d : distances) sum += value(d);
    const double mean = sum / n;
    for (const double d : distances) squares += (value(d) - mean) * (value(d) - mean);
    const double off = z * std::sqrt(squares / (n - 1) / n);
    return {std::max(0.0, mean - off), mean + off};
}

Bounds root_of(const Bounds& square) { return {std::sqrt(square.lower), std::sqrt(square.upper)}; }

// Returns the 95 % interval of a statistic. Changes the order of the samples.
Bounds interval_of(const Statistic& statistic, std::vector<double>& distances) {
    const double n = static_cast<double>(distances.size()), p = statistic.argument;
    switch (statistic.kind) {
        case Statistic::Kind::mean:
            return mean_of(distances, [](double d) { return d; });
        case Statistic::Kind::rms:
            return root_of(mean_of(distances, [](double d) { return d * d; }));
        case Statistic::Kind::deviation: {
            const Bounds mean = mean_of(distances, [](double d) { return d; });
            const double about = 0.5 * (mean.lower + mean.upper);
            return root_of(mean_of(distances, [&](double d) { return (d - about) * (d - about); }));
        }
        case Statistic::Kind::maximum:
            break;  // refused
        case Statistic::Kind::quantile: {
            const double off = z * std::sqrt(n * p * (1 - p));
            const auto at = [&](double place) {
                if (place < 0) return 0.0;
                if (place >= n) return infinity;
                const auto k = static_cast<std::ptrdiff_t>(place);
                std::nth_element(distances.begin(), distances.begin() + k, distances.end());
                return distances[static_cast<std::size_t>(k)];
            };
            return {at(std::floor(n * p - off) - 1), at(std::ceil(n * p + off))};
        }
        case Statistic::Kind::share_within: {
            const double share = static_cast<double>(std::count_if(distances.begin(), distances.end(),
                                                                   [&](double d) { return d <= p; })) /
                                 n;
            const double middle = (share + z * z / (2 * n)) / (1 + z * z / n);
            const double off = z / (1 + z * z / n) * std::sqrt(share * (1 - share) / n + z * z / (4 * n * n));
            return {std::max(0.0, middle - off), std::min(1.0, middle + off)};
        }
    }
    return {};
}

class MonteCarlo final : public Solver {
public:
    explicit MonteCarlo(const Options& options) : seed_(static_cast<std::uint64_t>(options.integer("seed"))) {}

    Needs needs(const Scene&, const QuerySet&) const override { return {need<TriangleBlocks>(Side::target)}; }

    void prepare(const Scene& scene, const Prepared& prepared) override {
        source_ = &prepared.triangles(Side::source);
        target_ = &prepared.get<TriangleBlocks>(Side::target);
        by_ = counted_by(scene.source);
    }

    Result solve(const Query& query, State*, Trace&) const override {
        refuse(query);
        Result result;
        for (const Statistic& statistic : query.statistics)
            result.statistics.push_back(is_share(statistic) ? Bounds{0, 1} : Bounds{});
        const Points points = posed(source_->vertices, query.source_pose);
        if (!(magnitude(points) <= largest_safe_magnitude)) return result;
        const Deadline deadline = query.deadline();
        const std::uint64_t most = std::min<std::uint64_t>(query.budget, most_samples);
        Drawing drawing(*source_, points, *target_, by_, splitmix(seed_ + golden_step));
        if (drawing.empty()) return result;
        for (std::uint64_t count = std::min<std::uint64_t>(first_batch, most); count > 1;) {
            const bool all = drawing.draw(count, deadline, result.counters);
            if (drawing.distances().size() < 2) {
                result.status = Status::time_limit;
                break;
            }
            for (std::size_t i = 0; i < query.statistics.size(); ++i)
                result.statistics[i] = interval_of(query.statistics[i], drawing.distances());
            if (query.within_tolerance(result.statistics))
                result.status = Status::converged;
            else if (!all)
                result.status = Status::time_limit;
            else if (count >= most)
                result.status = Status::budget;
            if (result.status != Status::stalled) break;
            // Intervals shrink like 1 / sqrt(n), so this many more are needed, with a tenth to spare.
            double ratio = 1;
            for (std::size_t i = 0; i < query.statistics.size(); ++i) {
                const Bounds& bounds = result.statistics[i];
                ratio = std::max(ratio, bounds.gap() / query.allowed_gap(query.statistics[i], bounds.lower));
            }
            const double next = static_cast<double>(count) * std::clamp(1.1 * ratio * ratio, 1.1, 16.0);
            count = std::min(most, static_cast<std::uint64_t>(next) + 1);
        }
        result.reported["samples"] = static_cast<double>(drawing.distances().size());
        return result;
    }

private:
    // Throws InputError for what samples cannot bound, however many there are.
    void refuse(const Query& query) const {
        const auto fail = [](const std::string& what) {
            throw InputError(fmt::format("solver 'monte_carlo' {}, or take solver 'distribution'", what));
        };
        for (const Statistic& statistic : query.statistics) {
            if (needs_target(statistic))
                fail(fmt::format("has only statistics over A: leave out '{}'", to_string(statistic)));
            if (statistic.kind == Statistic::Kind::maximum ||
                (statistic.kind == Statistic::Kind::quantile && statistic.argument >= 1))
                fail(fmt::format("draws samples, which give no upper bound on the largest distance: leave out '{}'",
                                 to_string(statistic)));
        }
        if (query.weigh == WeighBy::number && by_ != CountedBy::points)
            fail("weighs by area: leave out the weighing by vertex");
    }

    const TriangleMesh* source_ = nullptr;
    const TriangleBlocks* target_ = nullptr;
    CountedBy by_ = CountedBy::area;
    std::uint64_t seed_;
};

}  // namespace

SolverEntry solver() {
    SolverInfo info;
    info.name = "monte_carlo";
    info.title = "Monte Carlo (95 %)";
    info.paper = "cignoni1998";
    info.source.mesh = info.source.points = info.target.mesh = info.target.points = true;
    info.quantities = {Quantity::distribution};
    info.may_need = {need<TriangleBlocks>(Side::target)};
    info.parameters = {{.name = "seed",
                        .default_value = std::int64_t{1},
                        .description = "of the random numbers",
                        .least = 0,
                        .most = 1e9}};
    return {info, make_solver<MonteCarlo>};
}

}  // namespace hausbench::monte_carlo
