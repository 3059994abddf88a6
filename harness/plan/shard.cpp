#include "harness/plan/shard.h"

#include "algorithms/error.h"
#include "harness/plan/plan.h"

#include <fmt/format.h>

#include <cstdio>

namespace hausbench {

Shard parse_shard(const std::string& text) {
    Shard shard{0, 0};
    char slash = 0, rest = 0;
    if (std::sscanf(text.c_str(), "%d%c%d%c", &shard.number, &slash, &shard.of, &rest) != 3 || slash != '/' ||
        shard.number < 1 || shard.number > shard.of) {
        throw InputError(fmt::format("--shard {}: write it as i/n, such as 2/3 for the second of three", text));
    }
    return shard;
}

std::string to_string(const Shard& shard) { return fmt::format("{}/{}", shard.number, shard.of); }

void take_shard(Plan& plan, const Shard& shard, const std::vector<int>& shards) {
    plan.shard = shard;
    if (shard.whole()) return;
    std::vector<Job> mine;
    for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
        if (shards.at(i) == shard.number) {
            mine.push_back(std::move(plan.jobs[i]));
            continue;
        }
        Outcome elsewhere;
        elsewhere.reason = in_another_shard;
        for (std::size_t row : plan.jobs[i].cases) plan.decided[row] = elsewhere;
    }
    plan.jobs = std::move(mine);
    if (!plan.references) return;
    std::vector<int> in_turn(plan.references->jobs.size());
    for (std::size_t i = 0; i < in_turn.size(); ++i) in_turn[i] = int(i % std::size_t(shard.of)) + 1;
    take_shard(*plan.references, shard, in_turn);
}

}  // namespace hausbench
