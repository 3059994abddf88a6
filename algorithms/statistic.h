// Statistics of the distance between two shapes.
//
// Let d be the distance of a point of A to B. F(t) is the share of A (of its area, or of its points) at which d <= t.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hausbench {

struct Statistic {
    enum class Kind {
        mean,          // of d
        rms,           // root of the mean of d^2
        deviation,     // standard deviation: root of the mean of (d - mean)^2
        maximum,       // of d
        quantile,      // the least t with F(t) >= argument; 0 < argument <= 1. Shares of points are rounded to doubles
        share_within,  // F(argument), a number from 0 to 1; the argument is a length
    };
    // The points whose distances count. docs/conventions.md says which tool means what.
    enum class Over {
        source,         // the points of A, with their distances to B
        target,         // the points of B, with their distances to A
        larger,         // the larger of the two values
        mean_of_both,   // the arithmetic mean of the two values
        harmonic_mean,  // the harmonic mean of the two values
        pooled,         // the points of both shapes together, each with its distance to the other shape
    };
    Kind kind = Kind::mean;
    double argument = 0;
    Over over = Over::source;

    bool operator==(const Statistic&) const = default;
};

// What is known of a kind of statistic. Names in files and messages, help, JSON and units follow from it; the rest of a
// statistic is computed in meshes/distribution/statistics.cpp, and again in harness/check/verify_statistics.cpp.
struct StatisticKind {
    enum class Argument { none, level, length };  // level: above 0 and at most 1
    Statistic::Kind kind;
    std::string_view name;     // how it begins as text
    std::string_view example;  // as text, with an argument
    Argument argument;
    bool is_share;           // has values from 0 to 1, without a unit; all others are lengths
    std::string_view group;  // the key of `measure --json` for the values by argument; empty without argument
};
inline constexpr StatisticKind statistic_kinds[] = {
    {Statistic::Kind::mean, "mean", "mean", StatisticKind::Argument::none, false, ""},
    {Statistic::Kind::rms, "rms", "rms", StatisticKind::Argument::none, false, ""},
    {Statistic::Kind::deviation, "deviation", "deviation", StatisticKind::Argument::none, false, ""},
    {Statistic::Kind::maximum, "maximum", "maximum", StatisticKind::Argument::none, false, ""},
    {Statistic::Kind::quantile, "quantile", "quantile 0.95", StatisticKind::Argument::level, false, "quantiles"},
    {Statistic::Kind::share_within, "within", "within 0.1", StatisticKind::Argument::length, true, "share_within"},
};
const StatisticKind& kind_of(const Statistic& statistic);

// How much each point of a shape counts.
enum class WeighBy {
    area,    // each part of a mesh by its area, of line segments alone by its length; each point of a point set once
    number,  // each vertex of a mesh that belongs to a triangle once, the rest of the mesh not at all; each point once
};

inline constexpr Statistic::Over all_overs[] = {Statistic::Over::source,        Statistic::Over::target,
                                                Statistic::Over::larger,        Statistic::Over::mean_of_both,
                                                Statistic::Over::harmonic_mean, Statistic::Over::pooled};
std::string_view to_string(Statistic::Over over);
std::string_view to_string(WeighBy weigh);

// Returns whether the statistic is a share, which has no unit. All others are lengths.
inline bool is_share(const Statistic& statistic) { return kind_of(statistic).is_share; }

// Returns whether its argument is a length, in the unit of the shapes.
inline bool takes_length(const Statistic& statistic) {
    return kind_of(statistic).argument == StatisticKind::Argument::length;
}

// Returns whether the statistic needs the distances from A to B, or from B to A.
inline bool needs_source(const Statistic& statistic) { return statistic.over != Statistic::Over::target; }
inline bool needs_target(const Statistic& statistic) { return statistic.over != Statistic::Over::source; }

// The name as it is written and shown, such as "mean" or "quantile 0.95"; "median" is "quantile 0.5". "pooled" and so on
// may follow.
std::string to_string(const Statistic& statistic);

// Returns how every kind is written, with an example of an argument, and "median".
std::vector<std::string> statistic_examples();

// Reads such a name. Throws InputError, which quotes the text and says what is allowed.
Statistic statistic_of(std::string_view text);

}  // namespace hausbench
