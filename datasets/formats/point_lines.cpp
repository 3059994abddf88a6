// Reads point clouds as lines of decimal numbers: .xyz, .pts, .txt, .asc, .xyzn, .xyzrgb, .csv, and the points of a
// text PCD file (pcd.cpp).
//
// Fields. The separator of a line is ';' if the line contains one, otherwise ',' if it contains one, otherwise a tab if
// a field between tabs is empty or has several words, otherwise white space. A field in double quotes may contain
// separators. A comment begins with '#', at the beginning of a line or after white space, or with "//" or '%' at the
// beginning of a line. A line with a single integer gives the number of points to come (.pts, some .xyz; in .csv only
// after a comment that names columns).
//
// Columns. These decide, in this order, which columns are x, y and z:
// 1. LoadOptions::columns, as numbers that count from 1 or as names of the header;
// 2. a header, the first line of the file or a comment before the first point. column_names.cpp has the names that
//    it may have, and column_comments.h tells which comments are headers. A header without a full set of names is
//    refused, and so is a line with more fields than the header: its decimals may have commas, or its first field no
//    name. If columns are chosen by number and the first line has a word above a number, it may be a header of numbers,
//    and is refused;
// 3. the format: lines of .xyzn and .xyzrgb have three or six columns, and those of .pts any number after a count line.
//    They begin with x, y and z (then the normal, the colour, or intensity and colour);
// 4. a file with exactly three columns has x, y and z.
// Anything else is refused with its first line: the reader does not guess. A molecule's .xyz file (a count, a comment,
// and then an element and x, y and z in each line) is read only if columns are chosen, and if it has one frame.
//
// Values. A field such as NA, nan, inf or an empty one is a missing measurement: the coordinate becomes NaN or
// infinite, which finish() refuses or drops. Any other text is an error. The coordinates are the doubles nearest to the
// decimal numbers, which may have an exponent as in 1.5D+03; those of a text PCD file with float32 fields are the
// nearest float32. A unit in the names of all three columns, as in "x [mm]", or in a line below the header is the
// stated unit.
#include "datasets/formats/point_lines.h"
#include "algorithms/error.h"
#include "datasets/formats/parse.h"
#include "datasets/formats/split_line.h"
#include "datasets/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

namespace hausbench::readers {
namespace {

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

// Returns the double nearest to a decimal number, which may have an exponent as Fortran writes it: 1.5D+03.
std::optional<double> number_in(std::string_view field) {
    const std::size_t mark = field.find_first_of("dD");
    if (mark == std::string_view::npos || mark == 0 || mark + 1 == field.size()) return decimal(field);
    if (field.find_first_not_of("0123456789+-.dD") != std::string_view::npos) return std::nullopt;
    std::string copy(field);
    copy[mark] = 'e';
    return decimal(copy);
}

// Returns whether a field may be a number with a decimal comma, or with separators of thousands: 1,5 or 1,234.5 or
// 1'234 or, with a space that does not break, 1 234.
bool has_separators(std::string_view field) {
    return field.find_first_of("0123456789") != std::string_view::npos &&
           (field.find_first_of(",'") != std::string_view::npos || field.find("\xc2\xa0") != std::string_view::npos ||
            field.find("\xe2\x80") != std::string_view::npos);
}

constexpr std::string_view plain_numbers =
    "write decimals with a point, not a comma, and thousands without a separator";

constexpr std::size_t no_limit = std::numeric_limits<std::size_t>::max();

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
    if (line_.front() == '#' || line_.front() == '%' || line_.starts_with("//")) {
        if (!chosen_ && header_.line == 0) comments_.add(line_, number);
        return;
    }
    if (!split_fields(without_comment(line), fields_, blanks_))
        refuse(name_, number, "a quoted field begins here and does not end: write each point on one line");
    if (take_count(line_, number) || take_header(number) || take_units()) return;
    if (!chosen_) choose_columns();
    check_width(number);
    if (header_.line == 0 && soup_.points.empty() && format_ == "csv" && numbers_columns(fields_, 0))
        soup_.notes.push_back(
            fmt::format("line {} ('{}') counts as a point: delete it if it numbers the columns", number, shown(line_)));
    if (first_.line != 0) check_first();
    first_.line = 0;
    add_point(number);
    if (soup_.points.size() == 1 && header_.line == 0 && !choice_.empty()) first_ = {fields_, number};
}

bool PointLines::take_count(std::string_view line, std::uint32_t number) {
    const bool table = format_ == "csv" && !comments_.name_coordinates();  // CloudCompare writes a comment and a count
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
    if (!numbered && !may_be_header(fields_) && coordinates_named(fields_) < 3) return false;
    header_ = {fields_, number, {}, blanks_};
    header_text_ = line_;
    if (numbered)
        soup_.notes.push_back(fmt::format("line {} ('{}') counts as a header, because it only numbers the columns",
                                          number, shown(line_)));
    return true;
}

bool PointLines::take_units() {
    if (chosen_ || header_.line == 0 || !header_.units.empty() || count_units(fields_) == 0) return false;
    header_.units = fields_;
    return true;
}

void PointLines::check_first() const {
    static const std::set<std::string> titles = {"id", "name", "label", "point", "index", "no", "nr", "number", "code"};
    for (std::size_t i = 0; i < std::min(fields_.size(), first_.fields.size()); ++i) {
        const std::string_view title = first_.fields[i], below = fields_[i];
        if (std::find(columns_.begin(), columns_.end(), i) != columns_.end() || decimal(title) || title == below)
            continue;
        const bool number_below = (title.empty() || !is_missing(title)) && decimal(below);
        if (number_below || titles.contains(lower_case(title)))
            refuse(name_, first_.line,
                   fmt::format("is this a header of numbers, or a point? Column {} is '{}', and '{}' in the next line: "
                               "delete the line if it is a header, or move it down if it is a point",
                               i + 1, shown(title), shown(below)));
    }
}

std::optional<std::array<std::size_t, 3>> PointLines::columns_if_named() const {
    try {
        if (header_.line != 0) return columns_by_name(name_, header_).columns;
    } catch (const InputError&) {  // it names none
    }
    return std::nullopt;
}

void PointLines::choose_columns() {
    chosen_ = true;
    const bool prose = std::none_of(fields_.begin(), fields_.end(), [](auto field) { return number_in(field); });
    if (header_.line != 0 && prose && choice_.empty() && coordinates_named(header_.fields) < 2)
        refuse_prose(header_.line, header_text_);
    if (header_.line == 0)
        header_ = choice_.empty() ? comments_.names(name_, fields_.size()) : comments_.words(fields_.size());
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
        choose_unnamed_columns();
        if (!comments_.length_unit().empty()) take_length_unit();
        return;
    }
    exact_ = width_ != no_limit;
    columns_ = choice.columns;
    soup_.stated = choice.stated;
    soup_.notes.insert(soup_.notes.end(), choice.notes.begin(), choice.notes.end());
    if (soup_.stated.unit.empty() && !comments_.length_unit().empty()) take_length_unit();
}

