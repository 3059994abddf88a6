// Point clouds as lines of decimal numbers: .xyz, .pts, .csv, and the points of a text PCD file (pcd_file.cpp).
//
// A line holds x, y and z and then whatever else (intensity, colours, normals), which is ignored. Its separator is ';' where it has one,
// else ',' where it has one, else white space. '#' begins a comment, and so does "//" at the begin of a line. A line of one whole number
// announces so many points (.pts, some .xyz). The first line may be a header: columns named x, y and z in any order and any case; in a
// .csv file a header without these names is passed over. In a .csv file no line has more columns than the header: decimal commas, or a
// separator within quotes, would move the numbers.
#include "error.h"
#include "point_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace hausbench::readers {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(blanks);
    return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view unquoted(std::string_view text) {
    const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    return quoted ? trimmed(text.substr(1, text.size() - 2)) : text;
}

void split(std::string_view line, std::vector<std::string_view>& fields) {
    fields.clear();
    const char mark = line.find(';') != std::string_view::npos   ? ';'
                      : line.find(',') != std::string_view::npos ? ','
                                                                 : 0;
    for (std::size_t at = 0; at < line.size();) {
        if (mark) {
            const std::size_t end = std::min(line.find(mark, at), line.size());
            fields.push_back(unquoted(trimmed(line.substr(at, end - at))));
            at = end + 1;
        } else {
            at = std::min(line.find_first_not_of(blanks, at), line.size());
            const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
            if (end > at) fields.push_back(unquoted(line.substr(at, end - at)));
            at = end;
        }
    }
}

std::string lower_case(std::string_view text) {
    std::string out(text);
    for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    return out;
}

// Names begin like no number: a line that does is a point, and wrong if it cannot be read.
bool names(const std::vector<std::string_view>& fields) {
    return std::none_of(fields.begin(), fields.end(), [](std::string_view field) {
        return field.empty() || std::string_view("0123456789+-.").find(field.front()) != std::string_view::npos;
    });
}

// The numbers of the columns x, y and z; how many of the names are there is in `found`.
std::array<std::size_t, 3> named_columns(const std::vector<std::string_view>& names, int& found) {
    std::array<std::size_t, 3> columns{};
    found = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto at = std::find_if(names.begin(), names.end(), [&](std::string_view name) {
            return lower_case(name) == std::string(1, "xyz"[k]);
        });
        if (at == names.end()) continue;
        columns[k] = static_cast<std::size_t>(at - names.begin());
        ++found;
    }
    return columns;
}

}  // namespace

std::optional<double> decimal(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (end != text.data() + text.size() || text.empty()) return std::nullopt;
    // Too large for a double, or so small that it rounds to a subnormal or to zero, which from_chars does not do; strtod rounds right too.
    if (error == std::errc::result_out_of_range) value = std::strtod(std::string(text).c_str(), nullptr);
    return value;
}

PointLines::PointLines(std::string name, std::array<std::size_t, 3> columns, std::uint64_t announced)
    : name_(std::move(name)), columns_(columns), announced_(announced), counted_(true), begun_(true) {}

void PointLines::refuse(std::uint32_t number, const std::string& why) const {
    throw InputError(fmt::format("{}: line {}: {}", name_, number, why));
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
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), count);
    const bool whole = end == line.data() + line.size() && error == std::errc();
    if (fields_.size() == 1 && whole && counts_ && soup_.points.size() == announced_) {
        announced_ += std::min(count, std::uint64_t{1} << 40);
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
        refuse(number, fmt::format("{} columns, and the header names {}: write decimals with a point, and no separator "
                                   "within a field",
                                   fields_.size(), named_));
    add_point(number);
}

bool PointLines::take_header(std::uint32_t number) {
    int found = 0;
    const auto columns = named_columns(fields_, found);
    if (found == 1 || found == 2)
        refuse(number, "the header names only some of x, y and z: name all three columns, or none of them");
    if (found == 3) columns_ = columns;
    return found == 3;
}

void PointLines::add_point(std::uint32_t number) {
    Vec3 point;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t column = columns_[k];
        const auto where = [&] { return fmt::format("column {} ({})", column + 1, "xyz"[k]); };
        if (column >= fields_.size())
            refuse(number, fields_.size() < 3 ? fmt::format("{} column{}, and a point needs x, y and z", fields_.size(),
                                                            fields_.size() == 1 ? "" : "s")
                                              : where() + " is missing");
        const std::string_view field = fields_[column];
        const auto value = decimal(field);
        if (!value) {
            const bool comma = field.find(',') != std::string_view::npos;
            refuse(number, field.empty() ? where() + " is empty"
                           : comma       ? fmt::format("{} is '{}': write decimals with a point, not a comma", where(),
                                                       one_line(std::string(field.substr(0, 40))))
                                         : fmt::format("{} is '{}', which is no number: a point begins with x, y and z",
                                                       where(), one_line(std::string(field.substr(0, 40)))));
        }
        point[static_cast<Eigen::Index>(k)] = *value;
    }
    if (counted_ && soup_.points.size() >= announced_)
        refuse(number, fmt::format("another point, though {} announces {}", announcer(), announced_));
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

void each_text_line(std::string_view bytes, std::uint32_t first,
                    const std::function<void(std::string_view, std::uint32_t)>& take) {
    std::size_t feed = std::min(bytes.find('\n'), bytes.size());
    for (std::size_t at = 0; at < bytes.size(); ++first) {
        if (feed < at) feed = std::min(bytes.find('\n', at), bytes.size());
        const std::size_t end =
            at + std::min(bytes.substr(at, feed - at).find('\r'), feed - at);  // old Macs wrote only \r
        take(bytes.substr(at, end - at), first);
        at = end + (bytes.substr(end, 2) == "\r\n" ? 2 : 1);
    }
}

Soup read_point_lines(const std::string& name, std::string_view bytes, const std::string& format) {
    if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
    if (bytes.substr(0, 4096).find('\0') != std::string_view::npos)
        throw InputError(name + ": is binary or UTF-16, not lines of decimal numbers: write it as UTF-8 text");
    PointLines points(name, format == "csv");
    each_text_line(bytes, 1, [&](std::string_view line, std::uint32_t number) { points.add(line, number); });
    return points.finish();
}

}  // namespace hausbench::readers
