#include "algorithms/statistic.h"

#include "algorithms/error.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hausbench {
namespace {

using Argument = StatisticKind::Argument;

// Takes the next word off the text.
std::string_view next_word(std::string_view& text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(word.size());
    return word;
}

std::optional<double> number_of(std::string_view word) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return value;
}

}  // namespace

std::string_view to_string(Statistic::Over over) {
    constexpr std::string_view names[] = {"source", "target", "larger", "mean_of_both", "harmonic_mean", "pooled"};
    return names[static_cast<std::size_t>(over)];
}

std::string_view to_string(WeighBy weigh) { return weigh == WeighBy::area ? "area" : "number"; }

const StatisticKind& kind_of(const Statistic& statistic) {
    for (const StatisticKind& kind : statistic_kinds)
        if (kind.kind == statistic.kind) return kind;
    throw std::logic_error("statistic_kinds lacks a kind");
}

std::vector<std::string> statistic_examples() {
    std::vector<std::string> examples, with_argument;
    for (const StatisticKind& kind : statistic_kinds)
        (kind.argument == Argument::none ? examples : with_argument).emplace_back(kind.example);
    examples.emplace_back("median");
    examples.insert(examples.end(), with_argument.begin(), with_argument.end());
    return examples;
}

std::string to_string(const Statistic& statistic) {
    const StatisticKind& kind = kind_of(statistic);
    std::string text(kind.name);
    if (kind.argument != Argument::none) text += fmt::format(" {}", statistic.argument);
    if (statistic.kind == Statistic::Kind::quantile && statistic.argument == 0.5) text = "median";
    if (statistic.over != Statistic::Over::source) text += fmt::format(" {}", to_string(statistic.over));
    return text;
}

Statistic statistic_of(std::string_view text) {
    const auto fail = [&](const std::string& why) -> InputError {
        return InputError(fmt::format("statistic '{}': {}", text, why));
    };
    std::string_view rest = text;
    const std::string_view name = next_word(rest);
    Statistic statistic;
    const StatisticKind* match = nullptr;
    for (const StatisticKind& kind : statistic_kinds)
        if (kind.name == name) match = &kind;
    if (name == "median") {
        statistic = {Statistic::Kind::quantile, 0.5};
    } else if (!match) {
        throw fail(fmt::format("must be one such as {}", fmt::join(statistic_examples(), ", ")));
    } else {
        statistic.kind = match->kind;
        if (match->argument != Argument::none) {
            const std::string_view word = next_word(rest);
            const std::optional<double> value = number_of(word);
            if (!value) throw fail(fmt::format("'{}' must be followed by a number, not '{}'", name, word));
            statistic.argument = *value;
        }
    }
    if (kind_of(statistic).argument == Argument::level && !(statistic.argument > 0 && statistic.argument <= 1))
        throw fail("the level must be above 0 and at most 1");
    if (takes_length(statistic) && !(statistic.argument >= 0 && std::isfinite(statistic.argument)))
        throw fail("the length must be a number of at least 0");
    if (const std::string_view over = next_word(rest); !over.empty()) {
        bool valid = false;
        for (const Statistic::Over candidate : all_overs) {
            if (to_string(candidate) != over) continue;
            statistic.over = candidate;
            valid = true;
        }
        if (!valid)
            throw fail(fmt::format("'{}' must be source, target, larger, mean_of_both, harmonic_mean or pooled", over));
    }
    if (!next_word(rest).empty()) throw fail("has words left over");
    return statistic;
}

}  // namespace hausbench
