// A copy of this process may end, crash or hang; the process that waits tells how.
#include "process/stand_in.h"

#include "algorithms/error.h"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include <gtest/gtest.h>

namespace hausbench {
namespace {

// Runs `work` in the copy; the process that waits ends with 9 and prints the error if there is one.
void in_copy(const std::function<void()>& work) {
    try {
        continue_in_copy("a.so");
        work();
        ::_exit(0);
    } catch (const InputError& error) {
        std::fputs(error.what(), stderr);
        ::_exit(9);
    }
}

TEST(StandIn, GivesTheExitCodeOfTheCopy) {
    EXPECT_EXIT(in_copy([] { tell_exit_code(5); }), testing::ExitedWithCode(5), "");
    EXPECT_EXIT(in_copy([] {
                    tell_exit_code(5);
                    std::abort();  // as a destructor of a static object might
                }),
                testing::ExitedWithCode(5), "");
    EXPECT_EXIT(in_copy([] {
                    tell_exit_code(5);
                    ::sleep(100);
                }),
                testing::ExitedWithCode(5), "");
}

TEST(StandIn, TellsHowTheCopyEndedTooEarly) {
    EXPECT_EXIT(in_copy([] { ::_exit(0); }), testing::ExitedWithCode(9),
                "a.so: ended the program with exit code 0: mend");
    EXPECT_EXIT(in_copy([] {
                    const TimeLimited limited("loading a.so", 100);
                    std::abort();
                }),
                testing::ExitedWithCode(9), "with signal 6 \\(Aborted\\) in loading a.so");
}

TEST(StandIn, EndsTheCopyAtItsTimeLimit) {
    EXPECT_EXIT(in_copy([] {
                    const TimeLimited limited("loading a.so", 0.2);
                    ::sleep(100);
                }),
                testing::ExitedWithCode(9), "loading a.so did not end within 0.2 s");
    EXPECT_EXIT(in_copy([] {
                    { const TimeLimited limited("loading a.so", 0.2); }
                    ::usleep(500'000);
                    tell_exit_code(3);
                }),
                testing::ExitedWithCode(3), "");
}

TEST(StandIn, PassesSignalsOn) {
    EXPECT_EXIT(in_copy([] {
                    ::kill(::getppid(), SIGTERM);
                    ::sleep(100);
                }),
                testing::KilledBySignal(SIGTERM), "");
    EXPECT_EXIT(in_copy([] {
                    std::signal(SIGINT, [](int) {
                        tell_exit_code(4);
                        ::_exit(1);
                    });
                    ::kill(::getppid(), SIGINT);
                    ::sleep(100);
                }),
                testing::ExitedWithCode(4), "");
}

}  // namespace
}  // namespace hausbench
