#include "harness/plan/turns.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <variant>

namespace hausbench {

namespace {

// The seed that the job's solver was given; a solver without one sorts before all seeds.
std::int64_t seed_of(const Plan& plan, const Job& job) {
    const ParameterMap& options = plan.cases[job.cases.front()].options;
    const auto found = options.find("seed");
    const std::int64_t* seed = found == options.end() ? nullptr : std::get_if<std::int64_t>(&found->second);
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
