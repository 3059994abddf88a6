#include "harness/check/verify_statistics.h"

#include "algorithms/error.h"
#include "algorithms/kernel/watched.h"
#include "harness/check/box_tree.h"
#include "harness/check/verify_exact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

namespace hausbench {
namespace {

const double log_of_chance = std::log(2e12);  // ln(2 / chance) for a chance of 1e-12

double exact_area(const Element& e) {
    // The type turns the expression into a number; otherwise it would refer to numbers that are gone.
    const auto difference = [&](std::size_t i, int k) -> Rational { return Rational(e[i][k]) - Rational(e[0][k]); };
    Rational squared = 0;
    for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        const Rational n = difference(1, l) * difference(2, m) - difference(1, m) * difference(2, l);
        squared += n * n;
    }
    return 0.5 * root_at_most(squared);
}

// Returns the other end of a segment, which is a triangle with two equal corners.
const Vec3& end_of(const Element& segment) { return segment[1] != segment[0] ? segment[1] : segment[2]; }

bool has_tiny_edge(const Standing& shape) {
    for (Index i = 0; i < shape.count(); ++i) {
        const Element e = shape[i];
        for (std::size_t k = 0; k < e.size(); ++k) {
            const double edge = (e[(k + 1) % e.size()] - e[k]).cwiseAbs().maxCoeff();
            if (edge > 0 && edge < 1e-70) return true;
        }
    }
    return false;
}

// The interval of an estimate.
struct Around {
    double low, high;
};

}  // namespace

// Distances of points of one shape to the other, sorted.
struct StatisticsChecker::Samples {
    std::vector<double> distances;
    bool complete = false;  // all points of the shape
    double most = 0;        // R
    double weight = 0;      // area, or number of points
    double error = 0;       // of each distance, by rounding

    // Returns how far F_n may be from F.
    double share_error() const { return complete ? 0 : std::sqrt(log_of_chance / (2 * double(distances.size()))); }

    // Returns the interval of the mean of `value`, a function of d between 0 and `largest` over the shape. Rounding
    // changes it by at most `rounding`.
    template <class Value> Around mean(const Value& value, double largest, double rounding) const {
        const double n = double(distances.size());
        double sum = 0, squares = 0;
        for (const double d : distances) sum += value(d);
        const double mean = sum / n;
        for (const double d : distances) squares += (value(d) - mean) * (value(d) - mean);
        const double variance = n > 1 ? squares / (n - 1) : 0;
        const double off =
            complete ? 0 : std::sqrt(2 * variance * log_of_chance / n) + 7 * largest * log_of_chance / (3 * (n - 1));
        const double all = off + rounding + 1e-12 * mean;  // the sum of n numbers errs by less than 1e-12 of it
        return {std::max(0.0, mean - all), mean + all};
    }

    // Returns the share of the samples with distances of at most t.
    double share(double t) const {
        return double(std::upper_bound(distances.begin(), distances.end(), t) - distances.begin()) /
               double(distances.size());
    }
};

struct StatisticsChecker::Pair {
    const Shape &source_shape, &target_shape;
    Standing source, target;
    std::size_t count;
    Stop stop;
    std::map<std::pair<bool, WeighBy>, std::optional<Samples>> samples = {};

    Pair(const Shape& a, const Pose& a_pose, const Shape& b, const Pose& b_pose, std::size_t n, Stop s)
        : source_shape(a), target_shape(b), source(a, a_pose), target(b, b_pose), count(n), stop(std::move(s)) {}

    // Returns the points that count once each: all points, or the vertices that belong to a triangle.
    std::vector<Vec3> points_of_shape(bool of_source) const {
        const Standing& from = of_source ? source : target;
        std::vector<bool> used(std::size_t(from.points().rows()), true);
        if (const auto* mesh = std::get_if<TriangleMesh>(of_source ? &source_shape : &target_shape)) {
            used.assign(used.size(), false);
            for (const Index i : mesh->triangles.reshaped()) used[std::size_t(i)] = true;
        }
        std::vector<Vec3> all;
        for (std::size_t i = 0; i < used.size(); ++i)
            if (used[i]) all.emplace_back(from.points().row(Index(i)));
        return all;
    }

