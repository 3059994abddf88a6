// What the three files of Session share: session.cpp (prepares, answers), session_scale.cpp (scales, and widens for what that loses) and
// session_both.cpp (H from two directions).
#pragma once

#include "algorithms/session/session.h"

#include <algorithm>
#include <chrono>
#include <optional>

namespace hausbench {

struct Session::Part {
    Scene scene;
    Needs needs;
    std::optional<Prepared> prepared;
    std::unique_ptr<Solver> solver;
    double solver_seconds = 0;
};

// Wall time since it was made.
struct Session::Clock {
    std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();

    double elapsed() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); }
    double left(double limit) const { return std::max(0.0, limit - elapsed()); }
};

// How H(A,B) begins.
struct Session::Opening {
    bool backward = false;          // h(B,A) comes first
    std::optional<Result> forward;  // h(A,B), where it has its answer already
    double begin = 0;               // of that answer, in seconds
    Counters spent;                 // on what is not in an answer
};

// The motion g of a target, undone: what is measured is the source in another pose against the target as it is.
struct Session::Undone {
    Pose source, back;   // that pose; and g, which takes what was found to where it belongs
    double stretch = 0;  // no distance changes by more than this part of it under g
    double wider = 0;    // nor by more than this length for all else
    double slack = 0;    // both, for any distance that can be
};

struct Session::Chain final : State {
    std::unique_ptr<State> states[2];  // forward, backward; made by the first answer
    const State* opposite = nullptr;   // of the direction that was answered at this pose, for the other
};

// Calls down(lower) and up(upper) for all bounds of an answer: its own, those of its trace and those of its fields.
template <class Down, class Up> void for_each_bound(Result& result, Trace& trace, const Down& down, const Up& up) {
    down(result.bounds.lower);
    up(result.bounds.upper);
    for (TraceSample& sample : trace.samples()) down(sample.lower), up(sample.upper);
    for (std::size_t i = 0; result.fields && i < result.fields->size(); ++i) {
        Field& field = (*result.fields)[i];
        for (double& value : field.values) {
            if (field.meaning == Field::Meaning::lower) down(value);
            if (field.meaning == Field::Meaning::upper) up(value);
        }
    }
}

inline bool claims_an_answer(Status status) {
    return status == Status::converged || status == Status::below_floor || status == Status::above_cutoff;
}

}  // namespace hausbench
