// Limits on wall time, and requests to stop early.
#pragma once

#include "algorithms/kernel/watched.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

namespace hausbench {

// Lets the caller of a query end it early. The thread that constructs the interrupt calls the hook, at most once every
// two milliseconds, when it asks stop_requested(); all other threads only read whether the hook has asked to stop.
class Interrupt {
public:
    // Returns 0 to go on. Called with rounding to nearest, whatever the rounding mode of the solver.
    using Hook = int (*)(void* data);

    // Without a hook (null), it never asks to stop.
    Interrupt(Hook hook, void* data) : hook_(hook), data_(data) {}

    bool stop_requested() const {
        if (requested_.load(std::memory_order_relaxed)) return true;
        return WATCHED_ELSE("interrupt: other threads do not call the hook", std::this_thread::get_id() == home_,
                            true) &&
               ask_hook();
    }

    // Returns whether the hook has asked to stop, without calling it.
    bool stopped() const { return requested_.load(std::memory_order_relaxed); }

private:
    bool ask_hook() const;

    Hook hook_;
    void* data_;
    std::thread::id home_ = std::this_thread::get_id();
    mutable std::atomic<bool> requested_{false};
    mutable std::chrono::steady_clock::time_point last_{};  // when the hook was called; of the home thread alone
};

// A deadline that passes a given number of seconds after construction, or when the interrupt asks to stop. With infinity
// and no interrupt, it never passes, and the clock is not read.
class Deadline {
public:
    explicit Deadline(double seconds, const Interrupt* interrupt = nullptr)
        : seconds_(seconds),
          interrupt_(interrupt),
          limited_(std::isfinite(seconds)),
          watched_(limited_ || interrupt != nullptr) {
        if (limited_) begin_ = std::chrono::steady_clock::now();
    }

    bool passed() const { return watched_ && is_over(); }

private:
    bool is_over() const {
        if (WATCHED("deadline: an interrupt", interrupt_ && interrupt_->stop_requested())) return true;
        return limited_ && std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() >= seconds_;
    }

    double seconds_;
    const Interrupt* interrupt_;
    bool limited_, watched_;
    std::chrono::steady_clock::time_point begin_{};
};

}  // namespace hausbench
