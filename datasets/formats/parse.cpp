#include "datasets/formats/parse.h"

#include "algorithms/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace hausbench::readers {

void refuse(const std::string& name, std::uint32_t line, const std::string& why) {
    throw InputError(fmt::format("{}: line {}: {}", name, line, why));
}

std::string shown(std::string_view word) { return one_line(std::string(word.substr(0, 40))); }

std::string lower_case(std::string_view text) {
    std::string lower(text);
    for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    return lower;
}

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(blanks);
    return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view next_word(std::string_view& line) {
    line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(blanks));
    line.remove_prefix(word.size());
    return word;
}

std::string_view next_line(std::string_view& bytes) {
    const auto end = std::find_if(bytes.begin(), bytes.end(), [](char c) { return c == '\n' || c == '\r'; });
    const std::string_view line(bytes.begin(), end);
    bytes.remove_prefix(line.size());
    bytes.remove_prefix(bytes.starts_with("\r\n") ? 2 : bytes.empty() ? 0 : 1);
    return line;
}

template <class Real> std::optional<Real> decimal(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    Real value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (end != text.data() + text.size() || text.empty()) return std::nullopt;
    // from_chars leaves the value unset if a number is too large, or so small that it rounds to a subnormal number or
    // to zero. strtod rounds these correctly.
    if (error == std::errc::result_out_of_range) {
        const std::string copy(text);
        if constexpr (sizeof(Real) == sizeof(float))
            value = std::strtof(copy.c_str(), nullptr);
        else
            value = std::strtod(copy.c_str(), nullptr);
    }
    return value;
}
template std::optional<float> decimal(std::string_view);
template std::optional<double> decimal(std::string_view);

namespace {

template <class T> double value_at(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
}

}  // namespace

bool Stored::readable() const {
    const bool whole = kind == 'I' || kind == 'U';
    return (whole && (size == 1 || size == 2)) || ((whole || kind == 'F') && (size == 4 || size == 8));
}

bool Stored::holds(double value) const {
    if (kind == 'F') return true;
    const int bits = static_cast<int>(8 * size);
    const double least = kind == 'I' ? -std::ldexp(1.0, bits - 1) : 0;
    return std::floor(value) == value && value >= least && value < std::ldexp(1.0, kind == 'I' ? bits - 1 : bits);
}

double Stored::value(const char* at) const {
    if (kind == 'F') return size == 4 ? value_at<float>(at) : value_at<double>(at);
    const bool sign = kind == 'I';
    if (size == 1) return sign ? value_at<std::int8_t>(at) : value_at<std::uint8_t>(at);
    if (size == 2) return sign ? value_at<std::int16_t>(at) : value_at<std::uint16_t>(at);
    if (size == 4) return sign ? value_at<std::int32_t>(at) : value_at<std::uint32_t>(at);
    return sign ? value_at<std::int64_t>(at) : value_at<std::uint64_t>(at);
}

}  // namespace hausbench::readers
