// Asks in a child process, so that a solver that crashes, hangs or uses up the memory ends only that process.
#pragma once

#include "harness/ask/ask.h"
#include "harness/ask/no_answer.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace hausbench {

// A query, and what follows its answer.
struct Question {
    Query query;
    Directions directions = Directions::unknown;
    // Prepares what the query needs, and returns how to get at it.
    std::function<OpenSession()> prepare;

    // A step after the answer, such as writing a file. Its report, which `take` gets, must not depend on where it runs:
    // in a child, changes of variables are lost.
    struct Step {
        std::string missing;  // if it does not end in time: "its fields were not written"
        std::function<nlohmann::json(const Answer&)> run;
        std::function<void(const nlohmann::json& report)> take;  // may throw if the report makes no sense
    };
    std::vector<Step> steps = {};
};

struct Answered {
    Answer answer;
    std::int64_t peak_bytes = -1;       // memory for preparing and solving; -1: unknown
    std::optional<NoAnswer> no_answer;  // then the other members say nothing
    std::size_t steps = 0;              // how many steps have ended
    std::string why_not_all = {};       // one line: why not all of them
};

struct AskLimits {
    // For preparing, for solving and for each step, in seconds. With its grace (process/listener.h), then the child is
    // killed. If it has sent bounds before, these become the answer, with the reason as its note.
    double seconds = std::numeric_limits<double>::infinity();
    // Called about fifty times a second with what the child does: "preparing", "solving" or "writing and checking
    // files". `so_far`: the bounds that it has sent; null: none.
    std::function<void(const char* doing, const Answer* so_far)> waiting = {};
};

// Asks in this process, for debuggers. Throws what the solver throws.
Answered ask_here(const Question& question);

// Asks in a copy of this process, which must have one thread only. Throws InputError if an interrupt arrives
// (interrupts.h), and if the child throws it before the answer.
Answered ask_in_child(const Question& question, const AskLimits& limits);

}  // namespace hausbench
