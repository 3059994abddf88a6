// Finds the columns of x, y and z in a table of points, by the names in its header or as the user chose.
//
// Names are compared without letter case and without a unit such as [mm], and with one '_' in place of blanks and of
// the characters "_.:-". A family gives one or more names for each coordinate. The header must have exactly one
// complete family; names from two families are never mixed. A name may join two with a slash, as in "X/East". Latitude
// and longitude are angles, and refused.
#include "datasets/formats/column_names.h"

#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

namespace hausbench::readers {
namespace {

using Names = std::set<std::string>;
using Family = std::array<Names, 3>;

// Returns the family of a pattern such as "pos_*", where '*' stands for x, y and z.
Family with_axis(const std::string& pattern) {
    Family family;
    for (std::size_t k = 0; k < 3; ++k) {
        std::string name = pattern;
        name[name.find('*')] = "xyz"[k];
        family[k] = {name};
    }
    return family;
}

const std::vector<Family>& families() {
    static const std::vector<Family> all = [] {
        std::vector<Family> made;
        for (const char* pattern :
             {"*",         "*_coordinate", "*_coord",      "*_position", "*_pos",    "*coordinate",   "*coord",
              "*position", "*pos",         "coordinate_*", "coord_*",    "coords_*", "coordinates_*", "position_*",
              "pos_*",     "point_*",      "points_*",     "location_*", "loc_*",    "p_*",           "coordinate*",
              "coord*",    "position*",    "pos*",         "point*",     "p*"})
            made.push_back(with_axis(pattern));
        for (const std::string stem : {"points_", "point_", "position_", "coordinates_"})
            made.push_back({Names{stem + "0"}, Names{stem + "1"}, Names{stem + "2"}});  // as ParaView writes them
        made.push_back({Names{"easting", "east", "eastings"}, Names{"northing", "north", "northings"},
                        Names{"elevation", "elev", "height", "altitude", "alt", "up", "z"}});
        return made;
    }();
    return all;
}

const Names& angles() {
    static const Names all = {"lat", "latitude", "lon", "long", "lng", "longitude"};
    return all;
}

// A name without its unit.
struct Bare {
    std::string name;
    std::string unit;  // as written; empty: none
};

// Returns the name in lower case, with one '_' for each run of blanks and of "_.:-".
std::string plain(std::string_view text) {
    text = trimmed(text);
    std::string name(text.starts_with('-') ? "-" : "");  // the negative of a coordinate has another name
    for (const char c : lower_case(text)) {
        if (std::string_view(" \t_.:-").find(c) == std::string_view::npos)
            name.push_back(c);
        else if (!name.empty() && name.back() != '_')
            name.push_back('_');
    }
    while (name.ends_with('_')) name.pop_back();
    return name;
}

// Splits a text in brackets from the end of a field: "x [mm]" or "X(m)". Returns false if there is none.
bool split_brackets(std::string_view field, std::string_view& name, std::string_view& inside) {
    if (!field.ends_with(']') && !field.ends_with(')')) return false;
    const std::size_t open = field.find_last_of(field.back() == ']' ? '[' : '(');
    if (open == std::string_view::npos || open == 0) return false;
    name = field.substr(0, open);
    inside = trimmed(field.substr(open + 1, field.size() - open - 2));
    return true;
}

// Returns whether a text in brackets is another name of the coordinate, as in "Easting (X)".
bool is_letter_of_axis(std::string_view text) { return text.size() == 1 && lower_case(text).find_first_of("xyz") == 0; }

// Splits a unit from a name: "x [mm]", "X(m)", "x/mm", "x, mm", "x_mm" or "x in mm".
Bare bare(std::string_view field) {
    field = trimmed(field);
    std::string_view name, unit;
    if (split_brackets(field, name, unit)) {
        if (is_letter_of_axis(unit)) return bare(name);
        std::string_view before, letter;  // "Easting (X) [mm]"
        const bool another = split_brackets(trimmed(name), before, letter) && is_letter_of_axis(letter);
        return {plain(another ? before : name), std::string(bare_unit(unit))};
    }
    const std::size_t mark = field.find_last_of("/,");
    if (mark != std::string_view::npos && mark > 0 && unit_named(trimmed(field.substr(mark + 1))))
        return {plain(field.substr(0, mark)), std::string(trimmed(field.substr(mark + 1)))};
    const std::string all = plain(field);
    const std::size_t last = all.rfind('_');
    if (last == std::string::npos || last == 0 || !unit_named(all.substr(last + 1))) return {all, ""};
    const std::string before = all.substr(0, last);
    return {before.ends_with("_in") ? before.substr(0, last - 3) : before, all.substr(last + 1)};
}

// Returns the text after the last slash of a field, which is a unit if the names of x, y and z have the same.
std::string_view after_slash(std::string_view field) {
    const std::size_t slash = field.rfind('/');
    return slash == std::string_view::npos || slash == 0 ? "" : trimmed(field.substr(slash + 1));
}

// Returns the names that a field gives: one, or several that are joined by slashes or in brackets.
std::vector<std::string> names_of(std::string_view field) {
    std::string_view rest = field, before, inside;
    std::vector<std::string> names = {bare(field).name};
    for (std::string_view outer = trimmed(field); split_brackets(outer, before, inside); outer = trimmed(before))
        if (is_letter_of_axis(inside) && trimmed(before).size() < before.size()) names.push_back(lower_case(inside));
    while (rest.find('/') != std::string_view::npos) {
        const std::size_t slash = rest.find('/');
        names.push_back(bare(rest.substr(0, slash)).name);
        rest.remove_prefix(slash + 1);
    }
    if (rest.size() < field.size()) names.push_back(bare(rest).name);
    return names;
}

// Returns, for each coordinate, the columns that this family names. A field such as "x/y/z" names none.
std::array<std::vector<std::size_t>, 3> columns_of(const Family& family, const std::vector<std::string_view>& fields) {
    std::array<std::vector<std::size_t>, 3> columns;
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const std::vector<std::string> names = names_of(fields[i]);
        std::array<bool, 3> named{};
        for (std::size_t k = 0; k < 3; ++k)
            named[k] =
                std::any_of(names.begin(), names.end(), [&](const auto& name) { return family[k].contains(name); });
        for (std::size_t k = 0; k < 3; ++k)
            if (named[k] && !named[(k + 1) % 3] && !named[(k + 2) % 3]) columns[k].push_back(i);
    }
    return columns;
}

int count_angles(const std::vector<std::string_view>& fields) {
    return static_cast<int>(std::count_if(fields.begin(), fields.end(), [](std::string_view field) {
        const std::vector<std::string> names = names_of(field);
        return std::any_of(names.begin(), names.end(), [](const auto& name) { return angles().contains(name); });
    }));
}

constexpr std::string_view remedy =
    "choose the columns of x, y and z with --columns, by number or name (in Python columns=\"2,3,4\")";

// Returns the names of a header for a message: "'ID', 'Easting', ...", at most eight.
std::string list_of(const std::vector<std::string_view>& fields) {
    std::string text;
    for (std::size_t i = 0; i < fields.size() && i < 8; ++i)
        text += fmt::format("{}'{}'", i == 0 ? "" : ", ", shown(fields[i]));
    return text + (fields.size() > 8 ? ", ..." : "");
}

// Returns the units of three columns as written, from the line of units or from their names.
std::array<std::string, 3> units_of(const Header& header, const std::array<std::size_t, 3>& columns) {
    std::array<std::string, 3> units;
    std::array<std::string_view, 3> slashes;
    std::size_t last = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (columns[k] < header.units.size()) units[k] = bare_unit(header.units[columns[k]]);
        if (columns[k] >= header.fields.size()) continue;
        if (units[k].empty()) units[k] = bare(header.fields[columns[k]]).unit;
        slashes[k] = after_slash(header.fields[columns[k]]);
        if (columns[k] > columns[last]) last = k;
    }
    const auto count = std::count_if(units.begin(), units.end(), [](const std::string& unit) { return !unit.empty(); });
    if (count == 0 && slashes[0] == slashes[1] && slashes[0] == slashes[2]) units.fill(std::string(slashes[0]));
    if (count == 1 && header.loose && !units[last].empty()) units.fill(std::string(units[last]));
    return units;
}

