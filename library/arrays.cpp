#include "library/arrays.h"

#include "library/errors.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <limits>

namespace hausbench::library {
namespace {

// The bytes of one number, which may have any alignment.
template <class Number> Number number_at(const unsigned char* at) {
    Number value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

void expect_table(const hausbench_array& array, const char* name, int argument) {
    const auto fail = [&](const std::string& what) {
        throw ArgumentError(argument, fmt::format("{}: {}", name, what));
    };
    constexpr std::int64_t most = std::numeric_limits<Index>::max();
    if (array.rows <= 0) fail(fmt::format("has {} rows: give at least one", array.rows));
    if (array.rows > most) fail(fmt::format("has {} rows, more than {}", array.rows, most));
    if (!array.data) fail("its data is NULL: give a pointer to the numbers");
    if (array.reserved != 0) fail("its member `reserved` must be 0");
    // The last number must be at an offset that can be computed.
    std::int64_t down = 0, across = 0, sum = 0;
    if (__builtin_mul_overflow(array.rows - 1, array.row_stride, &down) ||
        __builtin_mul_overflow(std::int64_t{2}, array.column_stride, &across) ||
        __builtin_add_overflow(down, across, &sum))
        fail("its strides are too large: give bytes from row to row and from number to number");
}

// Calls put(row, column, value) for each number of the table.
template <class Number, class Put> void read_table(const hausbench_array& array, const Put& put) {
    const auto* bytes = static_cast<const unsigned char*>(array.data);
    for (std::int64_t i = 0; i < array.rows; ++i) {
        for (std::int64_t k = 0; k < 3; ++k)
            put(static_cast<Index>(i), static_cast<int>(k),
                number_at<Number>(bytes + (i * array.row_stride + k * array.column_stride)));
    }
}

}  // namespace

Points points_in(const hausbench_array& array, int argument) {
    expect_table(array, "vertices", argument);
    if (array.type != HAUSBENCH_FLOAT64 && array.type != HAUSBENCH_FLOAT32)
        throw ArgumentError(argument, fmt::format("vertices: type {} is neither FLOAT64 nor FLOAT32", array.type));
    Points points(array.rows, 3);
    const auto put = [&](Index i, int k, double value) { points(i, k) = value; };
    if (array.type == HAUSBENCH_FLOAT64)
        read_table<double>(array, put);
    else
        read_table<float>(array, put);
    if (points.allFinite()) return points;
    for (Index i = 0; i < points.rows(); ++i) {
        if (!points.row(i).allFinite())
            throw ArgumentError(
                argument,
                fmt::format("vertices: row {} has a coordinate that is not finite ({}, {}, {}): remove or "
                            "correct the row",
                            i, points(i, 0), points(i, 1), points(i, 2)),
                i);
    }
    return points;
}

Triangles triangles_in(const hausbench_array& array, Index vertices, int argument) {
    expect_table(array, "faces", argument);
    if (array.type != HAUSBENCH_INT64 && array.type != HAUSBENCH_INT32)
        throw ArgumentError(argument, fmt::format("faces: type {} is neither INT64 nor INT32", array.type));
    Triangles triangles(array.rows, 3);
    const auto put = [&](Index i, int k, std::int64_t value) {
        if (value < 0 || value >= vertices)
            throw ArgumentError(argument,
                                fmt::format("faces: row {} names vertex {}, but the vertices are numbered from 0 to {}",
                                            i, value, vertices - 1),
                                i);
        triangles(i, k) = static_cast<Index>(value);
    };
    if (array.type == HAUSBENCH_INT64)
        read_table<std::int64_t>(array, put);
    else
        read_table<std::int32_t>(array, put);
    return triangles;
}

}  // namespace hausbench::library
