// `hausbench compare`: compares two results, or two solvers of one result.
#include "algorithms/error.h"
#include "harness/commands/comparison.h"
#include "harness/commands/row_choice.h"
#include "harness/commands/verb.h"

#include <fmt/format.h>

namespace hausbench {

namespace {

// Selects the rows to compare, by scene and profile. An empty value selects all rows.
struct Rows {
    std::vector<std::string> scenes;
    std::string profile;
};

void take_rows(ResultFile& result, const Rows& wanted) {
    RowChoice choice{{}, wanted.scenes, {}};
    if (!wanted.profile.empty()) choice.where.push_back("profile=" + wanted.profile);
    std::vector<Row> chosen;
    for (const std::size_t row : chosen_rows(result, choice)) chosen.push_back(std::move(result.rows[row]));
    if (chosen.empty())
        throw InputError(fmt::format("--profile {}: the result has no row of this profile", wanted.profile));
    result.rows = std::move(chosen);
}

std::string compare(const std::vector<std::filesystem::path>& files, const std::vector<std::string>& solvers,
                    const Rows& wanted) {
    if (files.size() != (solvers.empty() ? 2 : 1))
        throw InputError(solvers.empty() ? "compare: name two results, or two solvers of one with --solver A B"
                                         : "compare: --solver compares two solvers of one result: name one");
    const auto read = [&](std::size_t i) {
        ResultFile result = read_part(files[i], compared_part());
        if (!wanted.scenes.empty() || !wanted.profile.empty()) take_rows(result, wanted);
        return result;
    };
    if (solvers.empty()) return compare_results(read(0), read(1));
    return compare_solvers(read(0), solvers[0], solvers[1], paper_of_output());
}

}  // namespace

void add_compare(CLI::App& app, int&) {
    static std::vector<std::filesystem::path> files;
    static std::vector<std::string> solvers;
    static Rows wanted;
    auto* verb = add_verb(app, "compare", "compares two results case by case, or two solvers of one result",
                          "hausbench compare results/zhang2017_table3.h5 --solver cover tang",
                          "It lists answers that differ, then ratios of times with intervals. Cases are paired by "
                          "scene, pose and tolerance.");
    verb->add_option("results", files, "two result files (.h5), the base first; with --solver one")
        ->type_name("FILE")
        ->required();
    verb->add_option("--solver", solvers, "two solvers of one result: labels, or \"guthe(samples=8)\"")
        ->type_name("LABEL LABEL")
        ->expected(2);
    verb->add_option("--scene", wanted.scenes, "only this scene; may be repeated")
        ->type_name("SCENE")
        ->allow_extra_args(false);
    verb->add_option("--profile", wanted.profile, "only rows of this profile")->type_name("PROFILE");
    verb->callback([] { print(compare(files, solvers, wanted)); });
}

}  // namespace hausbench
