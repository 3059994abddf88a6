// Why a question has no answer.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace hausbench {

struct NoAnswer {
    enum class Why {
        refused,        // the input is wrong: the solver was not asked
        out_of_memory,  // more than its limit, or more than the system gives
        failed,         // the solver threw, or its process ended or wrote something else
        timeout,        // its process was killed at a time limit
        signal,         // a signal ended its process
    };
    Why why = Why::failed;
    std::string reason;  // one line
};

// Runs `work`, which asks a solver. Returns what it threw; nothing if it threw nothing.
std::optional<NoAnswer> attempt(const std::function<void()>& work);

}  // namespace hausbench
