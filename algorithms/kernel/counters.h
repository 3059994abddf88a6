// Counters of the work that a query does. Unlike times, counts are the same on every machine, so results contain both.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace hausbench {

struct Counters {
    std::uint64_t point_distances = 0;           // distances from a point to a point
    std::uint64_t point_triangle_distances = 0;  // distances from a point to a triangle
    std::uint64_t node_visits = 0;               // nodes or cells of a tree whose box was tested
    std::uint64_t closest_point_queries = 0;
    std::uint64_t bound_tests = 0;   // upper bounds computed for triangles or other parts of A
    std::uint64_t subdivisions = 0;  // triangles or other parts of A that were split
    std::uint64_t queue_pushes = 0;
    std::uint64_t box_distances = 0;           // distances from a box to a box, or to a surface inside a box
    std::uint64_t polynomial_evaluations = 0;  // bounds on a polynomial over a box

    bool operator==(const Counters&) const = default;
    Counters& operator+=(const Counters& more);
};

struct CounterField {
    std::string_view name;
    std::uint64_t Counters::*member;
};

// The names of all counters. Files, tables and tests loop over this list, so a new counter needs only a member above
// and an entry here.
inline constexpr std::array<CounterField, 9> counter_fields{{
    {"point_distances", &Counters::point_distances},
    {"point_triangle_distances", &Counters::point_triangle_distances},
    {"node_visits", &Counters::node_visits},
    {"closest_point_queries", &Counters::closest_point_queries},
    {"bound_tests", &Counters::bound_tests},
    {"subdivisions", &Counters::subdivisions},
    {"queue_pushes", &Counters::queue_pushes},
    {"box_distances", &Counters::box_distances},
    {"polynomial_evaluations", &Counters::polynomial_evaluations},
}};

inline Counters& Counters::operator+=(const Counters& more) {
    for (const CounterField& field : counter_fields) this->*field.member += more.*field.member;
    return *this;
}

}  // namespace hausbench