// Takes the unit of three columns from their names. If `must_agree`, refuses units that differ.
void take_unit(const std::string& name, const Header& header, bool must_agree, ColumnChoice& choice) {
    std::array<std::string, 3> units = units_of(header, choice.columns);
    const auto length = [](const std::string& unit) {
        const auto match = unit_named(unit);
        return match ? match->micrometres : 0.0;
    };
    const auto same = [&](std::size_t k) {
        return lower_case(units[k]) == lower_case(units[0]) ||
               (length(units[0]) > 0 && length(units[k]) == length(units[0]));
    };
    if (!same(1) || !same(2)) {
        const std::string why = fmt::format("the units of x, y and z differ: '{}', '{}' and '{}'", shown(units[0]),
                                            shown(units[1]), shown(units[2]));
        if (must_agree)
            refuse(name, header.line,
                   why +
                       ": write them in one unit, or choose the columns with --columns, by number or name (in Python "
                       "columns=\"2,3,4\"), so that the numbers count");
        choice.notes.push_back(why + "; the numbers count");
    } else if (!units[0].empty()) {
        choice.stated = unit_stated_as(units[0]);
        if (choice.stated.micrometres == 0) choice.notes.push_back(unknown_unit(units[0]));
    }
}

// Says which columns are read, if their names are not x, y and z.
void note_names(const Header& header, ColumnChoice& choice) {
    bool obvious = true;
    std::array<std::string, 3> texts;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::string_view field = header.fields[choice.columns[k]];
        obvious = obvious && bare(field).name == std::string(1, "xyz"[k]);
        texts[k] = fmt::format("column {} ('{}')", choice.columns[k] + 1, shown(field));
    }
    if (!obvious) choice.notes.push_back(fmt::format("x is {}, y {} and z {}", texts[0], texts[1], texts[2]));
}

