#include "datasets/formats/column_comments.h"

#include "datasets/formats/parse.h"
#include "datasets/formats/split_line.h"
#include "datasets/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

namespace hausbench::readers {
namespace {

using Fields = std::vector<std::string_view>;

constexpr std::size_t most_comments = 1000;  // the last ones are kept

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c & 0x80) != 0; }

// Returns the part of a field before a unit in brackets.
std::string_view name_part(std::string_view field) { return trimmed(field.substr(0, field.find_first_of("[("))); }

// Returns whether a field is a name as programs write it. A sign or an exponent makes it the name of something else.
bool is_short_name(std::string_view field) {
    std::string_view name = name_part(field);
    if (name.starts_with('-') || name.starts_with('+')) name.remove_prefix(1);
    return !name.empty() && name.size() <= 24 && (is_letter(name.front()) || name.front() == '_') &&
           std::all_of(name.begin(), name.end(), [](char c) {
               return is_letter(c) || is_digit(c) || std::string_view("_.:+-/^*'").find(c) != std::string_view::npos;
           });
}

bool is_of_a_program(std::string_view field) { return name_part(field).find_first_of("_0123456789") < field.size(); }

bool is_usual_name(std::string_view field) {
    static const std::set<std::string> usual = {
        "x",      "y",        "z",         "r",      "g",        "b",     "u",         "v",     "w",      "i",
        "j",      "k",        "n",         "e",      "d",        "h",     "t",         "ra",    "dec",    "theta",
        "phi",    "rho",      "psi",       "radius", "range",    "az",    "azimuth",   "elev",  "alt",    "elevation",
        "height", "altitude", "depth",     "dist",   "distance", "angle", "bearing",   "lat",   "lon",    "latitude",
        "lng",    "long",     "longitude", "east",   "easting",  "north", "northing",  "up",    "down",   "time",
        "value",  "red",      "green",     "blue",   "row",      "col",   "column",    "width", "length", "intensity",
        "id",     "index",    "zenith",    "pitch",  "roll",     "yaw",   "timestamp", "slice", "radial"};
    return usual.contains(lower_case(name_part(field)));
}

// Returns whether the names have one length and differ in at most two characters, as "vel_x", "vel_y" and "vel_z" do.
bool are_alike(const Fields& fields) {
    const std::string_view first = name_part(fields[0]);
    return fields.size() > 2 && std::all_of(fields.begin() + 1, fields.end(), [&](std::string_view field) {
               const std::string_view name = name_part(field);
               if (name.size() != first.size() || name == first) return false;
               std::size_t different = 0;
               for (std::size_t i = 0; i < name.size(); ++i) different += name[i] != first[i] ? 1 : 0;
               return 2 * different <= std::min<std::size_t>(name.size(), 4);
           });
}

// Removes a number before a name, as in "1:y", "[2] x", "3=z" or "col 1: y", and returns it.
std::optional<std::size_t> take_number(std::string_view& field) {
    std::string_view rest = field;
    const std::string lower = lower_case(rest);
    bool touches = false;  // a word of its own, as in "col1"
    for (const std::string_view word : {"column", "col", "field"})
        if (lower.starts_with(word)) {
            rest.remove_prefix(word.size());
            touches = !rest.empty() && is_digit(rest.front());
            rest = trimmed(rest);
            break;
        }
    while (!rest.empty() && std::string_view("[(#$").find(rest.front()) != std::string_view::npos)
        rest.remove_prefix(1);
    const std::size_t digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
    const auto number = whole<std::size_t>(rest.substr(0, digits));
    if (!number || digits > 4) return std::nullopt;
    rest.remove_prefix(digits);
    if (touches && !rest.starts_with(':') && !rest.starts_with('=')) return std::nullopt;
    if (!rest.empty() && std::string_view("]):=.- \t").find(rest.front()) == std::string_view::npos)
        return std::nullopt;
    while (!rest.empty() && std::string_view("]):=.- \t").find(rest.front()) != std::string_view::npos)
        rest.remove_prefix(1);
    field = rest;
    return number;
}

