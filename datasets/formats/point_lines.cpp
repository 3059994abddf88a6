// Reads point clouds as lines of decimal numbers: .xyz, .pts, .txt, .asc, .xyzn, .xyzrgb, .csv, and the points of a
// text PCD file (pcd.cpp).
//
// Fields. The separator of a line is ';' if the line contains one, otherwise ',' if it contains one, otherwise a tab if
// a field between tabs is empty or has several words, otherwise white space. A field in double quotes may contain
// separators. A comment begins with '#', at the beginning of a line or after white space, or with "//" at the beginning
// of a line. A line with a single integer gives the number of points to come (.pts, some .xyz; in .csv only after a
// comment that names columns).
//
// Columns. These decide, in this order, which columns are x, y and z:
// 1. LoadOptions::columns, as numbers that count from 1 or as names of the header;
// 2. a header, the first line of the file or a comment before the first point. column_names.cpp has the names that it
//    may have. A comment is a header if it has as many fields as the first point and names two coordinates or more. A
//    header without a full set of names is refused, and so is a line with more fields than the header: its decimals may
//    have commas, or its first field no name;
// 3. the format: lines of .xyzn and .xyzrgb have three or six columns, and those of .pts any number after a count line.
//    They begin with x, y and z (then the normal, the colour, or intensity and colour);
// 4. a file with exactly three columns has x, y and z.
// Anything else is refused with its first line: the reader does not guess. A molecule's .xyz file (a count, a comment,
// and then an element and x, y and z in each line) is read only if columns are chosen, and if it has one frame.
//
// Values. A field such as NA, nan, inf or an empty one is a missing measurement: the coordinate becomes NaN or
// infinite, which finish() refuses or drops. Any other text is an error. The coordinates are the doubles nearest to the
// decimal numbers; those of a text PCD file with float32 fields are the nearest float32. A unit in the names of all
// three columns, as in "x [mm]", is the stated unit.
#include "datasets/formats/point_lines.h"
#include "algorithms/error.h"
#include "datasets/formats/parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace hausbench::readers {
namespace {

std::string_view unquoted(std::string_view text) {
    const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    return quoted ? trimmed(text.substr(1, text.size() - 2)) : text;
}

// Returns the position after the quoted field at the start of `text`, or npos if the field does not end. Two quotes in
// it stand for one.
std::size_t end_of_quotes(std::string_view text) {
    for (std::size_t i = 1; i < text.size(); ++i) {
        if (text[i] != '"') continue;
        if (i + 1 == text.size() || text[i + 1] != '"') return i + 1;
        ++i;
    }
    return std::string_view::npos;
}

// Calls `outside(i)` for each character that is not in a quoted field, until it returns true. Quotes begin a field only
// at the start of the line, or after a separator or white space. Returns false if a quoted field does not end.
template <class Outside> bool scan(std::string_view line, const Outside& outside) {
    bool begins = true;
    for (std::size_t i = 0; i < line.size();) {
        if (begins && line[i] == '"') {
            const std::size_t size = end_of_quotes(line.substr(i));
            if (size == std::string_view::npos) return false;
            i += size;
            begins = false;
            continue;
        }
        if (outside(i)) return true;
        begins = line[i] == ',' || line[i] == ';' || blanks.find(line[i]) != std::string_view::npos;
        ++i;
    }
    return true;
}

// Splits a line at a separator, or at white space if the separator is ' '.
void split_at(std::string_view line, char separator, std::vector<std::string_view>& fields) {
    fields.clear();
    std::size_t start = 0;
    const auto add = [&](std::size_t end) {
        const std::string_view field = trimmed(line.substr(start, end - start));
        if (separator != ' ' || !field.empty()) fields.push_back(unquoted(field));
        start = end + 1;
    };
    scan(line, [&](std::size_t i) {
        if (separator == ' ' ? blanks.find(line[i]) != std::string_view::npos : line[i] == separator) add(i);
        return false;
    });
    add(line.size());
}

bool all_numbers(std::string_view field) {
    for (auto word = next_word(field); !word.empty(); word = next_word(field))
        if (!decimal(word)) return false;
    return true;
}

// Returns whether a field is two numbers or more, as between the commas of "1,5 2,5 3,5".
bool several_numbers(std::string_view field) {
    return field.find_first_of(blanks) != std::string_view::npos && all_numbers(field);
}

// Appends units in brackets, which blanks separate from their names, to the names: "x", "[mm]" becomes "x [mm]".
void join_units(std::vector<std::string_view>& fields) {
    std::vector<std::string_view> joined;
    for (const std::string_view field : fields) {
        const bool unit = field.size() > 2 && ((field.front() == '[' && field.back() == ']') ||
                                               (field.front() == '(' && field.back() == ')'));
        if (unit && !joined.empty() && joined.back().end() <= field.begin())
            joined.back() = {joined.back().begin(), field.end()};
        else
            joined.push_back(field);
    }
    fields = std::move(joined);
}

// Returns the line without a comment at its end.
std::string_view without_comment(std::string_view line) {
    std::size_t end = line.size();
    scan(line, [&](std::size_t i) {
        if (line[i] != '#' || (i > 0 && blanks.find(line[i - 1]) == std::string_view::npos)) return false;
        end = i;
        return true;
    });
    return line.substr(0, end);
}

// Returns whether the file is a molecule: a count, a comment, and then an element and three numbers.
bool is_molecule(std::string_view bytes) {
    std::string_view count = trimmed(next_line(bytes));
    next_line(bytes);
    std::string_view atom = next_line(bytes);
    const std::string_view element = next_word(atom);
    const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
    if (!whole<std::uint64_t>(count) || element.empty() || !is_letter(element.front()) || decimal(element))
        return false;
    for (int k = 0; k < 3; ++k)
        if (!decimal(next_word(atom))) return false;
    return true;
}

// Returns whether a first line is one that pandas writes: an empty field, and then 0, 1, 2, ...
bool numbers_columns(const std::vector<std::string_view>& fields, std::size_t first) {
    for (std::size_t i = first; i < fields.size(); ++i)
        if (fields[i] != std::to_string(i - first)) return false;
    return fields.size() >= first + 3;
}

constexpr std::size_t no_limit = std::numeric_limits<std::size_t>::max();

// Splits a line at its separators into fields, without the quotes around them. Returns false if a quoted field does not
// end. `by_blanks` tells whether white space was the separator.
bool split_fields(std::string_view line, std::vector<std::string_view>& fields, bool& by_blanks) {
    bool semicolon = false, comma = false, tab = false;
    if (!scan(line, [&](std::size_t i) {
            semicolon = semicolon || line[i] == ';';
            comma = comma || line[i] == ',';
            tab = tab || line[i] == '\t';
            return false;
        }))
        return false;
    by_blanks = false;
    if (semicolon || comma) {
        split_at(line, semicolon ? ';' : ',', fields);
        return true;
    }
    if (tab) {
        split_at(line, '\t', fields);
        // Words that blanks separate within tabs are fields of their own if they are numbers.
        if (fields.size() > 2 && std::any_of(fields.begin(), fields.end(), [](std::string_view field) {
                return field.empty() || (field.find(' ') != std::string_view::npos && !all_numbers(field));
            }))
            return true;
    }
    split_at(line, ' ', fields);
    join_units(fields);
    by_blanks = true;
    return true;
}

}  // namespace