void PointLines::take_length_unit() {
    soup_.stated = unit_stated_as(comments_.length_unit());
    if (soup_.stated.micrometres == 0) soup_.notes.push_back(unknown_unit(comments_.length_unit()));
}

void PointLines::refuse_prose(std::uint32_t number, std::string_view text) const {
    refuse(name_, number,
           fmt::format("expected lines of three numbers, as in '1.5 2 -3', perhaps below their names, and found '{}'",
                       shown(text)));
}

void PointLines::choose_unnamed_columns() {
    if (format_ == "pts" && counted_) return;
    const bool six = (format_ == "xyzn" || format_ == "xyzrgb") && fields_.size() == 6;
    width_ = six ? 6 : 3;
    exact_ = six;
}

void PointLines::refuse_unnamed(std::uint32_t number) const {
    const bool decimals = std::any_of(fields_.begin(), fields_.end(), several_numbers);
    const auto numbers =
        std::count_if(fields_.begin(), fields_.end(), [](auto field) { return bool(number_in(field)); });
    if (numbers < 3 && !decimals) refuse_prose(number, line_);
    const std::string_view first = format_ == "csv" ? "2,3,4" : "1,2,3";
    refuse(name_, number,
           decimals
               ? fmt::format("'{}': {}", shown(line_), plain_numbers)
               : fmt::format("{} columns, and nothing names them ('{}{}'): choose the columns of x, y and z, as in "
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
    const bool count = fields_.size() == 1 && soup_.points.empty() && whole<std::uint64_t>(trimmed(line_));
    if (column >= fields_.size())
        refuse(name_, number,
               fields_.size() < 3
                   ? fmt::format("{} column{}, and a point needs x, y and z{}", fields_.size(),
                                 fields_.size() == 1 ? "" : "s",
                                 count ? fmt::format("; if '{}' is the number of points, which a table "
                                                     "does not have, delete the line, or name the file .xyz",
                                                     shown(line_))
                                       : "")
                   : where() + " is missing");
    const std::string_view field = fields_[column];
    const auto value = float32_[k] ? std::optional<double>(decimal<float>(field)) : number_in(field);
    if (value) return *value;
    if (is_missing(field)) return std::numeric_limits<double>::quiet_NaN();
    const bool comma = has_separators(field) || several_numbers(field);
    refuse(name_, number,
           comma ? fmt::format("{} is '{}': {}", where(), shown(field), plain_numbers)
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
    if (soup_.points.empty() && header_.line != 0 && coordinates_named(header_.fields) < 2)
        refuse_prose(header_.line, header_text_);
    if (counted_ && soup_.points.size() < announced_)
        throw InputError(fmt::format("{}: is truncated: {} announces {} points, and {} are there", name_, announcer(),
                                     announced_, soup_.points.size()));
    return std::move(soup_);
}

namespace {

Soup read_lines(Input input) {
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
