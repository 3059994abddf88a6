#include "harness/run/progress.h"

#include "algorithms/printable.h"

#include <fmt/format.h>

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace hausbench {

using std::chrono::steady_clock;

namespace {

std::string clock_text(double seconds) { return fmt::format("{}:{:02}", int(seconds) / 60, int(seconds) % 60); }

}  // namespace

Progress::Progress(bool quiet, double pause)
    : quiet_(quiet),
      person_(::isatty(STDERR_FILENO) && !std::getenv("CI")),
      pause_(pause),
      begin_(steady_clock::now()),
      drawn_(begin_) {}

Progress::~Progress() { erase(); }

void Progress::total(std::size_t cases) {
    total_ = cases;
    begin_ = steady_clock::now();
}

void Progress::left_by(std::function<double(double gone_by)> seconds) { seconds_left_ = std::move(seconds); }

std::string Progress::time() const {
    const double gone_by = std::chrono::duration<double>(steady_clock::now() - begin_).count();
    if (done_ == 0 || done_ >= total_) return clock_text(gone_by);
    const double left = seconds_left_ ? seconds_left_(gone_by) : gone_by * double(total_ - done_) / double(done_);
    return fmt::format("{}, about {} left", clock_text(gone_by), clock_text(left));
}

void Progress::erase() {
    if (person_ && !quiet_) fmt::print(stderr, "\r\033[K");
}

void Progress::draw() {
    drawn_ = steady_clock::now();
    fmt::print(stderr, "\r\033[K[{}/{}] {} | {}", done_, total_, time(), what_);
    std::fflush(stderr);
}

void Progress::doing(const std::string& what) {
    what_ = printable(what);
    if (!quiet_ && person_) draw();
}

void Progress::done(std::size_t cases) {
    done_ += cases;
    if (quiet_ || total_ == 0) return;
    const std::chrono::duration<double> silent = steady_clock::now() - drawn_;
    if (person_ && silent.count() > 0.1) draw();
    if (!person_ && silent.count() > pause_) line(what_);
}

void Progress::line(const std::string& text) {
    if (quiet_) return;
    drawn_ = steady_clock::now();
    erase();
    if (person_ || total_ == 0)
        fmt::print(stderr, "{}\n", printable(text));
    else
        fmt::print(stderr, "[{}/{}] {} | {}\n", done_, total_, time(), printable(text));
    if (person_ && total_ > 0) draw();
}

}  // namespace hausbench