// Removes a number behind a name, as in "y=1", and returns it.
std::optional<std::size_t> take_number_behind(std::string_view& field) {
    const std::size_t mark = field.find_last_of("=:");
    if (mark == std::string_view::npos || mark == 0) return std::nullopt;
    const auto number = whole<std::size_t>(trimmed(field.substr(mark + 1)));
    if (number) field = trimmed(field.substr(0, mark));
    return number;
}

// Removes the numbers of the fields, whether they touch their names or stand before them, and returns them. Returns
// nothing, and changes nothing, if a name has none.
std::vector<std::size_t> take_numbers(Fields& fields) {
    Fields names;
    std::vector<std::size_t> numbers;
    std::optional<std::size_t> pending;
    for (std::string_view field : fields) {
        auto number = pending ? pending : take_number(field);
        if (!number) number = take_number_behind(field);
        if (!number) return {};
        pending = field.empty() ? number : std::nullopt;
        if (pending) continue;
        names.push_back(field);
        numbers.push_back(*number);
    }
    if (pending || names.empty() || !is_letter(names[0].front())) return {};
    fields = std::move(names);
    return numbers;
}

// Removes words such as "columns:" or "Point format: " from the start of a comment.
Lead take_lead(std::string_view& text) {
    static const std::set<std::string> naming = {"column", "columns", "cols",  "field", "fields",
                                                 "format", "names",   "order", "axes",  "variables"};
    static const std::set<std::string> filling = {"column", "columns",     "cols",   "fields", "format", "order",
                                                  "axes",   "coordinates", "coords", "are",    "is",     "in"};
    Lead lead = Lead::none;
    const std::size_t mark = text.find_first_of(":=");
    if (mark != std::string_view::npos && mark > 1 && text.substr(0, mark).find_first_of(",;\t0123456789") > mark) {
        Fields head;
        for (std::string_view rest = text.substr(0, mark); !trimmed(rest).empty();) head.push_back(next_word(rest));
        const bool names = std::any_of(head.begin(), head.end(),
                                       [](std::string_view word) { return naming.contains(lower_case(word)); });
        const bool blank = mark + 1 < text.size() && blanks.find(text[mark + 1]) != std::string_view::npos;
        const bool axis = head.size() == 1 && coordinates_named(head) > 0;
        if (head.size() < 5 && !axis && (names || blank)) {
            lead = names ? Lead::names : Lead::other;
            text = trimmed(text.substr(mark + 1));
        }
    }
    for (std::string_view rest = text; filling.contains(lower_case(next_word(rest)));) text = trimmed(rest);
    return lead;
}

// Returns the words of a comment, whatever separates them.
Fields words_of(std::string_view text) {
    Fields words;
    constexpr std::string_view separators = " \t\r\v\f,;|/";
    while (true) {
        text.remove_prefix(std::min(text.find_first_not_of(separators), text.size()));
        if (text.empty()) return words;
        words.push_back(text.substr(0, text.find_first_of(separators)));
        text.remove_prefix(words.back().size());
    }
}

// Splits a single word such as "y/x/z" or "Y|X|Z".
void split_joined(Fields& fields) {
    if (fields.size() != 1 || fields[0].find_first_of("/|") == std::string_view::npos) return;
    Fields parts;
    for (std::string_view rest = fields[0]; !rest.empty();) {
        const std::string_view part = rest.substr(0, rest.find_first_of("/|"));
        parts.push_back(trimmed(part));
        rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    }
    if (parts.size() > 2) fields = std::move(parts);
}

// Returns whether a word is x, y and z in another order, as in "zyx", or names such coordinates, as in "NED".
bool is_another_order(std::string_view word) {
    std::string letters = lower_case(word);
    if (letters == "xyz") return false;
    if (letters == "ned" || letters == "neu" || letters == "lla") return true;
    std::sort(letters.begin(), letters.end());
    return letters == "xyz";
}

constexpr std::string_view with_columns = "choose the columns with --columns, by number (in Python columns=\"2,3,4\")";

}  // namespace

