#include "record/json.h"
#include "run/worker.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace hausbench {

using nlohmann::json;

namespace {

ParameterMap parameters_of(const json& object) {
    ParameterMap out;
    for (const auto& [name, value] : object.items()) out[name] = parameter_of(value);
    return out;
}

}  // namespace

void WorkOrder::Item::narrow(double least_upper) {
    if (cutoff <= floor || !(least_upper < cutoff)) return;
    constexpr double least = 0x1p-500;  // still above 0 when scaled
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

json to_json(const WorkOrder& o) {
    json items = json::array(), pairs = json::array(), plugins = json::object();
    for (const auto& [file, hash] : o.plugins) plugins[file.string()] = hash;
    for (const auto& p : o.pairs) {
        const QuerySet& q = p.queries;
        pairs.push_back(
            {{"source", p.source_file.string()},
             {"target", p.target_file.string()},
             {"queries",
              {q.moves, q.count, q.finest_tolerance, q.target_moves, q.target_copied, q.symmetric, q.threads}}});
    }
    for (const auto& i : o.items) {
        items.push_back({{"row", i.row},
                         {"pair", i.pair},
                         {"chain", i.chain},
                         {"warm", i.warm},
                         {"quantity", int(i.quantity)},
                         {"pose", pose_json(i.source_pose)},
                         {"target_pose", pose_json(i.target_pose)},
                         {"of_lower", i.tolerance.of == Tolerance::Of::lower},
                         {"tolerance", i.tolerance.value},
                         {"floor", i.floor},
                         {"cutoff", number(i.cutoff)},
                         {"budget", i.budget},
                         {"threads", i.threads},
                         {"trace", i.trace},
                         {"marks", i.marks},
                         {"fields", i.fields.string()},
                         {"stages", i.stages},
                         {"search", i.search}});
    }
    return {{"solver", o.solver},
            {"options", options_json(o.options)},
            {"folder", o.folder.string()},
            {"pairs", pairs},
            {"exponent", o.exponent ? json(*o.exponent) : json()},
            {"limits", {o.limits.case_seconds, o.limits.prepare_seconds, o.limits.memory_bytes}},
            {"round", o.round},
            {"repeats", o.repeats},
            {"leave_nothing_out", o.leave == Leave::nothing_out},
            {"items", items},
            {"plugins", plugins}};
}

WorkOrder work_order_from_json(const json& j) {
    WorkOrder o;
    o.solver = j.at("solver");
    o.options = parameters_of(j.at("options"));
    o.folder = j.at("folder").get<std::string>();
    for (const json& p : j.at("pairs")) {
        const json& q = p.at("queries");
        o.pairs.push_back({p.at("source").get<std::string>(),
                           p.at("target").get<std::string>(),
                           {q.at(0), q.at(1), q.at(2), q.at(3), q.at(4), q.at(5), q.at(6)}});
    }
    if (!j.at("exponent").is_null()) o.exponent = j.at("exponent").get<int>();
    o.limits = {j.at("limits").at(0), j.at("limits").at(1), j.at("limits").at(2)};
    o.round = j.at("round");
    o.repeats = j.at("repeats");
    o.leave = j.at("leave_nothing_out").get<bool>() ? Leave::nothing_out : Leave::out_what_is_not_needed;
    for (const json& i : j.at("items")) {
        o.items.push_back(
            {i.at("row"),
             i.at("pair"),
             i.at("chain"),
             i.at("warm"),
             Quantity(i.at("quantity").get<int>()),
             pose_of(i.at("pose")),
             pose_of(i.at("target_pose")),
             {i.at("of_lower").get<bool>() ? Tolerance::Of::lower : Tolerance::Of::absolute, i.at("tolerance")},
             i.at("floor"),
             number(i.at("cutoff")),
             i.at("budget"),
             i.at("threads"),
             i.at("trace"),
             i.at("marks").get<std::vector<double>>(),
             i.at("fields").get<std::string>(),
             i.at("stages"),
             i.at("search")});
    }
    for (const auto& [file, hash] : j.at("plugins").items()) o.plugins[file] = hash;
    return o;
}

}  // namespace hausbench