PointLines::PointLines(const Input& input)
    : name_(input.name),
      format_(input.format),
      choice_(input.options.columns),
      molecule_(format_ != "csv" && is_molecule(input.bytes)) {
    if (molecule_ && choice_.empty())
        throw InputError(name_ +
                         ": is a molecule (a count, a comment, then an element and x, y, z in each line), not a point "
                         "cloud: to read its atoms as points, choose --columns 2,3,4 (in Python columns=\"2,3,4\")");
}

PointLines::PointLines(std::string name, std::array<std::size_t, 3> columns, std::array<bool, 3> float32,
                       std::size_t width, std::uint64_t announced)
    : name_(std::move(name)),
      format_("pcd"),
      columns_(columns),
      float32_(float32),
      chosen_(true),
      width_(width),
      announced_(announced),
      counted_(true) {}

void PointLines::add_lines(std::string_view bytes, std::uint32_t first) {
    while (!bytes.empty()) add(next_line(bytes), first++);
}

void PointLines::add(std::string_view line, std::uint32_t number) {
    line_ = trimmed(line);
    if (line_.empty() || (molecule_ && number == 2)) return;
    if (line_.front() == '#' || line_.starts_with("//")) return take_comment(line_, number);
    if (!split_fields(without_comment(line), fields_, blanks_))
        refuse(name_, number, "a quoted field begins here and does not end: write each point on one line");
    if (take_count(line_, number) || take_header(number)) return;
    if (!chosen_) choose_columns(number);
    check_width(number);
    add_point(number);
}

