// How the bounds closed over time: samples that a solver offers while it runs, kept only in runs made for tracing.
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

    // `marks`: gaps, the largest first. The first sample offered at or below a mark is kept whatever the last one was, so
    // that the answer to a coarser tolerance can be read off the trace of a finer one, to the bit.
    explicit Trace(Mode mode = Mode::off, std::vector<double> marks = {})
        : on_(mode == Mode::on), marks_(std::move(marks)) {}

    bool on() const { return on_; }

    // Samples will be offered in units of 2^-exponent of those of the marks.
    void start(int exponent = 0) {
        samples_.clear();
        next_mark_ = 0;
        scaled_marks_ = marks_;
        for (double& mark : scaled_marks_) mark = std::ldexp(mark, exponent);
        begin_ = std::chrono::steady_clock::now();
    }

    // To be called wherever a solver asks whether the gap is small enough: a sample is kept when it has shrunk by 3 % since
    // the last one kept, or reached a mark, so a trace from 1 to 1e-16 has about 1200 samples at most.
    void record(double lower, double upper) {
        if (!on_) return;
        const double gap = upper - lower;
        bool marked = false;
        for (; next_mark_ < scaled_marks_.size() && gap <= scaled_marks_[next_mark_]; ++next_mark_) marked = true;
        if (!marked && !samples_.empty() && !(gap <= 0.97 * (samples_.back().upper - samples_.back().lower))) return;
        keep(lower, upper);
    }

    // The end of a run is kept whatever the gap.
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