// Returns the column with this name: exactly, then without letter case, then without its unit.
std::size_t column_named(const std::string& name, std::string_view wanted, const Header& header) {
    const auto matches = [&](int how, std::string_view field) {
        if (how == 0) return field == wanted;
        return how == 1 ? lower_case(field) == lower_case(wanted) : bare(field).name == plain(wanted);
    };
    for (int how = 0; how < 3; ++how) {
        std::vector<std::size_t> columns;
        for (std::size_t i = 0; i < header.fields.size(); ++i)
            if (matches(how, header.fields[i])) columns.push_back(i);
        if (columns.size() > 1)
            refuse(name, header.line,
                   fmt::format("{} columns are named '{}': choose one by its number, as in --columns 2,3,4",
                               columns.size(), shown(wanted)));
        if (columns.size() == 1) return columns[0];
    }
    refuse(name, header.line, fmt::format("no column is named '{}', only {}", shown(wanted), list_of(header.fields)));
}

}  // namespace

std::string_view bare_unit(std::string_view field) {
    field = trimmed(field);
    const bool brackets = field.size() > 1 && ((field.front() == '[' && field.back() == ']') ||
                                               (field.front() == '(' && field.back() == ')'));
    if (brackets) field = trimmed(field.substr(1, field.size() - 2));
    return field == "-" ? "" : field;
}

std::size_t count_units(const std::vector<std::string_view>& fields) {
    std::size_t count = 0;
    for (const std::string_view field : fields) {
        if (decimal(field)) return 0;
        count += field.starts_with('[') || field.starts_with('(') || unit_named(bare_unit(field)) ? 1 : 0;
    }
    return count;
}

std::string unknown_unit(std::string_view unit) {
    return fmt::format("states the unit '{}', which is not known: its numbers count as they stand", shown(unit));
}

bool is_missing(std::string_view field) {
    static const Names words = {"", "na", "n/a", "#n/a", "#na", "null", "none"};
    const std::string lower = lower_case(field);
    return words.contains(lower) || lower.starts_with("1.#") || lower.starts_with("-1.#");
}

bool may_be_header(const std::vector<std::string_view>& fields) {
    bool name = false;
    for (const std::string_view field : fields) {
        if (field.empty()) continue;
        if (std::string_view("0123456789+-.").find(field.front()) != std::string_view::npos || decimal(field) ||
            is_missing(field))
            return false;
        name = true;
    }
    return name;
}