void ColumnComments::add(std::string_view text, std::uint32_t line) {
    constexpr std::string_view marks = "#/%*=-~! \t\r\v\f";
    const std::size_t start = std::min(text.find_first_not_of(marks), text.size());
    // "-x y z" are not x, y and z; "--- x y z" are.
    const bool sign =
        start > 1 && start < text.size() && text[start - 1] == '-' && text[start - 2] != '-' && is_letter(text[start]);
    text.remove_prefix(sign ? start - 1 : start);
    text = text.substr(0, text.find_last_not_of("#*=~ \t\r\v\f") + 1);
    if (text.empty()) return;
    take_length_unit(text);
    Comment comment;
    comment.line = line;
    comment.lead = take_lead(text);
    const bool whole_in_brackets =
        text.size() > 2 && (text.front() == '(' || text.front() == '[') && text.find_first_of(")]") == text.size() - 1;
    if (whole_in_brackets && text.find(',') != std::string_view::npos) text = text.substr(1, text.size() - 2);
    bool by_blanks = false;
    if (!split_fields(text, comment.fields, by_blanks)) return;
    if (by_blanks)
        std::erase_if(comment.fields, [](std::string_view field) {
            return std::none_of(field.begin(), field.end(), [](char c) { return is_letter(c) || is_digit(c); });
        });
    for (std::string_view& field : comment.fields) {
        if (field.size() > 1 && field.front() == '#') field.remove_prefix(1);
        const bool quoted = field.size() > 2 && std::string_view("<{'").find(field.front()) != std::string_view::npos &&
                            std::string_view(">}'").find(field.back()) != std::string_view::npos;
        if (quoted) field = field.substr(1, field.size() - 2);
    }
    if (comment.fields.empty()) return;
    const std::size_t before = comment.fields.size();
    split_joined(comment.fields);
    comment.separated = !by_blanks || comment.fields.size() > before;
    comment.words = words_of(text);
    std::string_view rest = text;
    comment.numbers = take_numbers(comment.fields);
    if (const auto number = take_number(rest); number && comment.numbers.size() < 2 && !rest.empty()) {
        Fields words;
        if (split_fields(rest, words, by_blanks) && is_short_name(words[0])) {
            comment.fields = {words[0]};
            comment.numbers = {*number};
            comment.single = true;
        }
    }
    comments_.push_back(std::move(comment));
    if (comments_.size() > most_comments) comments_.pop_front();
}

void ColumnComments::take_length_unit(std::string_view text) {
    const std::string lower = lower_case(text.substr(0, 12));
    for (const std::string_view key : {"length unit", "units", "unit"}) {
        if (!lower.starts_with(key)) continue;
        const std::string_view rest = trimmed(text.substr(key.size()));
        const std::size_t start = rest.find_first_not_of(":=, \t");
        if (start == 0 || start == std::string_view::npos) return;
        const std::string_view unit = bare_unit(rest.substr(start));
        if (key == "length unit" || unit_named(unit)) length_unit_ = unit;  // other units may be of other columns
        return;
    }
}

bool ColumnComments::name_coordinates() const {
    return std::any_of(comments_.begin(), comments_.end(),
                       [](const Comment& comment) { return coordinates_named(comment.fields) > 1; });
}

bool ColumnComments::is_list(const Comment& comment, std::size_t width) const {
    const Fields& fields = comment.fields;
    if (fields.size() != width || width < 3) return false;
    if (coordinates_named(fields) == 3) return true;
    if (std::set<std::string_view>(fields.begin(), fields.end()).size() != fields.size()) return false;
    if (std::all_of(fields.begin(), fields.end(),
                    [](std::string_view field) { return is_usual_name(field.substr(0, field.find_first_of(blanks))); }))
        return true;
    if (!std::all_of(fields.begin(), fields.end(), is_short_name)) return false;
    return comment.lead == Lead::names || comment.separated || (!comment.numbers.empty() && !comment.single) ||
           are_alike(fields) || std::count_if(fields.begin(), fields.end(), is_of_a_program) > 1 ||
           std::count_if(fields.begin(), fields.end(), is_usual_name) > 1 ||
           (comment.lead == Lead::none && std::all_of(fields.begin(), fields.end(), [](std::string_view field) {
                return name_part(field).size() < 4;
            }));
}

