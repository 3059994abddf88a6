// Replays the fuzz targets on their corpora and on every input that once crashed:
// tests/fuzz/corpus/TARGET and tests/fuzz/crashes/TARGET. This needs neither clang nor libFuzzer
// (`make fuzz`), so `make test` includes it, and mutants are tested with it.
#include "tests/fuzz/target.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

namespace hausbench::fuzz {
namespace {

class FuzzReplay : public testing::TestWithParam<std::string> {};

TEST_P(FuzzReplay, NoFileOfTheCorpusFails) {
    int count = 0;
    for (const char* kind : {"corpus", "crashes"}) {
        const auto folder = std::filesystem::path(HAUSBENCH_SOURCE) / "tests/fuzz" / kind / GetParam();
        if (!std::filesystem::exists(folder)) continue;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            std::ifstream in(entry.path(), std::ios::binary);
            const std::string bytes{std::istreambuf_iterator<char>(in), {}};
            ++count;
            try {
                targets().at(GetParam())(bytes);
            } catch (const std::exception& error) {
                ADD_FAILURE() << entry.path() << ": " << error.what();
            }
        }
    }
    EXPECT_GT(count, 0) << "there is no corpus";
}

std::vector<std::string> names() {
    return {"arrays",  "certificates", "differential", "experiments", "journals",
            "kernels", "polynomials",  "readers",      "results"};
}
INSTANTIATE_TEST_SUITE_P(, FuzzReplay, testing::ValuesIn(names()), [](const auto& name) { return name.param; });

TEST(FuzzTargets, EachIsReplayed) {
    std::vector<std::string> all;
    for (const auto& [name, target] : targets()) all.push_back(name);
    EXPECT_EQ(all, names());
}

}  // namespace
}  // namespace hausbench::fuzz