bool PointLines::take_count(std::string_view line, std::uint32_t number) {
    const bool table = format_ == "csv" && comment_.line == 0;  // CloudCompare writes a comment and a count
    const bool may = !table && format_ != "pcd" && fields_.size() == 1;
    const auto count = may ? whole<std::uint64_t>(trimmed(without_comment(line))) : std::nullopt;
    if (!count || soup_.points.size() != announced_) return false;
    if (molecule_ && counted_)
        refuse(name_, number, "a second frame of the molecule begins here: keep one frame in the file");
    announced_ += std::min(*count, std::uint64_t{1} << 40);
    counted_ = true;
    count_line_ = number;
    return true;
}

bool PointLines::take_header(std::uint32_t number) {
    if (chosen_ || counted_ || header_.line != 0) return false;
    if (lower_case(line_).starts_with("sep=")) return true;  // by which Excel knows the separator
    const bool numbered = !fields_.empty() && fields_[0].empty() && numbers_columns(fields_, 1);
    if (!numbered && !may_be_header(fields_)) return false;
    header_ = {fields_, number};
    if (numbered)
        soup_.notes.push_back(fmt::format("line {} ('{}') counts as a header, because it only numbers the columns",
                                          number, shown(line_)));
    return true;
}

void PointLines::take_comment(std::string_view line, std::uint32_t number) {
    if (chosen_ || header_.line != 0) return;
    line.remove_prefix(std::min(line.find_first_not_of("#/ "), line.size()));
    Header comment{{}, number};
    bool by_blanks = false;
    if (!split_fields(line, comment.fields, by_blanks)) return;
    if (!choice_.empty() ? comment.fields.size() > 2 : coordinates_named(comment.fields) > 1) {
        comments_differ_ = comments_differ_ || (comment_.line != 0 && names_another_order(comment.fields) !=
                                                                          names_another_order(comment_.fields));
        comment_ = std::move(comment);
    }
}

std::optional<std::array<std::size_t, 3>> PointLines::columns_if_named() const {
    try {
        if (header_.line != 0) return columns_by_name(name_, header_).columns;
    } catch (const InputError&) {  // it names none
    }
    return std::nullopt;
}

void PointLines::choose_columns(std::uint32_t number) {
    chosen_ = true;
    const bool commented = header_.line == 0 && comment_.fields.size() == fields_.size();
    if (header_.line == 0 && !commented && choice_.empty() && names_angles(comment_.fields))
        refuse(name_, comment_.line,
               "the comment names latitude and longitude, which are angles: project them first, or choose columns that "
               "are lengths with --columns (in Python columns=\"2,3,4\")");
    if (header_.line == 0 && comments_differ_ && choice_.empty())
        refuse(
            name_, comment_.line,
            "this comment and one before it name x, y and z in different columns: choose the columns with --columns, "
            "by number (in Python columns=\"2,3,4\")");
    if (header_.line == 0 && !commented && choice_.empty() && names_another_order(comment_.fields))
        refuse(name_, comment_.line,
               fmt::format("the comment names x, y and z in another order, but has {} words for {} columns: choose the "
                           "columns with --columns, by number (in Python columns=\"2,3,4\")",
                           comment_.fields.size(), fields_.size()));
    if (commented) header_ = comment_;
    if (header_.line != 0) width_ = header_.fields.size();
    ColumnChoice choice;
    if (!choice_.empty()) {
        const bool numbers = choice_.find_first_not_of("0123456789+-, ") == std::string::npos;
        if (numbers) width_ = no_limit;
        // write.table of R names one column less than there are; then the names belong to the columns after the first.
        const bool shifted = numbers && header_.fields.size() < fields_.size();
        choice = columns_by_choice(name_, choice_, shifted ? Header{{}, header_.line} : header_,
                                   numbers ? fields_.size() : header_.fields.size());
        if (const auto named = columns_if_named(); named && *named != choice.columns)
            soup_.notes.emplace_back("its header names other columns x, y and z, but --columns counts");
    } else if (header_.line != 0) {
        choice = columns_by_name(name_, header_);
    } else {
        return choose_unnamed_columns(number);
    }
    exact_ = width_ != no_limit;
    columns_ = choice.columns;
    soup_.stated = choice.stated;
    soup_.notes.insert(soup_.notes.end(), choice.notes.begin(), choice.notes.end());
}

