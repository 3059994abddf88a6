// The line that tells what a long command is doing: on a terminal alone, after two seconds, and erased at the end.
#include "process/progress_line.h"

#include <pty.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <functional>
#include <string>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

// Returns what `work` writes to standard error while that is a terminal.
std::string on_terminal(const std::function<void()>& work) {
    int outer = -1, inner = -1;
    if (::openpty(&outer, &inner, nullptr, nullptr, nullptr) != 0) return "no terminal";
    const int before = ::dup(STDERR_FILENO);
    ::dup2(inner, STDERR_FILENO);
    ::close(inner);
    work();
    ::dup2(before, STDERR_FILENO);
    ::close(before);
    std::string text;
    std::array<char, 1000> some{};
    for (ssize_t n; (n = ::read(outer, some.data(), some.size())) > 0;) text.append(some.data(), std::size_t(n));
    ::close(outer);
    return text;
}

TEST(ProgressLine, ComesAfterTwoSecondsAndIsErased) {
    ::unsetenv("CI");
    const std::string text = on_terminal([] {
        ProgressLine line;
        line.draw("too early");
        ::usleep(2'050'000);
        line.draw("reading a\033[2J.obj");
        line.draw("too soon after that");
    });
    EXPECT_EQ(text, "\r\033[K2 s | reading a [2J.obj\r\033[K");
    EXPECT_EQ(on_terminal([] { ProgressLine().draw("short work"); }), "");
}

TEST(ProgressLine, StaysAwayFromLogs) {
    ::setenv("CI", "1", 1);
    EXPECT_EQ(on_terminal([] {
                  ProgressLine line;
                  ::usleep(2'050'000);
                  line.draw("reading");
              }),
              "");
    ::unsetenv("CI");
}

}  // namespace
}  // namespace hausbench
