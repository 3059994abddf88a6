// `hausbench merge`: joins several results of one experiment, such as shards.
#include "harness/commands/merge_results.h"

#include "algorithms/error.h"
#include "harness/commands/verb.h"
#include "harness/commands/verify_result.h"

#include <fmt/format.h>

#include <algorithm>

namespace hausbench {

namespace fs = std::filesystem;

namespace {

int merge(const fs::path& out, const std::vector<fs::path>& parts, bool any_build) {
    if (parts.size() < 2)
        throw InputError("merge: needs at least two results: name the file to write first, then two or more results");
    std::error_code none;
    const auto is_out = [&](const fs::path& part) { return fs::equivalent(part, out, none); };
    if (fs::exists(out, none) && std::none_of(parts.begin(), parts.end(), is_out))
        throw InputError(fmt::format(
            "{}: exists and is not one of the results to merge: name a new file first, or remove it", out.string()));
    ResultFile result = merge_results(parts, any_build);
    say(verify_result(result, catalogue()));  // a lower bound in one part may refute an upper bound in another
    write_result(out, result);
    print(fmt::format("{}: {} cases of {} results\n", out.string(), result.rows.size(), parts.size()));
    const std::string missing = missing_shards(result);
    if (!missing.empty()) say({missing});
    return missing.empty() ? 0 : 1;
}

}  // namespace

void add_merge(CLI::App& app, int& code) {
    static fs::path out;
    static std::vector<fs::path> parts;
    static bool any_build = false;
    auto* verb = app.add_subcommand(
        "merge", "join several results of one experiment, such as shards; exit code 1 if a shard is missing");
    verb->add_option("out", out, "result file to write (.h5)")->required();
    verb->add_option("results", parts, "result files (.h5)")->required();
    verb->add_flag("--any-build", any_build, "merge even if builds or machines differ");
    verb->callback([&code] { code = merge(out, parts, any_build); });
}

}  // namespace hausbench
