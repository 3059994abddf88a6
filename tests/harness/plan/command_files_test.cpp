// Finds and hashes the files that a shell command line runs or reads.
#include "harness/plan/command_files.h"

#include "datasets/hash.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

namespace hausbench {
namespace {

class FilesOfCommand : public testing::Test {
protected:
    FilesOfCommand() {
        for (const char* name : {"peer", "bin/tool", "peer.py", "a file.py", "out.txt"}) write(name, name);
        const char* path = std::getenv("PATH");
        before = path ? path : "";
        ::setenv("PATH", ("/nowhere:" + (folder.path() / "bin").string()).c_str(), 1);
    }
    ~FilesOfCommand() override { ::setenv("PATH", before.c_str(), 1); }

    void write(const std::string& name, const std::string& text) const {
        const auto file = folder.path() / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file) << text;
        std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    }

    CommandFiles of(const std::string& line) const { return files_of_command(line, folder.path()); }

    std::string hash(const std::vector<std::string>& names) const {
        Sha256 all;
        for (const std::string& name : names) all.add(sha256_of_file(folder.path() / name));
        return names.empty() ? "" : all.hex();
    }

    TemporaryFolder folder;
    std::string before;
};

TEST_F(FilesOfCommand, AreItsProgramsAndWhatTheyAreGiven) {
    const std::vector<std::pair<std::string, std::vector<std::string>>> all = {
        {"./peer {A} {B}", {"peer"}},
        {"tool peer.py {A} {B} {tolerance}", {"bin/tool", "peer.py"}},
        {"tool 'a file.py' --script=peer.py", {"bin/tool", "a file.py", "peer.py"}},
        {"tool a\\ file.py", {"bin/tool", "a file.py"}},
        {"X=1 tool; ./peer < peer.py", {"bin/tool", "peer", "peer.py"}},
        {"if tool 2>&1 | ./peer; then tool; fi", {"bin/tool", "peer", "bin/tool"}},
        {"(tool) && tool # peer.py", {"bin/tool", "bin/tool"}},
        {"tool {A} > out.txt; tool out.txt", {"bin/tool", "bin/tool"}},  // the command writes out.txt
        {"tool \"$HOME/peer.py\" peer.*", {"bin/tool"}},
        {"tool peer " + folder.path().string() + "/peer.py", {"bin/tool", "peer", "peer.py"}},
        {"echo {A} {B}", {}},
    };
    for (const auto& [line, names] : all) EXPECT_EQ(of(line).sha256, hash(names)) << line;
}

TEST_F(FilesOfCommand, ChangeWithTheirContentsAndNotWithTheirPlace) {
    const TemporaryFolder other;
    std::filesystem::copy(folder.path(), other.path(), std::filesystem::copy_options::recursive);
    const std::string first = of("tool ./peer").sha256;
    EXPECT_EQ(files_of_command("tool ./peer", other.path()).sha256, first);
    write("peer", "another");
    EXPECT_NE(of("tool ./peer").sha256, first);
}

TEST_F(FilesOfCommand, AProgramThatIsNowhereIsNamed) {
    for (const char* line : {"absent {A}", "tool; absent", "X=1 absent", "tool | absent", "! absent"})
        EXPECT_NE(of(line).missing.find("'absent' is not in PATH"), std::string::npos) << line;
    EXPECT_NE(of("bin/absent {A}").missing.find("'bin/absent' does not exist"), std::string::npos);
    for (const char* line : {"tool absent", "cd bin; absent", "f() { tool; }; f", "PATH=. absent", "$TOOL {A}",
                             "tool > absent", "tool # absent", "for x in a b; do tool; done", "tool 'a; absent'"})
        EXPECT_EQ(of(line).missing, "") << line;
}

TEST_F(FilesOfCommand, AFileThatIsNoProgramIsNotFoundInPath) {
    std::filesystem::permissions(folder.path() / "bin" / "tool", std::filesystem::perms::owner_read);
    EXPECT_NE(of("tool").missing, "");
    EXPECT_NE(of("peer.py").missing, "");  // in the current folder, not in PATH
}

}  // namespace
}  // namespace hausbench
