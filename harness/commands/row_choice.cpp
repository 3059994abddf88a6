#include "commands/row_choice.h"

#include "error.h"
#include "record/columns.h"
#include "record/profiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <set>

namespace hausbench {

namespace {

// One --where: COLUMN=VALUE or COLUMN!=VALUE.
struct Condition {
    std::function<std::string(const Row&)> text;  // of a column of texts
    std::function<double(const Row&)> value;      // or of one of numbers
    std::string wanted;
    double number = 0;
    bool differs = false;
    bool profile = false;  // a list of names, of which one is wanted

    bool holds(const Row& row) const {
        if (profile)
            return differs !=
                   (wanted.find(',') == wanted.npos ? share_profile(text(row), wanted) : text(row) == wanted);
        if (text) return differs != (text(row) == wanted);
        const double is = value(row);
        return differs != (is == number || (std::isnan(is) && std::isnan(number)));
    }
};

template <class Part>
bool find_column(const Columns<Part>& columns, const std::string& name,
                 const std::function<const Part&(const Row&)>& part, Condition& condition) {
    for (const Column<Part>& column : columns) {
        if (column.name != name) continue;
        if (const auto* text = std::get_if<typename Column<Part>::Text>(&column.value)) {
            condition.text = [get = text->get, part](const Row& row) { return get(part(row)); };
        } else if (const auto* integer = std::get_if<typename Column<Part>::Integer>(&column.value)) {
            condition.value = [get = integer->get, part](const Row& row) { return double(get(part(row))); };
        } else {
            const auto& real = std::get<typename Column<Part>::Real>(column.value);
            if (real.width != 1) return false;
            condition.value = [get = real.get, part](const Row& row) {
                double value = 0;
                get(part(row), &value);
                return value;
            };
        }
        return true;
    }
    return false;
}

Condition condition_of(const std::string& where) {
    const auto equals = where.find('=');
    if (equals == std::string::npos || equals == 0)
        throw InputError(fmt::format("--where {}: write it as column=value or column!=value", where));
    Condition condition;
    condition.differs = where[equals - 1] == '!';
    std::string name = where.substr(0, equals - condition.differs);
    if (name == "pose") name = "pose_index";  // as tables call it; the column of that name holds the motion
    condition.wanted = where.substr(equals + 1);
    condition.profile = name == "profile";
    const bool found =
        find_column<Case>(
            case_columns(), name, [](const Row& row) -> const Case& { return row.asked; }, condition) ||
        find_column<Outcome>(
            outcome_columns(), name, [](const Row& row) -> const Outcome& { return row.outcome; }, condition) ||
        find_column<Check>(
            check_columns(), name, [](const Row& row) -> const Check& { return row.check; }, condition);
    if (!found) {
        std::vector<std::string> names;
        const auto add = [&]<class Part>(const Columns<Part>& columns) {
            for (const Column<Part>& column : columns) {
                const auto* real = std::get_if<typename Column<Part>::Real>(&column.value);
                if (!real || real->width == 1) names.emplace_back(column.name);
            }
        };
        add(case_columns()), add(outcome_columns()), add(check_columns());
        throw InputError(fmt::format("--where {}: no column of single values is called '{}'{}", where, name,
                                     nearest_hint(name, names)));
    }
    if (condition.value) {
        char* end = nullptr;
        condition.number = std::strtod(condition.wanted.c_str(), &end);
        if (condition.wanted.empty() || *end)
            throw InputError(fmt::format("--where {}: '{}' holds numbers", where, name));
    }
    return condition;
}

void check_known(const std::vector<std::string>& wanted, const std::set<std::string>& known, const char* what) {
    for (const std::string& name : wanted) {
        if (!known.contains(name))
            throw InputError(fmt::format("--{} {}: the result has no such {}{}", what, name, what,
                                         nearest_hint(name, {known.begin(), known.end()})));
    }
}

bool among(const std::vector<std::string>& names, const std::string& one) {
    return std::find(names.begin(), names.end(), one) != names.end();
}

}  // namespace

std::vector<std::size_t> chosen_rows(const ResultFile& result, const RowChoice& choice) {
    std::set<std::string> solvers, scenes;
    for (const Row& row : result.rows) {
        solvers.insert({row.asked.label, shown(row.asked)});
        scenes.insert(row.asked.scene);
    }
    check_known(choice.solvers, solvers, "solver");
    check_known(choice.scenes, scenes, "scene");
    std::vector<Condition> conditions;
    for (const std::string& where : choice.where) conditions.push_back(condition_of(where));
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < result.rows.size(); ++i) {
        const Row& row = result.rows[i];
        const bool solver =
            choice.solvers.empty() || among(choice.solvers, row.asked.label) || among(choice.solvers, shown(row.asked));
        const bool scene = choice.scenes.empty() || among(choice.scenes, row.asked.scene);
        if (solver && scene &&
            std::all_of(conditions.begin(), conditions.end(), [&](const Condition& c) { return c.holds(row); }))
            rows.push_back(i);
    }
    return rows;
}

}  // namespace hausbench
