// The bounds over time: a solver reports its bounds to a Trace while it runs. A Trace is off by default, and timed runs
// leave it off, so that they do not pay for it.
#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace hausbench {

struct TraceSample {
    double seconds;  // wall time since start()
    double lower, upper;
};

// The samples of one run. Keeps only samples that differ enough from the last one, see record().
class Trace {
public:
    enum class Mode { off, on };

    // `marks` are coarser tolerances, as lengths, in decreasing order. The first sample whose gap is at most a mark is
    // always kept. So the trace of a run with a fine tolerance contains the answers to the coarser ones, bit for bit.
    explicit Trace(Mode mode = Mode::off, std::vector<double> marks = {})
        : on_(mode == Mode::on), marks_(std::move(marks)) {}

    bool on() const { return on_; }

    // Starts a run; removes all samples. The solver works on shapes that are scaled by 2^exponent, so record() will
    // compare its gaps with the marks times 2^exponent.
    void start(int exponent = 0) {
        samples_.clear();
        next_mark_ = 0;
        scaled_marks_ = marks_;
        for (double& mark : scaled_marks_) mark = std::ldexp(mark, exponent);
        begin_ = std::chrono::steady_clock::now();
    }

    // Call it wherever the solver tests whether the gap is small enough. A sample is kept if its gap is at least 3 %
    // smaller than the gap of the last kept sample, or if it is the first at or below a mark. So while the gap shrinks
    // from 1 to 1e-16, at most about 1200 samples are kept (0.97^1200 is about 1e-16), plus one for each mark.
    void record(double lower, double upper) {
        if (!on_) return;
        const double gap = upper - lower;
        // Until an upper bound is known, a sample is kept if its lower bound is over 3 % larger than the last one.
        if (std::isinf(gap)) {
            if (samples_.empty() || lower > 1.03 * samples_.back().lower) keep(lower, upper);
            return;
        }
        bool marked = false;
        for (; next_mark_ < scaled_marks_.size() && gap <= scaled_marks_[next_mark_]; ++next_mark_) marked = true;
        if (!marked && !samples_.empty() && !(gap <= 0.97 * (samples_.back().upper - samples_.back().lower))) return;
        keep(lower, upper);
    }

    // Ends a run: keeps its final bounds as the last sample.
    void finish(double lower, double upper) {
        if (on_) keep(lower, upper);
    }

    const std::vector<TraceSample>& samples() const { return samples_; }
    std::vector<TraceSample>& samples() { return samples_; }

private:
    void keep(double lower, double upper) {
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
        samples_.push_back({elapsed.count(), lower, upper});
    }

    bool on_;
    std::vector<double> marks_, scaled_marks_;
    std::size_t next_mark_ = 0;
    std::chrono::steady_clock::time_point begin_{};
    std::vector<TraceSample> samples_;
};

}  // namespace hausbench