Header ColumnComments::header_of(const std::string& name, const Comment& comment, std::size_t width) const {
    Header header{comment.fields, comment.line};
    header.loose = true;
    if (comment.numbers.empty()) return header;
    const std::size_t first = *std::min_element(comment.numbers.begin(), comment.numbers.end());
    std::vector<bool> named(width, false);
    for (std::size_t i = 0; i < width; ++i) {
        const std::size_t column = comment.numbers[i] - first;
        if (first > 1 || column >= width || named[column])
            refuse(name, comment.line,
                   fmt::format("the comment does not number its names from 1 to {}: {}", width, with_columns));
        named[column] = true;
        header.fields[column] = comment.fields[i];
    }
    return header;
}

ColumnComments::Comment ColumnComments::joined_singles(std::size_t width) const {
    Comment joined;
    for (const Comment& comment : comments_) {
        if (!comment.single) continue;
        joined.fields.push_back(comment.fields[0]);
        joined.numbers.push_back(comment.numbers[0]);
        joined.line = comment.line;
    }
    joined.single = true;
    std::vector<std::size_t> sorted = joined.numbers;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (sorted[i] != sorted[0] + i) return {};
    return sorted.size() == width && sorted[0] < 2 ? joined : Comment{};
}

void ColumnComments::refuse_unclear(const std::string& name, const Comment& comment, std::size_t width) const {
    const Fields& words = comment.words;
    if (words.size() <= width + 2 && names_angles(words))
        refuse(name, comment.line,
               "the comment names latitude and longitude, which are angles: project them first, or choose columns that "
               "are lengths with --columns (in Python columns=\"2,3,4\")");
    const Fields first(words.begin(), words.begin() + std::min<std::ptrdiff_t>(3, std::ssize(words)));
    const bool begins = words.size() > 3 && coordinates_named(first) == 3 && names_another_order(first);
    if (begins || (!words.empty() && is_another_order(name_part(words[0]))))
        refuse(name, comment.line,
               fmt::format("the comment names x, y and z in another order, but has {} word{} for {} columns: {}",
                           words.size(), words.size() == 1 ? "" : "s", width, with_columns));
}

Header ColumnComments::names(const std::string& name, std::size_t width) const {
    std::vector<Comment> lists;
    Fields units;
    for (const Comment& comment : comments_) {
        Comment list = comment;
        // "x y z mm" and "x y z in mm"
        const bool unit = list.fields.size() > width && list.fields.size() <= width + 2 &&
                          unit_named(bare_unit(list.fields.back())) &&
                          (list.fields.size() == width + 1 || lower_case(list.fields[width]) == "in");
        if (unit) list.fields.resize(width);
        if (unit && is_list(list, width))
            units.assign(width, bare_unit(comment.fields.back()));
        else if (comment.fields.size() == width && count_units(comment.fields) > 2) {
            units = comment.fields;
            continue;
        }
        if (is_list(list, width))
            lists.push_back(std::move(list));
        else
            refuse_unclear(name, comment, width);
    }
    if (Comment joined = joined_singles(width); is_list(joined, width)) lists.push_back(std::move(joined));
    if (lists.empty()) return {};
    Header header = header_of(name, lists.back(), width);
    for (const Comment& list : lists) {
        const Header other = header_of(name, list, width);
        if (coordinates_named(other.fields) == 3 && !names_angles(other.fields) &&
            columns_by_name(name, other).columns != columns_by_name(name, header).columns)
            refuse(
                name, header.line,
                fmt::format("this comment and one before it name x, y and z in different columns: {}", with_columns));
    }
    header.units = std::move(units);
    return header;
}

Header ColumnComments::words(std::size_t width) const {
    for (auto comment = comments_.rbegin(); comment != comments_.rend(); ++comment)
        if (comment->fields.size() == width && width > 2) return {comment->fields, comment->line, {}, true};
    return {};
}

}  // namespace hausbench::readers
