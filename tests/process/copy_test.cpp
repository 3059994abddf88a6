// Copies of a process: what they inherit, how they end, and input that is sent to their original bit by bit.
#include "process/copy.h"
#include "process/child.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

namespace hausbench {
namespace {

namespace fs = std::filesystem;

int touched = 0;  // changed by copies only

// Starts a child process that runs `work`, so that the test itself is never copied.
Child child_that(std::function<int()> work) {
    Launch launch;
    launch.silent = true;
    launch.work = [work = std::move(work)](int) { return work(); };
    return Child(std::move(launch));
}

TEST(Copies, FindNothingThatAnEarlierOneHasLeft) {
    Child child = child_that([] {
        for (int i = 0; i < 3; ++i) {
            if (in_a_copy()) {
                ++touched;
                std::printf("copy %d of 3 made %d\n", i + 1, touched);
                return 0;
            }
        }
        std::printf("original %d\n", touched);
        return 5;
    });
    EXPECT_EQ(child.wait({.seconds = 60}), Child::End::by_itself);
    EXPECT_EQ(child.exit_code(), 5);
    EXPECT_EQ(child.output(), "copy 1 of 3 made 1\ncopy 2 of 3 made 1\ncopy 3 of 3 made 1\noriginal 0\n");
}

TEST(Copies, EndTheirOriginalAsTheyEnd) {
    for (const int signal : {SIGSEGV, SIGABRT, SIGKILL}) {
        Child child = child_that([signal] {
            if (!in_a_copy()) return 0;
            ::signal(signal, SIG_DFL);  // a sanitizer may handle it
            return ::raise(signal);
        });
        EXPECT_EQ(child.wait({.seconds = 60}), Child::End::by_itself);
        EXPECT_EQ(child.signal(), signal);
    }
    Child child = child_that([] { return in_a_copy() ? 7 : 0; });
    EXPECT_EQ(child.wait({.seconds = 60}), Child::End::by_itself);
    EXPECT_FALSE(child.signal());
    EXPECT_EQ(child.exit_code(), 7);
}

TEST(Copies, LeaveNoOrphans) {
    const fs::path file = fs::path(testing::TempDir()) / "left_by_a_copy";
    fs::remove(file);
    Child child = child_that([&] {
        if (in_a_copy()) return std::system(("setsid sh -c 'sleep 2; touch " + file.string() + "' &").c_str());
        std::this_thread::sleep_for(std::chrono::seconds(3));  // the original lives on
        return fs::exists(file) ? 1 : 0;
    });
    EXPECT_EQ(child.wait({.seconds = 60}), Child::End::by_itself);
    EXPECT_EQ(child.exit_code(), 0) << "an orphan lived on";
}

TEST(Copies, ReadInputThatIsSentToTheirOriginal) {
    Launch launch;
    launch.command = {"/bin/sh", "-c", "while read line; do echo got $line; echo $line >&\"$0\"; done"};
    launch.events = true;
    launch.input = "first\n";
    launch.more_input = true;
    Child child(std::move(launch));
    const auto next = [&] {
        std::string line;
        for (int turns = 0; turns < 3000; ++turns)
            if (child.listen(std::chrono::milliseconds(20), line) == Child::Heard::line) return line;
        return std::string("nothing");
    };
    EXPECT_EQ(next(), "first");
    EXPECT_EQ(child.output(), "got first\n");
    child.write("second\n");
    EXPECT_EQ(next(), "second");
    EXPECT_EQ(child.output(), "got second\n") << "what it said before is forgotten";
    std::string longer(1 << 18, 'x');  // more than a pipe holds
    longer += '\n';
    child.write(longer);
    EXPECT_EQ(next().size(), std::size_t(1) << 18);
    EXPECT_FALSE(child.ended_within(std::chrono::milliseconds(0)));
}

}  // namespace
}  // namespace hausbench
