#include "process/progress_line.h"

#include "algorithms/printable.h"

#include <fmt/format.h>

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace hausbench {

using std::chrono::steady_clock;

ProgressLine::ProgressLine()
    : person_(::isatty(STDERR_FILENO) && !std::getenv("CI")),
      begin_(steady_clock::now()),
      next_(begin_ + std::chrono::seconds(2)) {}

ProgressLine::~ProgressLine() {
    if (drawn_) fmt::print(stderr, "\r\033[K");
}

void ProgressLine::draw(const std::string& doing) {
    if (!person_) return;
    const auto now = steady_clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(500);
    drawn_ = true;
    fmt::print(stderr, "\r\033[K{:.0f} s | {}", std::chrono::duration<double>(now - begin_).count(), printable(doing));
    std::fflush(stderr);
}

}  // namespace hausbench
