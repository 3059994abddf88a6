#include "harness/run/work_order.h"

#include "harness/record/json.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace hausbench {

using nlohmann::json;

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(QuerySet, moves, count, finest_tolerance, target_moves, target_copied, symmetric,
                                   both_ways, threads)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Tolerance, of, value)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Limits, case_seconds, prepare_seconds, memory_bytes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WorkOrder::Pair, source_file, target_file, queries)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WorkOrder::Item, row, pair, chain, warm, quantity, source_pose, target_pose,
                                   tolerance, floor, cutoff, budget, threads, trace, marks, fields, stages, proof,
                                   search, statistic, weigh, share_tolerance)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WorkOrder, solver, options, folder, pairs, scaled, exponent, limits, round, repeats,
                                   build, items, plugins)

void WorkOrder::Item::take_statistic(const Case& asked) {
    statistic = asked.statistic;
    weigh = asked.weigh;
    share_tolerance = asked.tolerance;
}

Query WorkOrder::Item::query(double time_limit) const {
    Query asked;
    asked.quantity = quantity;
    if (!statistic.empty()) asked.statistics = {statistic_of(statistic)};
    asked.weigh = weigh;
    asked.share_tolerance = share_tolerance;
    asked.source_pose = source_pose;
    asked.target_pose = target_pose;
    asked.tolerance = tolerance;
    asked.floor = floor;
    asked.cutoff = cutoff;
    if (budget >= 0) asked.budget = std::uint64_t(budget);
    asked.threads = threads;
    asked.time_limit = time_limit;
    asked.wanted.certificate = proof;
    return asked;
}

void WorkOrder::Item::narrow(double least_upper) {
    if (cutoff <= floor || !(least_upper < cutoff)) return;
    constexpr double least = 0x1p-500;  // a session scales the cutoff, which must stay above 0
    cutoff = std::min(cutoff, std::max({least_upper, least, std::nextafter(floor, cutoff)}));
}

std::size_t WorkOrder::chain_end(std::size_t first) const {
    std::size_t end = first + 1;
    while (end < items.size() && items[end].chain == items[first].chain) ++end;
    return end;
}

std::size_t WorkOrder::pair_end(std::size_t first) const {
    std::size_t end = first + 1;
    while (end < items.size() && items[end].pair == items[first].pair) ++end;
    return end;
}

std::vector<int> WorkOrder::new_shapes() const {
    std::set<std::filesystem::path> known;
    std::vector<int> counts(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i > 0 && items[i].pair == items[i - 1].pair) {
            counts[i] = counts[i - 1];
            continue;
        }
        const Pair& pair = pairs.at(items[i].pair);
        for (const auto& file : {pair.source_file, pair.target_file}) counts[i] += known.insert(file).second ? 1 : 0;
    }
    return counts;
}

std::string packed(const WorkOrder& order) {
    const std::vector<std::uint8_t> bytes = json::to_cbor(json(order));
    return {bytes.begin(), bytes.end()};
}

WorkOrder unpacked(const std::string& bytes) { return json::from_cbor(bytes).get<WorkOrder>(); }

}  // namespace hausbench
