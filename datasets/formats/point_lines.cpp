// Reads point clouds as lines of decimal numbers: .xyz, .pts, .csv, and the points of a text PCD file (pcd_file.cpp).
//
// A line has x, y and z, and then anything else (intensity, colours, normals), which is ignored. The separator of a
// line is ';' if the line contains one, otherwise ',' if it contains one, otherwise white space. '#' begins a comment,
// and so does "//" at the beginning of a line. A line with a single integer gives the number of points (.pts, some
// .xyz). The first line may be a header, with columns named x, y and z in any order and in upper or lower case; a
// header of a .csv file without these names is skipped. A line of a .csv file with more columns than the header is an
// error: it probably has decimal commas, or a separator within quotes, and its numbers would be read from the wrong
// columns.
#include "datasets/formats/point_lines.h"
#include "algorithms/error.h"
#include "datasets/formats/parse.h"

#include <fmt/format.h>

#include <algorithm>

namespace hausbench::readers {
namespace {

std::string_view unquoted(std::string_view text) {
    const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    return quoted ? trimmed(text.substr(1, text.size() - 2)) : text;
}

void split(std::string_view line, std::vector<std::string_view>& fields) {
    fields.clear();
    const char separator = line.find(';') == std::string_view::npos ? ',' : ';';
    if (line.find(separator) == std::string_view::npos) {
        for (auto word = next_word(line); !word.empty(); word = next_word(line)) fields.push_back(unquoted(word));
        return;
    }
    while (!line.empty()) {
        const std::string_view field = line.substr(0, line.find(separator));
        fields.push_back(unquoted(trimmed(field)));
        line.remove_prefix(std::min(field.size() + 1, line.size()));
    }
}

// Returns whether a line may be a header: no field is empty or begins like a number. Any other line must be a point,
// and is an error if it cannot be read as one.
bool names(const std::vector<std::string_view>& fields) {
    return std::none_of(fields.begin(), fields.end(), [](std::string_view field) {
        return field.empty() || std::string_view("0123456789+-.").find(field.front()) != std::string_view::npos;
    });
}

}  // namespace

PointLines::PointLines(std::string name, std::array<std::size_t, 3> columns, std::uint64_t announced)
    : name_(std::move(name)), columns_(columns), announced_(announced), counted_(true), begun_(true) {}

void PointLines::add_lines(std::string_view bytes, std::uint32_t first) {
    while (!bytes.empty()) add(next_line(bytes), first++);
}

void PointLines::add(std::string_view line, std::uint32_t number) {
    const bool slashes = trimmed(line).starts_with("//");
    if (slashes) line = trimmed(line).substr(2);
    line = trimmed(line.substr(0, line.find('#')));
    split(line, fields_);
    if (fields_.empty()) return;
    if (slashes) {  // a comment, or the header that CloudCompare writes
        if (!begun_) begun_ = take_header(number);
        return;
    }
    const auto count = whole<std::uint64_t>(line);
    if (fields_.size() == 1 && count && counts_ && soup_.points.size() == announced_) {
        announced_ += std::min(*count, std::uint64_t{1} << 40);
        counted_ = begun_ = true;
        count_line_ = number;
        return;
    }
    if (!begun_ && !decimal(fields_.front()) && (take_header(number) || (any_header_ && names(fields_)))) {
        begun_ = true;
        if (any_header_) named_ = fields_.size();
        return;
    }
    begun_ = true;
    if (fields_.size() > named_)
        refuse(name_, number,
               fmt::format("{} columns, and the header names {}: write decimals with a point, and no separator "
                           "within a field",
                           fields_.size(), named_));
    add_point(number);
}

bool PointLines::take_header(std::uint32_t number) {
    std::array<std::size_t, 3> columns{};
    int found = 0;
    for (std::size_t i = fields_.size(); i-- > 0;)  // backwards, so that the first of two columns named "x" counts
        for (std::size_t k = 0; k < 3; ++k)
            if (lower_case(fields_[i]) == std::string(1, "xyz"[k])) {
                columns[k] = i;
                found |= 1 << k;
            }
    if (found == 0) return false;
    if (found != 7)
        refuse(name_, number, "the header names only some of x, y and z: name all three columns, or none of them");
    columns_ = columns;
    return true;
}

void PointLines::add_point(std::uint32_t number) {
    Vec3 point;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t column = columns_[k];
        const auto where = [&] { return fmt::format("column {} ({})", column + 1, "xyz"[k]); };
        if (column >= fields_.size())
            refuse(name_, number,
                   fields_.size() < 3 ? fmt::format("{} column{}, and a point needs x, y and z", fields_.size(),
                                                    fields_.size() == 1 ? "" : "s")
                                      : where() + " is missing");
        const std::string_view field = fields_[column];
        const auto value = decimal(field);
        if (!value) {
            const bool comma = field.find(',') != std::string_view::npos;
            refuse(name_, number,
                   field.empty() ? where() + " is empty"
                   : comma ? fmt::format("{} is '{}': write decimals with a point, not a comma", where(), shown(field))
                           : fmt::format("{} is '{}', which is not a number: a point begins with x, y and z", where(),
                                         shown(field)));
        }
        point[static_cast<Eigen::Index>(k)] = *value;
    }
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

Soup read_lines(const std::string& name, std::string_view bytes, bool csv) {
    if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
    if (bytes.substr(0, 4096).find('\0') != std::string_view::npos)
        throw InputError(name + ": is binary or UTF-16, not lines of decimal numbers: write it as UTF-8 text");
    PointLines points(name, csv);
    points.add_lines(bytes, 1);
    return points.finish();
}

}  // namespace

Soup read_xyz(const Input& input) { return read_lines(input.name, input.bytes, false); }
Soup read_csv(const Input& input) { return read_lines(input.name, input.bytes, true); }

}  // namespace hausbench::readers
