// Records how the bounds of a solver change while it runs, or shows them to a watcher. A Trace does neither by default, so
// that timed runs do not pay for it.
#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace hausbench {

struct Bounds;
struct Result;

struct TraceSample {
    double seconds;  // wall time since start()
    double lower, upper;
};

// The recorded bounds of one run. record() skips samples that hardly differ from the last one, to save memory.
class Trace {
public:
    enum class Mode { off, on };

    // `marks` are tolerances, as lengths, in decreasing order. The first sample whose gap is at most a mark is always
    // kept, so the trace contains the answer to each of these tolerances, bit for bit.
    explicit Trace(Mode mode = Mode::off, std::vector<double> marks = {})
        : on_(mode == Mode::on), marks_(std::move(marks)) {}

    // Receives, at most every tenth of a second, the answer that a solver could give if it stopped now: its bounds and
    // statistics, with the status `time_limit` and no witness. Called by the thread that solves. It may change the answer,
    // and must not throw. `wait`: until the first time.
    using Watcher = std::function<void(Result&)>;
    static constexpr std::chrono::milliseconds pause{100};
    void watch(Watcher watcher, std::chrono::milliseconds wait = {}) {
        watcher_ = std::move(watcher);
        next_ = std::chrono::steady_clock::now() + wait;
        skip_ = 0;
    }
    bool watched() const { return static_cast<bool>(watcher_); }

    // Returns whether the watcher is to be shown the bounds now. If it is asked often, it looks at the clock every 64th
    // time only. Once true, it stays true until they are shown.
    bool due() { return skip_-- <= 0 && look(); }

    // Returns whether record() would do something: a sample is wanted, or the watcher is to be shown the bounds.
    bool wants() { return skip_-- <= 0 && (on_ || look()); }

    // Shows the watcher, if there is one, bounds or statistics that hold, whether that is due or not.
    void show(double lower, double upper);
    void show(const std::vector<Bounds>& statistics);
    void show(Result& so_far);

    // While it lives, `change` turns what is shown into an answer to the query of the caller. For adapters, which wrap
    // solvers and change their queries.
    class Changing {
    public:
        Changing(Trace& trace, Watcher change);
        ~Changing() { trace_.watcher_ = std::move(outer_); }
        Changing(const Changing&) = delete;
        Changing& operator=(const Changing&) = delete;

    private:
        Trace& trace_;
        Watcher outer_, change_;
    };

    bool on() const { return on_; }

    // Starts a run and removes all samples. If the solver works on shapes that are scaled by 2^exponent, pass the
    // exponent: the marks are then scaled in the same way.
    void start(int exponent = 0) {
        samples_.clear();
        next_mark_ = 0;
        scaled_marks_ = marks_;
        for (double& mark : scaled_marks_) mark = std::ldexp(mark, exponent);
        begin_ = std::chrono::steady_clock::now();
    }

    // Offers the current bounds as a sample, and shows them if that is due. Call it wherever the solver tests whether the gap is small enough. A
    // sample is kept if its gap is at least 3 % smaller than the gap of the last kept sample, or if it is the first at
    // or below a mark. So while the gap shrinks from 1 to 1e-16, at most about 1200 samples are kept (0.97^1200 is
    // about 1e-16), plus one for each mark.
    void record(double lower, double upper) {
        if (due()) show(lower, upper);
        if (!on_) return;
        const double gap = upper - lower;
        // Until an upper bound is known, keep samples whose lower bound is more than 3 % larger than the last one.
        if (std::isinf(gap)) {
            if (samples_.empty() || lower > 1.03 * samples_.back().lower) keep(lower, upper);
            return;
        }
        bool marked = false;
        for (; next_mark_ < scaled_marks_.size() && gap <= scaled_marks_[next_mark_]; ++next_mark_) marked = true;
        if (!marked && !samples_.empty() && !(gap <= 0.97 * (samples_.back().upper - samples_.back().lower))) return;
        keep(lower, upper);
    }

    // Ends a run and keeps its final bounds as the last sample.
    void finish(double lower, double upper) {
        if (on_) keep(lower, upper);
    }

    const std::vector<TraceSample>& samples() const { return samples_; }
    std::vector<TraceSample>& samples() { return samples_; }

private:
    bool look();

    void keep(double lower, double upper) {
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
        samples_.push_back({elapsed.count(), lower, upper});
    }

    bool on_;
    std::vector<double> marks_, scaled_marks_;
    std::size_t next_mark_ = 0;
    std::chrono::steady_clock::time_point begin_{};
    std::vector<TraceSample> samples_;
    Watcher watcher_;
    std::chrono::steady_clock::time_point next_{}, looked_{};  // when the watcher is shown the bounds again; last look
    int skip_ = 0, stride_ = 0;  // how many calls of due() do not look, from now and after the next look
};

}  // namespace hausbench