    std::optional<Samples> draw(bool of_source, WeighBy weigh) {
        const Standing &from = of_source ? source : target, &to = of_source ? target : source;
        if (!from.finite() || !to.finite()) return std::nullopt;
        const double largest = std::max(from.points().cwiseAbs().maxCoeff(), to.points().cwiseAbs().maxCoeff());
        // Products of four lengths must fit into doubles.
        if (largest != 0 && !WATCHED_ELSE("verify statistics: lengths whose fourth power overflows",
                                          (largest > 1e-70 && largest < 1e70), (largest > 1e-140 && largest < 1e140)))
            return std::nullopt;
        if (WATCHED("verify statistics: edges whose fourth power underflows", has_tiny_edge(from) || has_tiny_edge(to)))
            return std::nullopt;
        const BoxTree tree(to);
        std::mt19937_64 random(of_source ? 1 : 2);
        std::uniform_real_distribution<double> uniform;
        Samples drawn;
        // 84 * 2^-53 by verify.cpp, and a few for a point inside a triangle.
        drawn.error = 100 * 0x1p-53 * largest + tree.error_of_slivers();
        const auto measure = [&](const Vec3& p) { drawn.distances.push_back(tree.nearest(p).second); };
        const bool mesh = kind_of(of_source ? source_shape : target_shape) == ShapeKind::mesh;
        if (weigh == WeighBy::number || !mesh) {
            const std::vector<Vec3> all = points_of_shape(of_source);
            drawn.weight = double(all.size());
            for (const Vec3& p : all) {
                if (stop && stop()) return std::nullopt;
                measure(p);
            }
            drawn.complete = true;
        } else {
            std::vector<double> sums;
            double sum = 0;
            const bool lines = counted_by(of_source ? source_shape : target_shape) == CountedBy::length;
            for (Index i = 0; i < from.count(); ++i) {
                if (stop && stop()) return std::nullopt;
                const Element e = from[i];
                sums.push_back(sum += lines ? (end_of(e) - e[0]).norm() : exact_area(e));
                const Vec3 centre = (e[0] + e[1] + e[2]) / 3;
                const Element& nearest = tree.element(tree.nearest(centre).first);
                for (const Vec3& v : e) drawn.most = std::max(drawn.most, distance_to(v, nearest));
            }
            if (!(sum > 0)) return std::nullopt;
            drawn.weight = sum;
            for (std::size_t k = 0; k < count; ++k) {
                if (stop && k % 1024 == 0 && stop()) return std::nullopt;
                const auto at = std::upper_bound(sums.begin(), sums.end(), uniform(random) * sum);
                const Element e = from[std::min(Index(at - sums.begin()), from.count() - 1)];
                const double root = std::sqrt(uniform(random)), t = uniform(random);
                if (lines)
                    measure((1 - t) * e[0] + t * end_of(e));
                else
                    measure((1 - root) * e[0] + root * (1 - t) * e[1] + root * t * e[2]);
            }
        }
        std::sort(drawn.distances.begin(), drawn.distances.end());
        drawn.most = std::max(drawn.most, drawn.distances.back()) + drawn.error;
        return drawn;
    }
};

namespace {

Around combined(Statistic::Over over, const Around& x, const Around& y) {
    const auto value = [over](double a, double b) {
        if (over == Statistic::Over::larger) return std::max(a, b);
        if (over == Statistic::Over::mean_of_both) return (a + b) / 2;
        return a > 0 && b > 0 ? 2 / (1 / a + 1 / b) : 0;
    };
    return {value(x.low, y.low), value(x.high, y.high)};
}

}  // namespace

StatisticsChecker::StatisticsChecker(const Shape& source, const Pose& source_pose, const Shape& target,
                                     const Pose& target_pose, Stop stop, std::size_t samples)
    : pair_(std::make_unique<Pair>(source, source_pose, target, target_pose, samples, std::move(stop))) {}

StatisticsChecker::~StatisticsChecker() = default;

const StatisticsChecker::Samples* StatisticsChecker::samples(bool of_source, WeighBy weigh) {
    auto at = pair_->samples.find({of_source, weigh});
    if (at == pair_->samples.end())
        at = pair_->samples.emplace(std::pair(of_source, weigh), pair_->draw(of_source, weigh)).first;
    return at->second ? &*at->second : nullptr;
}

