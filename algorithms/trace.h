// Bounds over time: samples that a solver offers while it runs. Only runs made for tracing keep them.
#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace hausbench {

struct TraceSample {
    double seconds;  // since start()
    double lower, upper;
};

class Trace {
public:
    enum class Mode { off, on };

    // `marks` are gaps in decreasing order. The first sample with a gap at or below a mark is always kept, so the trace of a
    // fine tolerance contains the answers to coarser ones, bit for bit.
    explicit Trace(Mode mode = Mode::off, std::vector<double> marks = {})
        : on_(mode == Mode::on), marks_(std::move(marks)) {}

    bool on() const { return on_; }

    // Starts a run. The samples are in units of 2^-exponent times the unit of the marks.
    void start(int exponent = 0) {
        samples_.clear();
        next_mark_ = 0;
        scaled_marks_ = marks_;
        for (double& mark : scaled_marks_) mark = std::ldexp(mark, exponent);
        begin_ = std::chrono::steady_clock::now();
    }

    // Call it wherever the solver tests whether the gap is small enough. A sample is kept if its gap is 3 % smaller
    // than the gap of the last kept sample, or reaches a mark, so a trace from 1 to 1e-16 has at most about 1200
    // samples.
    void record(double lower, double upper) {
        if (!on_) return;
        const double gap = upper - lower;
        // Until there is an upper bound, samples follow the lower bound in steps of 3 %.
        if (std::isinf(gap)) {
            if (samples_.empty() || lower > 1.03 * samples_.back().lower) keep(lower, upper);
            return;
        }
        bool marked = false;
        for (; next_mark_ < scaled_marks_.size() && gap <= scaled_marks_[next_mark_]; ++next_mark_) marked = true;
        if (!marked && !samples_.empty() && !(gap <= 0.97 * (samples_.back().upper - samples_.back().lower))) return;
        keep(lower, upper);
    }

    // Keeps the last sample of a run.
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
