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
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Statistic, kind, argument, over)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Wanted, fields, stages, certificate)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Query, quantity, source_pose, target_pose, tolerance, floor, cutoff, time_limit,
                                   budget, threads, wanted, statistics, weigh, share_tolerance)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WorkOrder::Item, row, pair, chain, warm, query, trace, marks, fields, stages, search)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(WorkOrder, solver, options, folder, pairs, scaled, exponent, limits, round, repeats,
                                   build, items, plugins)

Query query_of(const Case& spec) {
    Query query;
    query.quantity = spec.quantity;
    if (!spec.statistic.empty()) query.statistics = {statistic_of(spec.statistic)};
    query.weigh = spec.weigh;
    query.share_tolerance = spec.tolerance;
    query.source_pose = spec.pose;
    query.target_pose = spec.target_pose;
    query.tolerance = spec.resolved_tolerance();
    query.floor = spec.floor;
    query.cutoff = spec.cutoff;
    if (spec.budget >= 0) query.budget = std::uint64_t(spec.budget);
    query.threads = spec.threads;
    query.time_limit = spec.limits.case_seconds;
    return query;
}

void WorkOrder::Item::narrow(double least_upper) {
    double& cutoff = query.cutoff;
    if (cutoff <= query.floor || !(least_upper < cutoff)) return;
    constexpr double least = 0x1p-500;  // a session scales the cutoff, which must stay above 0
    cutoff = std::min(cutoff, std::max({least_upper, least, std::nextafter(query.floor, cutoff)}));
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
    std::set<std::filesystem::path> seen;
    std::vector<int> counts(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i > 0 && items[i].pair == items[i - 1].pair) {
            counts[i] = counts[i - 1];
            continue;
        }
        const Pair& pair = pairs.at(items[i].pair);
        for (const auto& file : {pair.source_file, pair.target_file}) counts[i] += seen.insert(file).second ? 1 : 0;
    }
    return counts;
}

std::string packed(const WorkOrder& order) {
    const std::vector<std::uint8_t> bytes = json::to_cbor(json(order));
    return {bytes.begin(), bytes.end()};
}

WorkOrder unpacked(const std::string& bytes) { return json::from_cbor(bytes).get<WorkOrder>(); }

}  // namespace hausbench
