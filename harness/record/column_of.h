// Defines columns (columns.h) from members of rows, for column_tables.cpp.
#pragma once

#include "harness/record/columns.h"
#include "harness/record/json.h"

#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <type_traits>
#include <utility>

// COLUMN defines the column for a member of `Entry`, the struct of a row, and names it after the member. NAMED gives
// the column another name.
#define COLUMN(member, ...) NAMED(#member, member, __VA_ARGS__)
#define NAMED(name, where, ...) column<Entry, MEMBER(where)>(name, __VA_ARGS__)
#define MEMBER(where) \
    [](auto& row) -> auto& { return row.where; }

namespace hausbench::columns {

using nlohmann::json;

// Whether values of type T are stored as JSON text.
template <class T>
inline constexpr bool is_json_text =
    std::is_same_v<T, ParameterMap> || std::is_same_v<T, std::map<std::string, double>> || std::is_same_v<T, Facts>;

template <class T> std::string json_text(const T& value) {
    if constexpr (std::is_same_v<T, std::map<std::string, double>>)
        return extras_json(value).dump();
    else
        return json(value).dump();
}

template <class T> T parsed_json_text(const std::string& text) {
    if constexpr (std::is_same_v<T, std::map<std::string, double>>)
        return extras_of(json::parse(text));
    else
        return json::parse(text).get<T>();
}

// Parses JSON text. Caches the last value, because files repeat the same text in row after row.
template <class T> const T& from_json_text(const std::string& text) {
    thread_local std::string cached_text = "{}";
    thread_local T value;
    if (text == cached_text) return value;
    value = parsed_json_text<T>(text);
    cached_text = text;
    return value;
}

// Returns the number of doubles in a value of type T, or 0 if T is not stored as doubles.
template <class T> constexpr std::size_t width_of() {
    if constexpr (std::is_same_v<T, double>) return 1;
    if constexpr (std::is_same_v<T, Vec3>) return 3;
    if constexpr (std::is_same_v<T, Pose>) return 12;
    if constexpr (std::is_same_v<T, std::array<double, 6>>) return 6;
    return 0;
}

// Calls take() for each double of a value, in the order of the file. A pose is its rotation row by row, then its
// translation.
template <class T, class F> void each_double(T& value, F take) {
    using Plain = std::remove_const_t<T>;
    if constexpr (std::is_same_v<Plain, double>) {
        take(value);
    } else if constexpr (std::is_same_v<Plain, Pose>) {
        for (int i = 0; i < 9; ++i) take(value.rotation(i / 3, i % 3));
        for (int i = 0; i < 3; ++i) take(value.translation[i]);
    } else {
        for (auto& v : value) take(v);
    }
}

template <class E> E named(const std::string& text) {
    for (int i = 0; i < count_of<E>; ++i) {
        if (text == to_string(E(i))) return E(i);
    }
    throw std::runtime_error(fmt::format("'{}' is not one of its values", text));
}

// Defines a column for one member of a row. `member` is a lambda that returns a reference to this member.
template <class Row, auto member>
Column<Row> column(std::string_view name, std::string_view meaning, Identity identity = Identity::no) {
    using T = std::remove_cvref_t<decltype(member(std::declval<Row&>()))>;
    if constexpr (std::is_same_v<T, std::string>) {
        return {name, meaning,
                typename Column<Row>::Text{[](const Row& row) { return member(row); },
                                           [](Row& row, const std::string& text) { member(row) = text; }},
                identity};
    } else if constexpr (is_json_text<T>) {
        return {name, meaning,
                typename Column<Row>::Text{
                    [](const Row& row) { return json_text<T>(member(row)); },
                    [](Row& row, const std::string& text) { member(row) = from_json_text<T>(text); }},
                identity};
    } else if constexpr (std::is_enum_v<T>) {
        return {name, meaning,
                typename Column<Row>::Text{[](const Row& row) { return std::string(to_string(member(row))); },
                                           [](Row& row, const std::string& text) { member(row) = named<T>(text); }},
                identity};
    } else if constexpr (width_of<T>() > 0) {
        return {name, meaning,
                typename Column<Row>::Real{
                    width_of<T>(),
                    [](const Row& row, double* out) { each_double(member(row), [&](const double& v) { *out++ = v; }); },
                    [](Row& row, const double* in) { each_double(member(row), [&](double& v) { v = *in++; }); }},
                identity};
    } else {
        static_assert(std::is_integral_v<T>);
        return {name, meaning,
                typename Column<Row>::Integer{[](const Row& row) { return std::int64_t(member(row)); },
                                              [](Row& row, std::int64_t value) {
                                                  if (std::int64_t(T(value)) != value)
                                                      throw std::runtime_error(fmt::format("holds {}", value));
                                                  member(row) = T(value);
                                              }},
                identity};
    }
}

}  // namespace hausbench::columns
