// `hausbench list keys` prints the defaults that the experiment reader uses.
#include "harness/plan/keys.h"

#include "harness/plan/experiment.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>

namespace hausbench {
namespace {

// Returns the lines "key = default" of the keys whose default can be written in TOML: numbers, strings in quotes, true and false.
std::vector<std::string> written(const KeyTable& table) {
    std::vector<std::string> lines;
    for (const Key& key : table.keys) {
        const std::string& value = key.fallback;
        if (value.empty()) continue;
        if (std::isdigit(value[0]) || value[0] == '"' || value == "true" || value == "false")
            lines.push_back(key.name + " = " + value);
    }
    return lines;
}

std::string joined(const std::vector<std::string>& lines, const std::string& mark) {
    std::string text;
    for (const std::string& line : lines) text += mark + line;
    return text;
}

class Keys : public testing::Test {
protected:
    Experiment read(const std::string& name, const std::string& top, const std::string& limits,
                    const std::string& motion, const std::string& target_motion, const std::string& solver) const {
        const auto file = folder.path() / (name + ".toml");
        std::ofstream(file) << "title = 't'\ntolerances = [0.01]\n"
                            << top << "\n[limits]\n"
                            << limits << "\n[[scene]]\nname = 's'\nsource = 'a.off'\ntarget = 'b.off'\n"
                            << "motion = { kind = 'translation', from = [0, 0, 0], to = [1, 0, 0]" << motion << " }\n"
                            << "target_motion = { kind = 'rotation', axis = [0, 0, 1], degrees = 90" << target_motion
                            << " }\n[[solver]]\nname = 'cover'\n"
                            << solver << "\n";
        return read_experiment(file, "quick");
    }
    TemporaryFolder folder;
};

TEST_F(Keys, WritingADefaultOutChangesNothing) {
    const std::vector<std::string> top = written(top_keys()), limits = written(limit_keys()),
                                   translation = written(motion_keys("translation")),
                                   rotation = written(motion_keys("rotation")), solver = written(solver_keys());
    EXPECT_EQ(top.size(), 11u);
    EXPECT_EQ(limits.size(), 4u);
    EXPECT_EQ(translation.size(), 2u);
    EXPECT_EQ(rotation.size(), 1u);
    EXPECT_EQ(solver.size(), 1u);
    const Experiment bare = read("bare", "", "", "", "", "");
    const Experiment full = read("full", joined(top, "\n"), joined(limits, "\n"), joined(translation, ", "),
                                 joined(rotation, ", "), joined(solver, "\n"));
    EXPECT_EQ(bare.of, full.of);
    EXPECT_EQ(bare.quantity, full.quantity);
    EXPECT_EQ(bare.floor, full.floor);
    EXPECT_EQ(bare.threads, full.threads);
    EXPECT_EQ(bare.repeats, full.repeats);
    EXPECT_EQ(bare.rounds, full.rounds);
    EXPECT_EQ(bare.trace, full.trace);
    EXPECT_EQ(bare.fields, full.fields);
    EXPECT_EQ(bare.stages, full.stages);
    EXPECT_EQ(bare.reference, full.reference);
    EXPECT_EQ(bare.reference_seconds, full.reference_seconds);
    EXPECT_EQ(bare.limits.case_seconds, full.limits.case_seconds);
    EXPECT_EQ(bare.limits.prepare_seconds, full.limits.prepare_seconds);
    EXPECT_EQ(bare.limits.memory_bytes, full.limits.memory_bytes);
    EXPECT_EQ(bare.solvers.at(0).warm, full.solvers.at(0).warm);
    const auto& one = std::get<Translation>(bare.scenes.at(0).motion);
    const auto& other = std::get<Translation>(full.scenes.at(0).motion);
    EXPECT_EQ(one.steps, other.steps);
    EXPECT_EQ(one.of, other.of);
    EXPECT_EQ(std::get<Rotation>(bare.scenes.at(0).target_motion).steps,
              std::get<Rotation>(full.scenes.at(0).target_motion).steps);
}

TEST(KeyTables, EveryKeyIsListedOnceAndSaysWhatItMeans) {
    for (const KeyTable& table : key_tables()) {
        std::vector<std::string> names = table.names();
        std::sort(names.begin(), names.end());
        EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end()) << table.title;
        for (const Key& key : table.keys) {
            EXPECT_FALSE(key.meaning.empty()) << table.title << " " << key.name;
            EXPECT_EQ(key.meaning.find('\n'), std::string::npos) << table.title << " " << key.name;
        }
    }
}

}  // namespace
}  // namespace hausbench