namespace {

// Returns the interval of a statistic over the samples of some shapes together.
template <class Samples>
std::optional<Around> around(const Statistic& statistic, const std::vector<const Samples*>& all) {
    double weight = 0, most = 0, error = 0, largest_sample = 0;
    for (const Samples* samples : all) {
        weight += samples->weight;
        most = std::max(most, samples->most);
        error = std::max(error, samples->error);
        largest_sample = std::max(largest_sample, samples->distances.back());
    }
    const auto mean_of = [&](const auto& value, double largest, double rounding) {
        Around sum{0, 0};
        for (const Samples* samples : all) {
            const Around mean = samples->mean(value, largest, rounding);
            sum.low += samples->weight / weight * mean.low;
            sum.high += samples->weight / weight * mean.high;
        }
        return sum;
    };
    // F(t), raised (side = 1) or lowered (side = -1) by its sampling error.
    const auto share = [&](double t, double side) {
        double sum = 0;
        for (const Samples* samples : all)
            sum += samples->weight / weight * (samples->share(t) + side * samples->share_error());
        return sum;
    };
    // The least sample t with share(t, side) >= level: a lower bound of the quantile for side = 1, an upper one for -1.
    const auto quantile = [&](double level, double side) {
        level -= side * 1e-12;                     // the sums above err by less
        if (share(-1, side) >= level) return 0.0;  // even below all samples
        double least = most;
        for (const Samples* samples : all) {
            const auto& d = samples->distances;
            const auto at = std::partition_point(d.begin(), d.end(), [&](double t) { return share(t, side) < level; });
            if (at != d.end()) least = std::min(least, *at);
        }
        return least;
    };
    switch (statistic.kind) {
        case Statistic::Kind::mean:
            return mean_of([](double d) { return d; }, most, error);
        case Statistic::Kind::rms: {
            const Around square = mean_of([](double d) { return d * d; }, most * most, 2 * error * most);
            return Around{std::sqrt(square.low), std::sqrt(square.high)};
        }
        case Statistic::Kind::deviation: {
            const Around mean = mean_of([](double d) { return d; }, most, error);
            // E (d - middle)^2 = variance + (mean - middle)^2, and |mean - middle| <= half.
            const double middle = (mean.low + mean.high) / 2, half = (mean.high - mean.low) / 2;
            const double far = std::max(middle, most - middle);
            const Around square =
                mean_of([&](double d) { return (d - middle) * (d - middle); }, far * far, 4 * error * far);
            return Around{std::sqrt(std::max(0.0, square.low - half * half)), std::sqrt(square.high)};
        }
        case Statistic::Kind::maximum:
            return Around{std::max(0.0, largest_sample - error), most};  // `most` includes the error already
        case Statistic::Kind::quantile:
            return Around{std::max(0.0, quantile(statistic.argument, +1) - error),
                          quantile(statistic.argument, -1) + error};
        case Statistic::Kind::share_within:
            return Around{std::max(0.0, share(statistic.argument - error, -1)),
                          std::min(1.0, share(statistic.argument + error, +1))};
    }
    return std::nullopt;
}

}  // namespace

Check StatisticsChecker::check(const Bounds& bounds, const Statistic& statistic, WeighBy weigh) {
    using Over = Statistic::Over;
    std::vector<const Samples*> all;
    if (needs_source(statistic)) all.push_back(samples(true, weigh));
    if (needs_target(statistic)) all.push_back(samples(false, weigh));
    if (std::any_of(all.begin(), all.end(), [](const Samples* drawn) { return drawn == nullptr; })) return {};
    Around interval{};
    if (statistic.over == Over::larger || statistic.over == Over::mean_of_both ||
        statistic.over == Over::harmonic_mean) {
        const auto over_a = around<Samples>(statistic, {all[0]}), over_b = around<Samples>(statistic, {all[1]});
        if (!over_a || !over_b) return {};
        interval = combined(statistic.over, *over_a, *over_b);
    } else {
        const auto samples_interval = around<Samples>(statistic, all);
        if (!samples_interval) return {};
        interval = *samples_interval;
    }
    // The sums above err by less than 1e-12.
    const double slack = is_share(statistic) ? 1e-12 : all[0]->error + 1e-12 * interval.high;
    Check check{Verdict::holds, Verdict::holds, "", Verdict::not_checked};
    if (!(bounds.lower <= interval.high + slack)) {
        check.lower = Verdict::unsound;
        check.reason =
            fmt::format("lower {:.17g} is above {:.6g}, which samples do not explain", bounds.lower, interval.high);
    }
    if (!(bounds.upper >= interval.low - slack) || !(bounds.upper >= bounds.lower)) {
        check.upper = Verdict::unsound;
        if (!check.reason.empty()) check.reason += "; ";
        check.reason += bounds.upper < bounds.lower
                            ? fmt::format("upper {:.17g} is below lower {:.17g}", bounds.upper, bounds.lower)
                            : fmt::format("upper {:.17g} is below {:.6g}, which samples do not explain", bounds.upper,
                                          interval.low);
    }
    return check;
}

void check_statistics(std::vector<Row>& rows, const std::vector<std::size_t>& members, std::size_t checked,
                      const std::function<const Shape*(const std::string&)>& load, const Stop& stop) {
    const auto is_checked = [&](std::size_t i) { return i >= checked && rows[i].check.lower != Verdict::not_checked; };
    if (std::all_of(members.begin(), members.end(), is_checked)) return;
    const Case& first = rows[members.front()].spec;
    const Shape *source = load(first.source), *target = load(first.target);
    if (!source || !target || kind_of(*source) == ShapeKind::surface || kind_of(*target) == ShapeKind::surface) return;
    StatisticsChecker checker(*source, first.pose, *target, first.target_pose, stop);
    for (const std::size_t i : members) {
        try {
            rows[i].check =
                checker.check(rows[i].outcome.bounds, statistic_of(rows[i].spec.statistic), rows[i].spec.weigh);
        } catch (const InputError&) {
            rows[i].check = {};  // a damaged file
        }
    }
}

}  // namespace hausbench
