#include "algorithms/solver.h"

namespace hausbench {

std::string_view to_string(Status status) {
    constexpr std::string_view names[] = {"converged", "below_floor",     "above_cutoff", "time_limit",
                                          "budget",    "precision_floor", "stalled"};
    return names[static_cast<std::size_t>(status)];
}

std::string_view to_string(Quantity quantity) {
    constexpr std::string_view names[] = {"directed", "symmetric", "penetration", "distribution"};
    return names[static_cast<std::size_t>(quantity)];
}

std::string_view to_string(Ability ability) {
    constexpr std::string_view names[] = {"traces",       "moving_target",   "warm",
                                          "shared_pairs", "threads",         "fields",
                                          "certificates", "coarser_answers", "undone_motion"};
    return names[static_cast<std::size_t>(ability)];
}

std::string_view symbol(Quantity quantity) {
    constexpr std::string_view symbols[] = {"h(A,B)", "H(A,B)", "the penetration depth", "statistics of the distance"};
    return symbols[static_cast<std::size_t>(quantity)];
}

std::string_view to_string(Witness::Direction direction) {
    return direction == Witness::Direction::source_to_target ? "source to target" : "target to source";
}

}  // namespace hausbench
