// Code shared by the adapters of a session: solvers that wrap other solvers to add features (session.h).
#pragma once

#include "algorithms/kernel/watched.h"
#include "algorithms/solver.h"

#include <algorithm>
#include <chrono>

namespace hausbench {

// Base class of the adapters, solvers that wrap other solvers. The wrapped solvers are prepared elsewhere, so prepare()
// does nothing.
class Adapter : public Solver {
public:
    void prepare(const Scene&, const Prepared&) final {}
};

// Measures wall time, in seconds since its construction.
struct WallClock {
    std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();

    double elapsed() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); }
    double left(double limit) const {
        return WATCHED_ELSE("session: no time left is no negative time", std::max(0.0, limit - elapsed()),
                            limit - elapsed());
    }
};

// Calls down() on every lower bound and up() on every upper bound in a result, its trace and its fields. Both take the
// bound by reference and may change it.
template <class Down, class Up> void for_each_bound(Result& result, Trace& trace, const Down& down, const Up& up) {
    down(result.bounds.lower);
    up(result.bounds.upper);
    if (WATCHED_ELSE("session: samples of a trace", WATCHED("undone motion: the trace", true), false)) {
        for (TraceSample& sample : trace.samples()) {
            down(sample.lower);
            up(sample.upper);
        }
    }
    for (std::size_t i = 0; result.fields && i < result.fields->size(); ++i) {
        Field& field = (*result.fields)[i];
        for (double& value : field.values) {
            if (WATCHED("session: lower fields are scaled back", field.meaning == Field::Meaning::lower)) down(value);
            if (WATCHED_ELSE("session: upper fields are scaled back",
                             WATCHED("undone motion: fields", field.meaning == Field::Meaning::upper), false))
                up(value);
        }
    }
}

inline bool claims_an_answer(Status status) {
    return status == Status::converged || status == Status::below_floor || status == Status::above_cutoff;
}

}  // namespace hausbench