void PointLines::choose_unnamed_columns(std::uint32_t number) {
    if (format_ == "pts" && counted_) return;
    const bool six = (format_ == "xyzn" || format_ == "xyzrgb") && fields_.size() == 6;
    width_ = six ? 6 : 3;
    exact_ = six;
    if (format_ == "csv" && numbers_columns(fields_, 0) && fields_.size() == 3)
        soup_.notes.push_back(
            fmt::format("line {} ('{}') counts as a point: delete it if it numbers the columns", number, shown(line_)));
}

void PointLines::refuse_unnamed(std::uint32_t number) const {
    const bool decimals = std::any_of(fields_.begin(), fields_.end(), several_numbers);
    const std::string_view first = format_ == "csv" ? "2,3,4" : "1,2,3";
    refuse(name_, number,
           decimals ? fmt::format("'{}': write decimals with a point, not a comma", shown(line_))
                    : fmt::format("{} columns, and nothing names them ('{}{}'): choose those of x, y and z, as in "
                                  "--columns {} (in Python columns=\"{}\")",
                                  fields_.size(), shown(line_), line_.size() > 40 ? "..." : "", first, first));
}

void PointLines::check_width(std::uint32_t number) {
    while (fields_.size() > width_ && fields_.back().empty()) fields_.pop_back();
    const bool named = header_.line != 0 && width_ == header_.fields.size();
    if (fields_.size() > width_) {
        if (format_ == "pcd")
            refuse(name_, number,
                   fmt::format("{} columns, and FIELDS and COUNT name {}: correct the header", fields_.size(), width_));
        if (!named) refuse_unnamed(number);
        refuse(name_, number,
               fmt::format("{} columns, and the header names {}: write decimals with a point, no separator within a "
                           "field, and a name for each column, or choose columns by number, as in --columns 2,3,4 (in "
                           "Python columns=\"2,3,4\")",
                           fields_.size(), width_));
    }
    if (exact_ && (blanks_ || !named) && fields_.size() < width_)
        refuse(name_, number,
               fmt::format("{} columns, and {} {}: write a value for each column", fields_.size(),
                           named ? "the header names" : "the first point has", width_));
}

double PointLines::coordinate(std::size_t k, std::uint32_t number) const {
    const std::size_t column = columns_[k];
    const auto where = [&] { return fmt::format("column {} ({})", column + 1, "xyz"[k]); };
    if (column >= fields_.size())
        refuse(name_, number,
               fields_.size() < 3 ? fmt::format("{} column{}, and a point needs x, y and z", fields_.size(),
                                                fields_.size() == 1 ? "" : "s")
                                  : where() + " is missing");
    const std::string_view field = fields_[column];
    const auto value = float32_[k] ? std::optional<double>(decimal<float>(field)) : decimal(field);
    if (value) return *value;
    if (is_missing(field)) return std::numeric_limits<double>::quiet_NaN();
    const bool comma = field.find(',') != std::string_view::npos || several_numbers(field);
    refuse(name_, number,
           comma ? fmt::format("{} is '{}': write decimals with a point, not a comma", where(), shown(field))
                 : fmt::format("{} is '{}', which is not a number", where(), shown(field)));
}

void PointLines::add_point(std::uint32_t number) {
    Vec3 point;
    for (std::size_t k = 0; k < 3; ++k) point[static_cast<Eigen::Index>(k)] = coordinate(k, number);
    if (counted_ && soup_.points.size() >= announced_)
        refuse(name_, number, fmt::format("another point, though {} announces {}", announcer(), announced_));
    soup_.points.push_back(point);
    soup_.point_lines.push_back(number);
}

std::string PointLines::announcer() const {
    return count_line_ == 0 ? "the header" : fmt::format("line {}", count_line_);
}

Soup PointLines::finish() {
    if (counted_ && soup_.points.size() < announced_)
        throw InputError(fmt::format("{}: is truncated: {} announces {} points, and {} are there", name_, announcer(),
                                     announced_, soup_.points.size()));
    return std::move(soup_);
}

namespace {

Soup read_lines(Input input) {
    if (input.bytes.starts_with("\xef\xbb\xbf")) input.bytes.remove_prefix(3);
    if (input.bytes.substr(0, 4096).find('\0') != std::string_view::npos)
        throw InputError(input.name + ": is binary or UTF-16, not lines of decimal numbers: write it as UTF-8 text");
    PointLines points(input);
    points.add_lines(input.bytes, 1);
    return points.finish();
}

}  // namespace

Soup read_xyz(const Input& input) { return read_lines(input); }
Soup read_csv(const Input& input) { return read_lines(input); }

}  // namespace hausbench::readers
