#include "harness/plan/jobs.h"

#include "algorithms/kernel/rounding.h"
#include "algorithms/registry.h"
#include "algorithms/session/session.h"
#include "datasets/shape_file.h"
#include "harness/record/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <variant>

namespace hausbench {

namespace {

// Pairs of a matrix share a worker process only if their scales differ by at most a factor of 2 to this power.
constexpr int widest_scale_of_a_worker = 60;

struct Extent {
    ShapeKind kind;
    double magnitude, smallest;  // largest |coordinate|, and smallest that is not 0
};
using Extents = std::map<std::filesystem::path, Extent>;

// Returns the exponent of the power of two by which a session would scale this pair alone. Reads the shapes from their
// files unless `extents` has them.
int exponent_of(const SolverInfo& info, const Job::Pair& pair, Extents& extents) {
    for (const auto& file : {pair.source_file, pair.target_file}) {
        if (extents.contains(file)) continue;
        const Shape shape = read_shape(file).shape;
        extents[file] = {kind_of(shape), magnitude(points_of(shape)), smallest_nonzero(points_of(shape))};
    }
    const Extent &a = extents.at(pair.source_file), &b = extents.at(pair.target_file);
    return scalable(info, a.kind, b.kind) ? scale_exponent(std::max(a.magnitude, b.magnitude)) : 0;
}

// Updates the smallest nonzero |x| so far, `least`, and the largest |x| so far, `most`.
void take(double x, double& least, double& most) {
    if (x != 0) least = std::min(least, std::abs(x));
    most = std::max(most, std::abs(x));
}

// Returns whether a session that scales a pair by 2^shared gives the same bits as one that scales it by 2^own, where
// own >= shared. Scaling by a power of two commutes with every rounding, under two conditions:
// - Nothing underflows at either scale, not even in squares and in products with poses. This holds if the coordinates,
//   their products with the entries of a rotation, and the translations are 0 or at least `least_safe`. Distances
//   between points of one shape may be smaller than its coordinates, but a nonzero difference of two coordinates is at
//   least 2^-53 times the smallest nonzero coordinate, and the square of such a difference does not underflow.
// - No pose moves the shapes, at one scale only, out of the range that scaled.h describes. `most_safe` keeps moved
//   coordinates below the upper end of that range, 2^400, at both scales.
bool same_bits(const Plan& plan, const Job& job, int own, int shared, const Extents& extents) {
    if (own == shared) return true;
    constexpr double least_safe = 0x1p-400, most_safe = 0x1p390;
    const Job::Pair& pair = job.pairs.front();
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (const auto& file : {pair.source_file, pair.target_file}) {
        const Extent& extent = extents.at(file);
        least = std::min(least, std::ldexp(extent.smallest, shared));  // infinite if all are zero
        most = std::max(most, std::ldexp(extent.magnitude, own));
    }
    double entry = std::numeric_limits<double>::infinity(), largest_entry = 0, translation = entry, shift = 0;
    for (const std::size_t row : job.cases) {
        for (const Pose* pose : {&plan.cases[row].pose, &plan.cases[row].target_pose}) {
            for (const double x : pose->rotation.reshaped()) take(x, entry, largest_entry);
            for (const double x : pose->translation) {
                take(std::ldexp(x, shared), translation, shift);
                take(std::ldexp(x, own), translation, shift);
            }
        }
    }
    return least * std::min(entry, 1.0) >= least_safe && translation >= least_safe &&
           3 * largest_entry * most + shift <= most_safe;
}

// Joins `group`, the jobs of one solver on the pairs of a matrix, into one job or, if their scales differ too much,
// into several. Adds these to the plan.
void join(Plan& plan, const std::string& matrix, std::vector<Job> group, Extents& extents) {
    const Case& first = plan.cases[group.front().cases.front()];
    const SolverInfo& info = find_solver(first.solver).info;
    const std::size_t scene = group.front().scene;
    std::vector<int> exponents;
    for (const Job& job : group) exponents.push_back(exponent_of(info, job.pairs.front(), extents));
    const auto fits = [&](std::size_t i, int most) {
        return exponents[i] - most <= widest_scale_of_a_worker &&
               same_bits(plan, group[i], exponents[i], most, extents);
    };
    // Each pass makes one job. Its scale has the least exponent, which belongs to the pair with the largest
    // coordinates. Every other pair joins if this scale is at most a factor of 2^60 below its own and gives it the same
    // bits.
    while (!group.empty()) {
        const int most = *std::min_element(exponents.begin(), exponents.end());
        Job joined;
        joined.scene = scene;
        joined.label = fmt::format("{} on {}{}", shown(first), matrix, suffix_of_statistic(first));
        joined.exponent = most;
        if (plan.experiment.scenes[scene].search) {
            for (std::size_t i = 0; i < group.size(); ++i) {
                if (!fits(i, most)) joined.exponent.reset();
            }
        }
        std::vector<Job> rest;
        std::vector<int> rest_exponents;
        for (std::size_t i = 0; i < group.size(); ++i) {
            if (joined.exponent && !fits(i, most)) {
                rest.push_back(std::move(group[i]));
                rest_exponents.push_back(exponents[i]);
                continue;
            }
            joined.pairs.push_back(group[i].pairs.front());
            joined.cases.insert(joined.cases.end(), group[i].cases.begin(), group[i].cases.end());
        }
        plan.jobs.push_back(std::move(joined));
        group = std::move(rest);
        exponents = std::move(rest_exponents);
    }
}

}  // namespace

void join_matrices(Plan& plan) {
    using Key = std::tuple<std::string, std::string, std::string, Quantity, std::string, WeighBy, int, bool, double>;
    Extents extents;
    std::map<Key, std::size_t> number;
    std::vector<std::vector<Job>> groups;
    for (Job& job : plan.jobs) {
        const ScenePlan& scene = plan.experiment.scenes[job.scene];
        const Case& first = plan.cases[job.cases.front()];
        if (scene.matrix.empty()) {
            groups.push_back({std::move(job)});
            continue;
        }
        // If the cases form chains (see Job), each tolerance gets a job of its own, so that the cases of a pair are
        // adjacent.
        const bool chains = first.warm || scene.search;
        const Key key{scene.matrix,   first.label,     nlohmann::json(first.options).dump(),
                      first.quantity, first.statistic, first.weigh,
                      first.threads,  first.warm,      chains ? first.tolerance : 0};
        const auto [at, fresh] = number.emplace(key, groups.size());
        if (fresh) groups.emplace_back();
        groups[at->second].push_back(std::move(job));
    }
    plan.jobs.clear();
    for (auto& group : groups) {
        const ScenePlan& scene = plan.experiment.scenes[group.front().scene];
        if (scene.matrix.empty())
            plan.jobs.push_back(std::move(group.front()));
        else
            join(plan, scene.matrix, std::move(group), extents);
    }
}

namespace {

// Returns the parameter `seed` of the job's solver. Returns the least integer if it has none, so that such jobs sort
// first.
std::int64_t seed_of(const Plan& plan, const Job& job) {
    const ParameterMap& options = plan.cases[job.cases.front()].options;
    const auto entry = options.find("seed");
    const std::int64_t* seed = entry == options.end() ? nullptr : std::get_if<std::int64_t>(&entry->second);
    return seed ? *seed : std::numeric_limits<std::int64_t>::min();
}

}  // namespace

void interleave_seeds(Plan& plan) {
    const auto place = [&](const Job& job) { return std::pair(job.scene, seed_of(plan, job)); };
    std::stable_sort(plan.jobs.begin(), plan.jobs.end(),
                     [&](const Job& a, const Job& b) { return place(a) < place(b); });
    bool backwards = false;
    for (auto begin = plan.jobs.begin(); begin != plan.jobs.end();) {
        const auto first = place(*begin);
        const auto end = std::find_if(begin, plan.jobs.end(), [&](const Job& job) { return place(job) != first; });
        if (backwards) std::reverse(begin, end);
        backwards = end != plan.jobs.end() && end->scene == first.first && !backwards;
        begin = end;
    }
}

}  // namespace hausbench
