#include "algorithms/trace.h"

#include "algorithms/kernel/watched.h"
#include "algorithms/solver.h"

#include <algorithm>
#include <cfenv>
#include <limits>

namespace hausbench {

// Looks less often while less than a millisecond passes between the looks.
bool Trace::look() {
    skip_ = 0;
    if (!watched()) {
        if (!on_) skip_ = std::numeric_limits<int>::max();
        return false;
    }
    const auto now = std::chrono::steady_clock::now();
    if (now >= next_) return true;
    stride_ = now - looked_ < std::chrono::milliseconds(1) ? std::min(2 * stride_ + 1, 63) : stride_ / 2;
    skip_ = stride_;
    looked_ = now;
    return false;
}

void Trace::show(Result& so_far) {
    if (!watcher_) return;
    // Solvers that compute with intervals round upward meanwhile. CGAL sets the rounding mode of SSE alone, which
    // fegetround() does not read, so the whole environment is kept.
    std::fenv_t environment;
    std::fegetenv(&environment);
    std::fesetround(FE_TONEAREST);
    watcher_(so_far);
    if (WATCHED("trace: the rounding mode of SSE is kept", true)) std::fesetenv(&environment);
    next_ = std::chrono::steady_clock::now() + pause;
}

void Trace::show(double lower, double upper) {
    Result so_far;
    so_far.status = Status::time_limit;
    so_far.bounds = {lower, upper};
    show(so_far);
}

void Trace::show(const std::vector<Bounds>& statistics) {
    Result so_far;
    so_far.status = Status::time_limit;
    so_far.statistics = statistics;
    if (!statistics.empty()) so_far.bounds = statistics.front();
    show(so_far);
}

Trace::Changing::Changing(Trace& trace, Watcher change)
    : trace_(trace), outer_(std::exchange(trace.watcher_, nullptr)), change_(std::move(change)) {
    if (!outer_) return;
    trace.watcher_ = [this](Result& so_far) {
        change_(so_far);
        outer_(so_far);
    };
}

}  // namespace hausbench
