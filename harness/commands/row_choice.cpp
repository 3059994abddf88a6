#include "harness/commands/row_choice.h"

#include "algorithms/error.h"
#include "harness/commands/row_texts.h"
#include "harness/record/columns.h"
#include "harness/record/profiles.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace hausbench {

namespace {

// One condition of --where. Exactly one of `text` and `value` is set, and reads the column from a row.
struct Condition {
    std::function<std::string(const Row&)> text;  // for a column of texts
    std::function<double(const Row&)> value;      // for a column of numbers
    std::string wanted;
    double number = 0;
    std::string sign;      // "=", "!=", "<", "<=", ">" or ">="
    bool profile = false;  // the column is `profile`, a list of names, one of which must match

    bool holds(const Row& row) const {
        const bool differs = sign == "!=";
        if (profile)
            return differs !=
                   (wanted.find(',') == wanted.npos ? share_profile(text(row), wanted) : text(row) == wanted);
        if (text) return differs != (text(row) == wanted);
        const double is = value(row);
        if (sign[0] == '<') return is < number || (sign == "<=" && is == number);
        if (sign[0] == '>') return is > number || (sign == ">=" && is == number);
        return differs != (is == number || (std::isnan(is) && std::isnan(number)));
    }
};

// Finds the column with this name and makes the condition read it. `part` returns the part of a row that has these
// columns, such as its outcome. Returns false if no column has this name, or if it has several numbers per row, such as
// a point.
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

// Makes the condition read gap, check or answer, columns that `show` computes. Returns false for any other name.
bool find_shown(const std::string& name, Condition& condition) {
    if (name == "gap") condition.value = [](const Row& row) { return gap_of(row.outcome); };
    if (name == "check") condition.text = check_text;
    if (name == "answer") condition.text = answer_of;
    return condition.value || condition.text;
}

// Returns whether a column gets its values only from the check after a run. `run --again` cannot choose rows by such a
// column.
bool is_checked_afterwards(const std::string& name) {
    const auto has = [&](const auto& columns) {
        return std::any_of(columns.begin(), columns.end(), [&](const auto& column) { return column.name == name; });
    };
    return name == "check" || has(check_columns()) || has(row_columns());
}

// Returns the name of the column in COLUMN=VALUE.
std::string column_named_in(const std::string& where) {
    const std::string name = where.substr(0, where.find_first_of("=!<>"));
    return name == "pose" ? "pose_index" : name;  // `pose` in tables; the column `pose` holds the motion
}

Condition condition_of(const std::string& where, const std::string& option) {
    const auto begin = where.find_first_of("=!<>");
    const auto end = begin == std::string::npos ? begin : begin + (where.compare(begin + 1, 1, "=") == 0 ? 2 : 1);
    Condition condition;
    if (begin != std::string::npos) condition.sign = where.substr(begin, end - begin);
    if (condition.sign == "==") condition.sign = "=";
    if (begin == std::string::npos || begin == 0 || condition.sign == "!")
        throw InputError(
            fmt::format("{} {}: write it as column=value, column!=value, or column>number", option, where));
    const std::string name = column_named_in(where);
    condition.wanted = where.substr(end);
    condition.profile = name == "profile";
    const bool has_column =
        find_shown(name, condition) ||
        find_column<Case>(
            case_columns(), name, [](const Row& row) -> const Case& { return row.spec; }, condition) ||
        find_column<Outcome>(
            outcome_columns(), name, [](const Row& row) -> const Outcome& { return row.outcome; }, condition) ||
        find_column<Check>(
            check_columns(), name, [](const Row& row) -> const Check& { return row.check; }, condition) ||
        find_column<Row>(
            row_columns(), name, [](const Row& row) -> const Row& { return row; }, condition);
    if (!has_column) {
        std::vector<std::string> names = {"gap", "check", "answer"};
        const auto add = [&]<class Part>(const Columns<Part>& columns) {
            for (const Column<Part>& column : columns) {
                const auto* real = std::get_if<typename Column<Part>::Real>(&column.value);
                if (!real || real->width == 1) names.emplace_back(column.name);
            }
        };
        add(case_columns());
        add(outcome_columns());
        add(check_columns());
        add(row_columns());
        throw InputError(fmt::format("{} {}: no column of single values is called '{}'{}", option, where, name,
                                     nearest_hint(name, names)));
    }
    if (name == "status") {
        std::vector<std::string> statuses;
        for (int i = 0; i < count_of<RowStatus>; ++i) statuses.emplace_back(to_string(RowStatus(i)));
        if (std::find(statuses.begin(), statuses.end(), condition.wanted) == statuses.end())
            throw InputError(fmt::format("{} {}: '{}' is not a status{}: {}", option, where, condition.wanted,
                                         nearest_hint(condition.wanted, statuses), fmt::join(statuses, ", ")));
    }
    if (option != "--where" && (is_checked_afterwards(name) || (name == "status" && condition.wanted == "unsound")))
        throw InputError(
            fmt::format("{} {}: '{}' is known only after the rows are checked: choose by another column, such as "
                        "label=NAME or scene=NAME",
                        option, where, condition.wanted.empty() ? name : name + "=" + condition.wanted));
    if (condition.text && (condition.sign[0] == '<' || condition.sign[0] == '>'))
        throw InputError(fmt::format("{} {}: '{}' is a text: compare it with = or !=", option, where, name));
    if (condition.value) {
        char* rest = nullptr;
        condition.number = std::strtod(condition.wanted.c_str(), &rest);
        if (condition.wanted.empty() || *rest)
            throw InputError(fmt::format("{} {}: '{}' is a number", option, where, name));
    }
    return condition;
}

void check_known(const std::vector<std::string>& wanted, const std::set<std::string>& present, const char* what) {
    for (const std::string& name : wanted) {
        if (!present.contains(name))
            throw InputError(fmt::format("--{} {}: the result has no such {}{}", what, name, what,
                                         nearest_hint(name, {present.begin(), present.end()})));
    }
}

bool among(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::function<bool(const Row&)> row_test(const std::vector<std::string>& where, const std::string& option) {
    std::vector<Condition> conditions;
    for (const std::string& text : where) conditions.push_back(condition_of(text, option));
    return [conditions](const Row& row) {
        return std::all_of(conditions.begin(), conditions.end(), [&](const Condition& c) { return c.holds(row); });
    };
}

bool looks_only_at(const RowChoice& choice, const std::set<std::string>& columns) {
    return std::all_of(choice.where.begin(), choice.where.end(),
                       [&](const std::string& where) { return columns.contains(column_named_in(where)); });
}

std::vector<std::size_t> chosen_rows(const ResultFile& result, const RowChoice& choice) {
    std::set<std::string> solvers, scenes;
    for (const Row& row : result.rows) {
        solvers.insert({row.spec.label, shown(row.spec)});
        scenes.insert(row.spec.scene);
    }
    check_known(choice.solvers, solvers, "solver");
    check_known(choice.scenes, scenes, "scene");
    const auto meets = row_test(choice.where);
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < result.rows.size(); ++i) {
        const Row& row = result.rows[i];
        const bool solver =
            choice.solvers.empty() || among(choice.solvers, row.spec.label) || among(choice.solvers, shown(row.spec));
        const bool scene = choice.scenes.empty() || among(choice.scenes, row.spec.scene);
        if (solver && scene && meets(row)) rows.push_back(i);
    }
    return rows;
}

}  // namespace hausbench
