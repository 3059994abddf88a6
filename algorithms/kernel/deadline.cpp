#include "algorithms/kernel/deadline.h"

#include "algorithms/kernel/watched.h"

#include <cfenv>

namespace hausbench {

bool Interrupt::ask_hook() const {
    if (!hook_) return false;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(2)) return false;
    last_ = now;
    // CGAL sets the rounding mode of SSE alone, which fegetround() does not read, so the whole environment is kept.
    std::fenv_t environment;
    std::fegetenv(&environment);
    if (WATCHED("interrupt: the hook rounds to nearest", true)) std::fesetround(FE_TONEAREST);
    const bool stop = hook_(data_) != 0;
    if (WATCHED("interrupt: the solver's rounding comes back", true)) std::fesetenv(&environment);
    if (stop) requested_.store(true, std::memory_order_relaxed);
    return stop;
}

}  // namespace hausbench
