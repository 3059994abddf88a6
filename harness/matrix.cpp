#include "matrix.h"

#include "registry.h"
#include "session.h"
#include "shape_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace hausbench {

namespace {

// Further apart, and pairs of a matrix go to workers of their own.
constexpr int widest_scale_of_a_worker = 60;

struct Extent {
    ShapeKind kind;
    double magnitude;
};
using Extents = std::map<std::filesystem::path, Extent>;

// What a session on this pair alone would scale by.
int exponent_of(const SolverInfo& info, const Job::Pair& pair, Extents& extents) {
    for (const auto& file : {pair.source_file, pair.target_file}) {
        if (extents.contains(file)) continue;
        const Shape shape = read_shape(file).shape;
        extents[file] = {kind_of(shape), magnitude(points_of(shape))};
    }
    const Extent &a = extents.at(pair.source_file), &b = extents.at(pair.target_file);
    return scalable(info, a.kind, b.kind) ? scale_exponent(std::max(a.magnitude, b.magnitude)) : 0;
}

void join(Plan& plan, const std::string& matrix, std::vector<Job> group, Extents& extents) {
    const Case& first = plan.cases[group.front().cases.front()];
    const SolverInfo& info = find_solver(first.solver).info;
    const std::size_t scene = group.front().scene;
    std::vector<int> exponents;
    for (const Job& job : group) exponents.push_back(exponent_of(info, job.pairs.front(), extents));
    // The largest first. Scaling by 2^60 less than a pair would be by itself loses nothing that counts (Session).
    while (!group.empty()) {
        const int most = *std::min_element(exponents.begin(), exponents.end());
        Job joined;
        joined.scene = scene;
        joined.label = fmt::format("{} on {}", first.label, matrix);
        joined.exponent = most;
        std::vector<Job> rest;
        std::vector<int> rest_exponents;
        for (std::size_t i = 0; i < group.size(); ++i) {
            if (exponents[i] - most > widest_scale_of_a_worker) {
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
    using Key = std::tuple<std::string, std::string, std::string, Quantity, int, bool, double>;
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
        // Chains of several tolerances stay apart, so that a pair's cases stand together.
        const Key key{scene.matrix,  first.label, options_json(first.options).dump(), first.quantity,
                      first.threads, first.warm,  first.warm ? first.tolerance : 0};
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

}  // namespace hausbench
