#include "commands/verb.h"

#include "paths.h"
#include "plugin.h"

#include <fmt/format.h>

#include <cstdio>

namespace hausbench {

void take_plugins(CLI::App* verb) {
    static std::vector<std::filesystem::path> files;
    verb->add_option("--plugin", files, "a plug-in library with additional solvers; may be repeated")
        ->allow_extra_args(false);
    verb->parse_complete_callback([] {
        for (const std::filesystem::path& file : files) load_plugin(file);
        say(slow_plugins());
    });
}

Catalogue catalogue() { return {manifest_file(), cache_folder(), program_path()}; }

void print(const std::string& text) { std::fputs(text.c_str(), stdout); }

void say(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) fmt::print(stderr, "hausbench: {}\n", line);
}

}  // namespace hausbench
