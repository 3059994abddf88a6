// Scratch folders: errors when none can be made, and races with other processes that delete old ones.
// Also the memory use of several processes.
#include "process/scratch.h"
#include "algorithms/error.h"
#include "process/child.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace hausbench {
namespace {

namespace fs = std::filesystem;

// Exits with 0 if, without file descriptors, making a folder gives an error that says so and leaves nothing behind.
[[noreturn]] void make_one_without_descriptors(const fs::path& temporary) {
    ::alarm(2);  // fails if it tries forever
    ::setenv("TMPDIR", temporary.c_str(), 1);
    { const ScratchFolder first("worker"); }
    rlimit before{};
    ::getrlimit(RLIMIT_NOFILE, &before);
    const rlimit none{0, before.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &none);
    std::string said;
    try {
        const ScratchFolder second("worker");
    } catch (const InputError& error) {
        ::setrlimit(RLIMIT_NOFILE, &before);  // sanitizers need a descriptor to inspect the error
        said = error.what();
    }
    const bool told = said.find("TMPDIR") != std::string::npos && said.find("opened") != std::string::npos;
    ::_exit(!told ? 3 : fs::is_empty(temporary) ? 0 : 4);
}

TEST(ScratchFolder, IsRefusedAtOnceWhereItCannotBeOpened) {
    const TemporaryFolder temporary;
    EXPECT_EXIT(make_one_without_descriptors(temporary.path()), testing::ExitedWithCode(0), "");
}

// Deletes unlocked folders, as another process does before it makes its first folder, but without pause.
void clear_away(const fs::path& from, const std::atomic<bool>& stop, std::atomic<int>& taken) {
    std::error_code ignored;
    while (!stop) {
        for (const auto& entry : fs::directory_iterator(from, ignored)) {
            const int lock = ::open(entry.path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
            if (lock < 0) continue;
            if (::flock(lock, LOCK_EX | LOCK_NB) == 0) {
                ++taken;
                fs::remove_all(entry.path(), ignored);
            }
            ::close(lock);
        }
    }
}

TEST(ScratchFolder, IsMadeWhileOthersClearAwayTheirs) {
    const TemporaryFolder temporary;
    ::setenv("TMPDIR", temporary.path().c_str(), 1);
    std::atomic<bool> stop = false;
    std::atomic<int> taken = 0;
    std::thread other(clear_away, temporary.path(), std::cref(stop), std::ref(taken));
    std::set<std::string> names;
    int made = 0;
    for (; made < 2000 || (taken == 0 && made < 20000); ++made) {
        const ScratchFolder folder("load");
        EXPECT_TRUE(fs::is_directory(folder.path()));
        names.insert(folder.path().string());
    }
    stop = true;
    other.join();
    EXPECT_EQ(names.size(), static_cast<std::size_t>(made));
    EXPECT_TRUE(fs::is_empty(temporary.path()));
    ::unsetenv("TMPDIR");
}

// Three forks share pages of their parent, so memory counts once; after they have written to the
// pages, each fork has its own copy.
TEST(Memory, PagesThatForksShareCountOnce) {
    constexpr std::int64_t bytes = std::int64_t(64) << 20;
    int go[2], done[2];
    ASSERT_EQ(::pipe(go) | ::pipe(done), 0);
    Launch launch;
    launch.work = [&](int) {
        std::vector<char> pages(std::size_t(bytes), 1);
        for (int i = 0; i < 3; ++i) {
            if (::fork() != 0) continue;
            char byte = 1;
            if (::write(done[1], &byte, 1) != 1 || ::read(go[0], &byte, 1) != 1) ::_exit(1);
            for (std::size_t at = 0; at < pages.size(); at += 4096) pages[at] = 2;
            if (::write(done[1], &pages[4096], 1) != 1) ::_exit(1);
            ::pause();
        }
        ::pause();
        return 0;
    };
    Child child(std::move(launch));
    const auto wait_for_all = [&] {
        char byte = 0;
        for (int i = 0; i < 3; ++i) ASSERT_EQ(::read(done[0], &byte, 1), 1);
    };
    wait_for_all();
    EXPECT_TRUE(child.takes_more_than(bytes));
    EXPECT_FALSE(child.takes_more_than(2 * bytes)) << "four processes, one set of pages";
    ASSERT_EQ(::write(go[1], "123", 3), 3);
    wait_for_all();
    EXPECT_TRUE(child.takes_more_than(3 * bytes)) << "each has its own now";
    for (const int end : {go[0], go[1], done[0], done[1]}) ::close(end);
}

}  // namespace
}  // namespace hausbench