int coordinates_named(const std::vector<std::string_view>& fields) {
    int most = count_angles(fields);
    for (const Family& family : families()) {
        const auto axes = columns_of(family, fields);
        most = std::max(most, static_cast<int>(std::count_if(axes.begin(), axes.end(),
                                                             [](const auto& columns) { return !columns.empty(); })));
    }
    return std::min(most, 3);
}

bool names_angles(const std::vector<std::string_view>& fields) { return count_angles(fields) > 1; }

bool names_another_order(const std::vector<std::string_view>& fields) {
    return std::any_of(families().begin(), families().end(), [&](const Family& family) {
        const auto columns = columns_of(family, fields);
        const bool complete = !columns[0].empty() && !columns[1].empty() && !columns[2].empty();
        return complete && !(columns[0][0] < columns[1][0] && columns[1][0] < columns[2][0]);
    });
}

ColumnChoice columns_by_name(const std::string& name, const Header& header) {
    std::set<std::array<std::size_t, 3>> choices;
    bool repeated = false, some = false;
    for (const Family& family : families()) {
        const auto columns = columns_of(family, header.fields);
        some = some || !columns[0].empty() || !columns[1].empty() || !columns[2].empty();
        if (columns[0].empty() || columns[1].empty() || columns[2].empty()) continue;
        repeated = repeated || columns[0].size() > 1 || columns[1].size() > 1 || columns[2].size() > 1;
        choices.insert({columns[0][0], columns[1][0], columns[2][0]});
    }
    if (choices.empty() && count_angles(header.fields) > 0)
        refuse(name, header.line,
               fmt::format("latitude and longitude are angles, not lengths ({}): project them first, for example with "
                           "cs2cs or pyproj",
                           list_of(header.fields)));
    if (choices.empty())
        refuse(
            name, header.line,
            fmt::format("the header {} ({}): {}", some ? "names only some of x, y and z" : "names none of x, y and z",
                        list_of(header.fields), remedy));
    if (choices.size() > 1 || repeated)
        refuse(name, header.line,
               fmt::format("the header names x, y and z more than once ({}): {}", list_of(header.fields), remedy));
    ColumnChoice choice{*choices.begin()};
    take_unit(name, header, true, choice);
    note_names(header, choice);
    return choice;
}

ColumnChoice columns_by_choice(const std::string& name, const std::string& text, const Header& header,
                               std::size_t width) {
    std::vector<std::string_view> parts;
    for (std::string_view rest = text; !rest.empty();) {
        const std::string_view part = rest.substr(0, rest.find(','));
        parts.push_back(trimmed(part));
        rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    }
    const bool numbers = std::all_of(parts.begin(), parts.end(),
                                     [](std::string_view part) { return whole<std::int64_t>(part).has_value(); });
    if (parts.size() != 3)
        throw InputError(
            fmt::format("{}: --columns '{}' does not name three columns: give three numbers or names, as "
                        "in 2,3,4",
                        name, shown(text)));
    if (!numbers && header.line == 0)
        throw InputError(
            fmt::format("{}: has no header that names columns, so --columns '{}' names none of them: give "
                        "three numbers, as in 2,3,4",
                        name, shown(text)));
    ColumnChoice choice;
    for (std::size_t k = 0; k < 3; ++k) {
        if (!numbers) {
            choice.columns[k] = column_named(name, parts[k], header);
            continue;
        }
        const auto column = whole<std::int64_t>(parts[k]);
        if (*column < 1 || static_cast<std::uint64_t>(*column) > width)
            throw InputError(fmt::format("{}: --columns names column {}, but columns count from 1 and there are {}{}",
                                         name, *column, width,
                                         header.line == 0 ? "" : fmt::format(" ({})", list_of(header.fields))));
        choice.columns[k] = static_cast<std::size_t>(*column - 1);
    }
    const auto& at = choice.columns;
    if (at[0] == at[1] || at[0] == at[2] || at[1] == at[2])
        throw InputError(
            fmt::format("{}: --columns '{}' names a column twice: give three different ones", name, shown(text)));
    take_unit(name, header, false, choice);
    return choice;
}

}  // namespace hausbench::readers
