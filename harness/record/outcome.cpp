#include "harness/record/outcome.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace hausbench {

RowStatus row_status(Status status) {
    switch (status) {
        case Status::converged:
        case Status::below_floor:
        case Status::above_cutoff:
            return RowStatus::ok;
        case Status::time_limit:
            return RowStatus::timeout;
        case Status::budget:
            return RowStatus::budget;
        case Status::precision_floor:
            return RowStatus::floor;
        case Status::stalled:
            return RowStatus::failed;
    }
    throw std::logic_error("row_status: not a status");
}

RowStatus row_status(NoAnswer::Why why) {
    switch (why) {
        case NoAnswer::Why::refused:
        case NoAnswer::Why::failed:
            return RowStatus::failed;
        case NoAnswer::Why::out_of_memory:
            return RowStatus::out_of_memory;
        case NoAnswer::Why::timeout:
            return RowStatus::timeout;
        case NoAnswer::Why::signal:
            return RowStatus::signal;
    }
    throw std::logic_error("row_status: not a reason");
}

bool is_timed(RowStatus status) {
    return status == RowStatus::ok || status == RowStatus::floor || status == RowStatus::budget;
}

std::string_view to_string(RowStatus status) {
    constexpr std::string_view names[] = {"ok",     "timeout", "out_of_memory", "signal", "skipped",
                                          "failed", "unsound", "not_built",     "floor",  "budget"};
    static_assert(std::size(names) == count_of<RowStatus>);
    return names[std::size_t(status)];
}

std::string to_string(const std::map<RowStatus, std::size_t>& counts) {
    std::string text;
    for (const auto& [status, count] : counts)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, to_string(status));
    return text;
}

std::string_view to_string(Verdict verdict) {
    constexpr std::string_view names[] = {"holds", "unsound", "no witness", "not checked"};
    return names[std::size_t(verdict)];
}

bool same_answer(const Outcome& a, const Outcome& b) {
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    return a.status == b.status && same(a.bounds.lower, b.bounds.lower) && same(a.bounds.upper, b.bounds.upper);
}

}  // namespace hausbench
