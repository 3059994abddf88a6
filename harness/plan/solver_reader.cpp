#include "harness/plan/solver_reader.h"

#include "algorithms/error.h"
#include "algorithms/plugin.h"
#include "algorithms/registry.h"

#include <fmt/format.h>

#include <algorithm>

namespace hausbench {

namespace {

ParameterValue read_value(const ExperimentTable& table, const toml::node& node, std::string_view key) {
    if (auto b = node.value_exact<bool>()) return *b;
    if (auto i = node.value_exact<std::int64_t>()) return *i;
    if (auto d = node.value_exact<double>()) return *d;
    if (auto s = node.value_exact<std::string>()) return *s;
    table.fail(node,
               fmt::format("parameter '{}' must be a number, a text, true, false, or a list of them to sweep", key));
}

// Returns every combination of the parameter values in the table; the last parameter varies fastest. Throws InputError
// if the solver does not accept a combination.
std::vector<ParameterMap> read_options(const ExperimentTable& table, const SolverEntry& entry) {
    std::vector<ParameterMap> combinations(1);
    const toml::table none;
    const toml::node* node = table.find("parameters");
    const toml::table* parameters = node ? node->as_table() : &none;
    if (!parameters) table.fail(*node, "'parameters' must be a table");
    for (const auto& [key, value] : *parameters) {
        std::vector<ParameterValue> values;
        if (const toml::array* list = value.as_array()) {
            for (const toml::node& item : *list) values.push_back(read_value(table, item, key.str()));
            if (values.empty()) table.fail(value, fmt::format("the list of parameter '{}' is empty", key.str()));
        } else {
            values.push_back(read_value(table, value, key.str()));
        }
        std::vector<ParameterMap> next;
        for (const ParameterMap& combination : combinations) {
            for (const ParameterValue& choice : values) {
                next.push_back(combination);
                next.back()[std::string(key.str())] = choice;
            }
        }
        combinations = std::move(next);
    }
    for (const ParameterMap& combination : combinations) {
        try {
            const Options options(entry.info.name, entry.info.parameters, combination);
            if (!plugin_of(entry.info.name)) static_cast<void>(entry.make(options));  // a plug-in may crash here
        } catch (const InputError& error) {
            table.fail(node ? *node : table.table(), error.what());
        }
    }
    return combinations;
}

}  // namespace

Quantity read_quantity(const ExperimentTable& table, Quantity otherwise) {
    const std::string text = table.text("quantity", std::string(to_string(otherwise)));
    std::vector<std::string> names;
    for (const Quantity quantity : quantities) {
        if (text == to_string(quantity)) return quantity;
        names.emplace_back(to_string(quantity));
    }
    table.fail(
        *table.find("quantity"),
        fmt::format("'quantity' must be directed (h), symmetric (H), penetration (depth) or distribution, not '{}'{}",
                    text, nearest_hint(text, names)));
}

std::vector<Statistic> read_statistics(const ExperimentTable& table, const std::vector<Statistic>& otherwise) {
    if (!table.find("statistics")) return otherwise;
    std::vector<Statistic> all;
    for (const std::string& text : table.texts("statistics")) {
        try {
            all.push_back(statistic_of(text));
        } catch (const InputError& error) {
            table.fail(*table.find("statistics"), error.what());
        }
    }
    if (all.empty())
        table.fail(*table.find("statistics"), "'statistics' is empty: name at least one, such as \"mean\"");
    return all;
}

WeighBy read_weigh(const ExperimentTable& table, WeighBy otherwise) {
    const std::string text = table.text("weigh", std::string(to_string(otherwise)));
    for (const WeighBy weigh : {WeighBy::area, WeighBy::number})
        if (text == to_string(weigh)) return weigh;
    table.fail(*table.find("weigh"), fmt::format("'weigh' must be area or number, not '{}'", text));
}

SolverPlan read_solver(const ExperimentTable& table, const Experiment& experiment) {
    SolverPlan solver;
    solver.quantity = read_quantity(table, experiment.quantity);
    solver.statistics = read_statistics(table, experiment.statistics);
    solver.weigh = read_weigh(table, experiment.weigh);
    if (solver.quantity != Quantity::distribution)
        solver.statistics.clear();
    else if (solver.statistics.empty())
        table.fail(
            "quantity \"distribution\" needs 'statistics', here or at the top, such as [\"mean\", \"quantile 0.95\"]");
    solver.threads = table.count("threads", 1, experiment.threads);
    solver.name = table.text("name");
    solver.label = table.text("label", solver.name);
    solver.tolerances = table.tolerances("tolerances");
    solver.scenes = table.texts("scenes");
    solver.warm = table.flag("warm", solver.warm);
    const auto& absent = solvers_not_built();
    if (std::any_of(absent.begin(), absent.end(), [&](const NotBuilt& s) { return s.name == solver.name; })) {
        solver.options.resize(1);  // parameters unknown; the cases become `not_built`
        return solver;
    }
    const SolverEntry* entry = nullptr;
    try {
        entry = &find_solver(solver.name);
    } catch (const InputError& error) {
        table.fail(*table.find("name"), error.what());
    }
    solver.options = read_options(table, *entry);
    if (solver.warm && !entry->info.can(Ability::warm)) {
        table.fail(
            *table.find("warm"),
            fmt::format("'warm': the solver '{}' carries nothing from one pose to the next: remove it", solver.name));
    }
    return solver;
}

void expect_searches(const ExperimentTable& table, const SolverPlan& solver, const std::vector<ScenePlan>& scenes) {
    const auto names = [&](const std::string& name) {
        return std::find(solver.scenes.begin(), solver.scenes.end(), name) != solver.scenes.end();
    };
    for (const ScenePlan& scene : scenes) {
        if (!scene.search) continue;
        if (names(scene.name))
            table.fail(*table.find("scenes"),
                       fmt::format("'{}' is a pair of a search: name the whole of it, '{}'", scene.name, scene.matrix));
        if (solver.warm && (solver.scenes.empty() || names(scene.matrix)))
            table.fail(*table.find("warm"),
                       fmt::format("'warm' cannot be combined with '{}', a search: remove it, or name other 'scenes'",
                                   scene.matrix));
    }
}

}  // namespace hausbench
